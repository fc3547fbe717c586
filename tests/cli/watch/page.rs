//! The page's link, and who is told of it.

use std::{fs, os::unix::fs::PermissionsExt};

use super::{Watch, studio::studio};

#[test]
fn who_lets_others_in_is_warned() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml --listen 0.0.0.0");
    let warning = watch.wait_for(|it| it["severity"] == "warning");
    assert!(warning["message"].as_str().unwrap().contains("0.0.0.0"), "{warning}");
    assert!(warning["hint"].as_str().unwrap().contains("not encrypted"), "{warning}");
    watch.wait_for(|it| it["page"].is_string());
    let mut alone = Watch::start(&bench, "studio/scene.toml");
    alone.wait_for(|it| it["phase"] == "done");
    assert!(alone.end().iter().all(|it| !it.to_string().contains("encrypted")));
}

#[cfg(target_os = "linux")]
#[test]
fn the_page_is_opened_by_what_the_desktop_has_for_it() {
    let bench = studio();
    bench.write("bin/xdg-open", "#!/bin/sh\necho \"$1\" > opened.part && mv opened.part opened\n");
    fs::set_permissions(bench.path("bin/xdg-open"), fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:/usr/bin:/bin", bench.path("bin").display());
    let mut watch = Watch::start_with(&bench, "studio/scene.toml --open", &[("PATH", &path)]);
    let page = watch.wait_for(|it| it["page"].is_string());
    watch.wait_for(|_| bench.has("opened"));
    assert_eq!(fs::read_to_string(bench.path("opened")).unwrap().trim(), page["page"].as_str().unwrap());
    // Where there is nothing to open it with, that is said and all else goes on.
    let empty = bench.path("nothing").display().to_string();
    let mut other = Watch::start_with(&bench, "studio/scene.toml --open", &[("PATH", &empty)]);
    other.wait_for(|it| it["message"] == "no browser could be opened");
    other.wait_for(|it| it["phase"] == "done");
}
