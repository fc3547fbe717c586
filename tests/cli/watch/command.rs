//! The command that runs after each finished image.

use std::{fs, thread, time::Duration};

use super::{
    Watch,
    studio::{light, studio},
};

const A_WHILE: Duration = Duration::from_millis(20);

#[test]
fn images_go_on_while_a_command_runs_and_the_newest_waits() {
    let bench = studio();
    bench.write("after.sh", "until [ -e go ]; do sleep 0.05; done; echo ran >> log");
    fs::set_permissions(bench.path("after.sh"), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --exec ./after.sh");
    watch.wait_for_image();
    for number in 1..=3 {
        bench.write("studio/scene.toml", light(number));
        watch.wait_for_image();
    }
    bench.write("go", "");
    let log = || fs::read_to_string(bench.path("log")).unwrap_or_default();
    while log().lines().count() < 2 {
        thread::sleep(A_WHILE);
    }
    watch.end();
    assert_eq!(log().lines().count(), 2, "the first and the last");
}

#[test]
fn the_end_does_not_wait_for_ever() {
    let bench = studio();
    bench.write("after.sh", "echo $$ > id.part && mv id.part id; exec sleep 600");
    fs::set_permissions(bench.path("after.sh"), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --exec ./after.sh");
    watch.wait_for_image();
    while !bench.has("id") {
        thread::sleep(A_WHILE);
    }
    watch.interrupt();
    watch.wait_for(|it| it["message"] == "the command still runs");
    assert_eq!(watch.child.wait().unwrap().code(), Some(0));
    let id = fs::read_to_string(bench.path("id")).unwrap();
    std::process::Command::new("kill").arg(id.trim()).status().unwrap();
}
