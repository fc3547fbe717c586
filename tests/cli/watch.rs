//! `ajar watch`: what is saved is what is rendered.

use std::{
    fs,
    io::{BufRead, BufReader, Lines},
    process::{Child, ChildStderr},
    thread,
    time::Duration,
};

use serde_json::Value;

use crate::bench::{Bench, SCENE};

const BOX: &str = "\
mtllib box.mtl\nusemtl clay
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
f 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";

/// A folder with a scene of several files.
fn studio() -> Bench {
    let bench = Bench::new();
    bench.write("studio/scene.toml", SCENE);
    bench.write("studio/box.obj", BOX);
    bench.write("studio/box.mtl", &material(0));
    fs::write(bench.path("studio/wood.ppm.png"), picture(0)).unwrap();
    bench
}

/// An MTL file, each number another.
fn material(number: u32) -> String {
    format!("newmtl clay\nKd 1 1 0.{number:03}\nmap_Kd wood.ppm.png\n")
}

/// A PNG of one pixel, each number another colour.
fn picture(number: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let code = number.to_le_bytes();
    encoder.write_header().unwrap().write_image_data(&[200, code[0], code[1]]).unwrap();
    bytes
}

/// The scene with another light, each number another.
fn light(number: u32) -> String {
    SCENE.replace("illuminance = 10", &format!("illuminance = {}", 10.0 + f64::from(number) / 16.0))
}

/// The box, each number another.
fn shape(number: u32) -> String {
    BOX.replace("v 1 1 1", &format!("v 1 {} 1", 1.0 + f64::from(number) / 1024.0))
}

/// A program that watches, and what it says.
struct Watch {
    child: Child,
    messages: Lines<BufReader<ChildStderr>>,
}

impl Watch {
    fn start(bench: &Bench, arguments: &str) -> Self {
        let mut child =
            bench.command(&format!("watch {arguments} --log-format json --port 0 -v")).spawn().unwrap();
        let messages = BufReader::new(child.stderr.take().unwrap()).lines();
        Self { child, messages }
    }

    /// Waits for a message of which this is true.
    #[track_caller]
    fn wait_for(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        let parsed = |line: std::io::Result<String>| serde_json::from_str::<Value>(&line.unwrap()).unwrap();
        // No such line at all means that the program has ended.
        self.messages.by_ref().map(parsed).find(what).unwrap()
    }

    /// Waits until a finished image is written.
    #[track_caller]
    fn wait_for_image(&mut self) {
        self.wait_for(|it| it["message"] == "written");
    }

    #[track_caller]
    fn wait_for_error(&mut self) -> Value {
        self.wait_for(|it| it["severity"] == "error")
    }

    /// Asks it to end and returns all that it said before it did.
    fn end(mut self) -> Vec<Value> {
        let id = self.child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let rest = self.messages.by_ref().map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect();
        assert_eq!(self.child.wait().unwrap().code(), Some(0));
        rest
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

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

/// Saves one of the files of the studio, each number with another content.
fn save_something(bench: &Bench, number: u32) {
    let (name, content) = match number % 4 {
        0 => ("studio/scene.toml", light(number).into_bytes()),
        1 => ("studio/box.mtl", material(number % 1000).into_bytes()),
        2 => ("studio/wood.ppm.png", picture(number)),
        _ => ("studio/box.obj", shape(number).into_bytes()),
    };
    save(bench, number / 4, name, &content);
}

/// Fails unless the image that was written is the one that a render of the files makes.
#[track_caller]
fn is_what_render_makes(bench: &Bench, written: &str, file: &str) {
    bench.run(&format!("render {file} -o fresh.exr --float")).exits(0);
    let (written, fresh) = (bench.image(written), bench.image("fresh.exr"));
    assert_eq!((written.window, &written.channels), (fresh.window, &fresh.channels));
    assert!(written.pixels == fresh.pixels, "the image is another one");
    assert!(fresh.mean() > 0.01);
}

#[test]
fn every_save_is_one_image_and_the_one_that_render_makes() {
    // With AJAR_SAVES=1000 a test of an hour of work.
    let saves = std::env::var("AJAR_SAVES").ok().and_then(|n| n.parse().ok()).unwrap_or(24);
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
    let mut memory = Vec::new();
    for number in 1..=saves {
        save_something(&bench, number);
        watch.wait_for_image();
        if number % 8 == 0 {
            is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
        }
        memory.extend(resident(watch.child.id()));
    }
    let late: Vec<_> = watch.end().into_iter().filter(|it| it["message"] == "written").collect();
    assert!(late.is_empty(), "nothing was saved for {late:?}");
    println!("resident memory after each save: {memory:?}");
    if let [.., last] = memory[..]
        && memory.len() > 200
    {
        let settled = memory[memory.len() / 4];
        assert!(last < settled + settled / 5, "{settled} pages became {last}");
    }
}

/// Pages of memory that a process holds, where the system tells.
fn resident(id: u32) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{id}/statm")).ok()?;
    text.split(' ').nth(1)?.parse().ok()
}

#[test]
fn looking_at_files_finds_the_same_changes() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float --poll");
    watch.wait_for_image();
    for number in 1..6 {
        save_something(&bench, number);
        watch.wait_for_image();
    }
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}

