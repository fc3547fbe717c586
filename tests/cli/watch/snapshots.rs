//! Images of before as files.

use std::{
    cell::{Cell, RefCell},
    fs,
};

use exr::prelude::MetaData;

use super::{Watch, studio::studio};
use crate::bench::Bench;

/// What an image says about itself.
fn comment(bench: &Bench, name: &str) -> String {
    let meta = MetaData::read_from_file(bench.path(name), true).unwrap();
    meta.headers[0].own_attributes.comments.as_ref().unwrap().to_string()
}

#[test]
fn each_change_leaves_an_image_and_so_does_the_end() {
    let bench = studio();
    bench.write("kept/0041-of-last-week.exr", "");
    let mut watch = Watch::start(&bench, "studio/scene.toml --float --snapshots kept");
    let first = watch.wait_for(|it| it["phase"] == "done")["image"].as_u64();
    bench.run("render studio/scene.toml -o first.exr --float").exits(0);
    bench.write("studio/box.mtl", "newmtl clay\nKd 0.1 0.2 0.3\n");
    // The old image is written while the new one is rendered: either may be first.
    let (kept, done) = (RefCell::new(None), Cell::new(false));
    watch.wait_for(|it| {
        if it["message"] == "kept" {
            kept.replace(it["file"].as_str().map(str::to_owned));
        }
        done.set(done.get() || it["phase"] == "done" && it["image"].as_u64() > first);
        done.get() && kept.borrow().is_some()
    });
    let kept = kept.into_inner().unwrap();
    assert!(kept.ends_with("0042-first-image.exr"), "{kept}");
    bench.run("render studio/scene.toml -o second.exr --float").exits(0);
    assert!(watch.end().iter().any(|it| it["message"] == "kept"));
    for (kept, rendered, said) in [
        ("kept/0042-first-image.exr", "first.exr", "first image"),
        ("kept/0043-box.mtl.exr", "second.exr", "changed: box.mtl"),
    ] {
        assert!(bench.image(kept).pixels == bench.image(rendered).pixels, "{kept}");
        assert_eq!(comment(&bench, kept), said);
    }
    let names = fs::read_dir(bench.path("kept")).unwrap().count();
    assert_eq!(names, 5, "two images with their previews, and what was there");
    let outside = fs::read_dir(bench.path("")).unwrap().filter(|entry| {
        let name = entry.as_ref().unwrap().file_name();
        name.to_string_lossy().ends_with("exr")
    });
    assert_eq!(outside.count(), 2, "nothing else is written");
}

#[test]
fn a_folder_that_cannot_be_is_an_error() {
    let bench = studio();
    bench.write("file", "");
    bench.run("watch studio/scene.toml --once --snapshots file/kept").exits(1).says(&["file/kept"]);
}
