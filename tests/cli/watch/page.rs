//! The page's link, and who is told of it.

use std::{fs, net::TcpListener, os::unix::fs::PermissionsExt};

use serde_json::Value;

use super::{
    Watch,
    studio::{light, studio},
};

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

/// Port and secret of a link.
fn parts(page: &Value) -> (u16, String) {
    let url = page["page"].as_str().unwrap().strip_prefix("http://127.0.0.1:").unwrap();
    let (port, rest) = url.split_once('/').unwrap();
    (port.parse().unwrap(), rest.to_owned())
}

#[test]
fn a_scene_has_its_own_link_and_has_it_again() {
    let bench = studio();
    let link = |scene: &str| {
        let mut watch = Watch::run(&bench, scene, &[]);
        let page = parts(&watch.wait_for(|it| it["page"].is_string()));
        watch.wait_for(|it| it["phase"] == "done");
        watch.end();
        page
    };
    let (port, secret) = link("studio/scene.toml");
    let other = link("kitchen/scene.toml");
    assert_ne!(secret, other.1);
    let again = link("studio/../studio/scene.toml");
    assert_eq!(again.1, secret);
    // Somebody else may have taken it meanwhile.
    assert!(again.0 == port || TcpListener::bind(("127.0.0.1", port)).is_err());
}

#[test]
fn whether_tev_is_there_is_told_once() {
    let bench = studio();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let mut watch = Watch::start(&bench, &format!("studio/scene.toml --tev {address}"));
    let warning = watch.wait_for(|it| it["severity"] == "warning");
    assert!(warning["message"].as_str().unwrap().contains(&address.to_string()), "{warning}");
    watch.wait_for(|it| it["phase"] == "done");
    bench.write("studio/scene.toml", light(1));
    watch.wait_for(|it| it["phase"] == "done" && it["image"] == 2);
    let Ok(_tev) = TcpListener::bind(address) else { return };
    bench.write("studio/scene.toml", light(2));
    let is_there = |it: &Value| it["element"] == "--tev" && it["severity"] == "note";
    let came = watch.wait_for(|it| is_there(it) || it["severity"] == "warning");
    assert!(is_there(&came), "{came}");
}