#[test]
fn a_broken_save_is_told_with_its_place_and_the_next_one_heals() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    bench.write("studio/scene.toml", &SCENE.replace("spp = 4", "spp = = 4"));
    let error = watch.wait_for_error();
    assert!(
        error["file"].as_str().unwrap().ends_with("scene.toml") && error["place"][0].as_u64() > Some(15),
        "{error}"
    );
    // The last image is done, and stays.
    watch.wait_for(|it| it["phase"] == "done" && !it["errors"].as_array().unwrap().is_empty());
    // A texture that changes while the scene is broken is not forgotten.
    fs::write(bench.path("studio/wood.ppm.png"), picture(99)).unwrap();
    thread::sleep(Duration::from_millis(300));
    bench.write("studio/scene.toml", &light(7));
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}

#[test]
fn a_missing_texture_heals_when_it_comes() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    let wood = bench.path("studio/wood.ppm.png");
    fs::remove_file(&wood).unwrap();
    // OBJ goes on without; either way something is said about it.
    watch.wait_for(|it| it.to_string().contains("wood.ppm.png") && it["severity"].is_string());
    fs::write(wood, picture(3)).unwrap();
    watch.wait_for_image();
    thread::sleep(Duration::from_millis(500));
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}

#[test]
fn a_scene_that_is_not_there_yet_is_waited_for() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/late/look.toml -o out.exr --float");
    watch.wait_for(|it| it["phase"] == "waiting");
    bench.write("studio/late/box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    bench.write("studio/late/look.toml", SCENE);
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/late/look.toml");
}

#[test]
fn an_asset_that_is_half_written_does_not_take_the_image_away() {
    let bench = Bench::new();
    bench.run("convert kitchen/scene.toml -o box.ajar").exits(0);
    let whole = fs::read(bench.path("box.ajar")).unwrap();
    let mut watch = Watch::start(&bench, "box.ajar -o out.exr --float --size 24x16 --spp 4");
    watch.wait_for_image();
    fs::write(bench.path("box.ajar"), &whole[..whole.len() / 2]).unwrap();
    watch.wait_for_error();
    fs::write(bench.path("box.ajar"), &whole).unwrap();
    watch.wait_for_image();
}

#[test]
fn once_is_for_scripts() {
    let bench = studio();
    bench.write("after.sh", "cp \"$AJAR_EXR\" copy.exr");
    let run = bench.run("watch studio/scene.toml --once -o out.exr --float --exec ./after.sh").exits(0);
    assert!(run.err.contains("Permission denied") || run.err.contains("126"), "{}", run.err);
    let command = |exec: &str| {
        let mut command = bench.command("watch studio/scene.toml --once -o out.exr --float --exec");
        command.arg(exec).output().unwrap()
    };
    assert_eq!(command("sh after.sh").status.code(), Some(0));
    is_what_render_makes(&bench, "copy.exr", "studio/scene.toml");
    bench.write("studio/scene.toml", "[render]\nsize = 3");
    bench.run("watch studio/scene.toml --once").exits(3).says(&["scene.toml:2:"]);
    bench.run("watch missing.glb --once").exits(3).says(&["missing.glb"]);
    bench.run("watch studio/scene.toml --once --camera nobody").exits(3);
}
