//! Every way to save every kind of file is one change.

use std::{fs, thread, time::Duration};

use super::{
    Watch, is_what_render_makes,
    studio::{Variant, studio_of_all_formats},
};
use crate::bench::Bench;

/// Ways in which programs save a file.
fn save(bench: &Bench, way: u32, name: &str, content: &[u8]) {
    let (path, other) = (bench.path(name), bench.path(&format!("{name}.other")));
    let pause = Duration::from_millis(120);
    match way % 5 {
        0 => fs::write(path, content).unwrap(),
        1 => {
            fs::write(&other, content).unwrap();
            fs::rename(other, path).unwrap();
        }
        2 => {
            fs::rename(&path, &other).unwrap();
            fs::write(path, content).unwrap();
            fs::remove_file(other).unwrap();
        }
        3 => {
            fs::write(&path, "").unwrap();
            thread::sleep(pause);
            fs::write(path, content).unwrap();
        }
        _ => {
            fs::remove_file(&path).unwrap();
            thread::sleep(pause);
            fs::write(path, content).unwrap();
        }
    }
}

/// Saves one of the files, each number with another content.
fn save_one(bench: &Bench, files: &[Variant], number: u32) {
    let count = files.len() as u32;
    let (name, content) = files[(number % count) as usize];
    save(bench, number / count, name, &content(number));
}

#[test]
fn every_save_is_one_image_and_the_one_that_render_makes() {
    let (bench, files) = studio_of_all_formats();
    // Every way for every file. With AJAR_SAVES=1000 a test of an hour.
    let saves =
        std::env::var("AJAR_SAVES").ok().and_then(|n| n.parse().ok()).unwrap_or(5 * files.len() as u32);
    // Images beside the scene: what the program writes itself must not count.
    let (written, scene) = ("studio/out.exr", "studio/scene.toml");
    let mut watch = Watch::start(&bench, &format!("{scene} -o {written} --float"));
    watch.wait_for_image();
    is_what_render_makes(&bench, written, scene);
    let mut memory = Vec::new();
    for number in 1..=saves {
        save_one(&bench, &files, number);
        // Waits for ever, as it were, for what is missed.
        watch.wait_for_image();
        if number % 8 == 0 || number == saves {
            is_what_render_makes(&bench, written, scene);
        }
        memory.extend(resident(watch.child.id()));
    }
    // What would start by itself has time to.
    thread::sleep(Duration::from_secs(1));
    let late: Vec<_> = watch.end().into_iter().filter(|it| it["message"] == "written").collect();
    assert!(late.is_empty(), "nothing was saved for {late:?}");
    let Some((first, last)) = memory.first().zip(memory.last()) else { return };
    println!(
        "{saves} saves of {} files, {} images; resident memory {first} kB, later {last} kB",
        files.len(),
        saves + 1
    );
    if memory.len() > 200 {
        let settled = memory[memory.len() / 4];
        println!("after a quarter of them {settled} kB, at most {} kB", memory.iter().max().unwrap_or(last));
        assert!(*last < settled + settled / 5, "{settled} kB became {last} kB");
    }
}

/// Memory that a process holds, kB, where the system tells.
fn resident(id: u32) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[test]
fn looking_at_files_finds_the_same_changes() {
    let (bench, files) = studio_of_all_formats();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float --poll");
    watch.wait_for_image();
    for number in 1..=files.len() as u32 {
        save_one(&bench, &files, number);
        watch.wait_for_image();
    }
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}
