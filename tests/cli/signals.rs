//! What a running render does on signals.

use std::{
    fs,
    io::{BufRead, BufReader, Lines},
    process::{Child, ChildStderr, Command},
};

use serde_json::Value;

use crate::{
    bench::Bench,
    resume::{INTEGRATORS, content},
};

/// A render that takes ten minutes if nobody stops it, and its messages.
struct Render {
    child: Child,
    messages: Lines<BufReader<ChildStderr>>,
}

impl Render {
    fn start(bench: &Bench, more: &str) -> Self {
        let arguments = format!("render kitchen/scene.toml -o out.exr --time 10m {more}");
        let mut child = bench.command(&arguments).spawn().unwrap();
        let messages = BufReader::new(child.stderr.take().unwrap()).lines();
        Self { child, messages }
    }

    /// Waits for a message.
    #[track_caller]
    fn wait_for(&mut self, text: &str) {
        // No such line at all means that the program has ended.
        assert!(self.messages.any(|line| line.unwrap().contains(text)), "no message with {text:?}");
    }

    fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
    }

    /// The exit code.
    fn end(mut self) -> Option<i32> {
        self.messages.for_each(drop);
        self.child.wait().unwrap().code()
    }
}

fn stats(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("stats.json")).unwrap()).unwrap()
}

#[test]
fn an_interrupted_render_is_5_and_saved() {
    for signal in ["-INT", "-TERM"] {
        let bench = Bench::new();
        let mut render = Render::start(&bench, "--stats-json stats.json");
        render.wait_for("round ");
        render.signal(signal);
        assert_eq!(render.end(), Some(5), "{signal}");
        assert!(bench.image("out.exr").mean() > 0.01 && bench.has("out.png"));
        let stats = stats(&bench);
        assert_eq!(stats["complete"], false);
        assert!(stats["rounds"].as_u64().unwrap() > 0);
    }
}

#[test]
fn a_second_interrupt_ends_at_once() {
    // Messages that no pipe holds: the program waits for a reader, and cannot end as after a first INT.
    let bench = Bench::new();
    let folder = vec!["x".repeat(200); 6].join("/");
    let unknown: String = (0..100).map(|i| format!("unknown{i}\n")).collect();
    bench.write(&format!("{folder}/many.obj"), format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{unknown}"));
    let mut child = bench.command(&format!("render {folder}/many.obj -o out.exr")).spawn().unwrap();
    let mut messages = BufReader::new(child.stderr.take().unwrap()).lines();
    // The first message says that signals are listened to.
    assert!(messages.next().unwrap().unwrap().contains("warning: "));
    let id = child.id().to_string();
    let ended = (0..1000).find_map(|_| {
        // Signals of one kind that are pending together are one: sent until one ends the program.
        Command::new("kill").args(["-INT", &id]).status().unwrap();
        child.try_wait().unwrap()
    });
    if ended.is_none() {
        child.kill().unwrap();
    }
    assert_eq!(ended.expect("still running").code(), Some(130));
    assert!(!bench.has("out.exr"), "nothing is written");
}

#[test]
fn a_snapshot_is_written_and_the_render_goes_on() {
    let bench = Bench::new();
    let mut render = Render::start(&bench, "--stats-json stats.json");
    render.wait_for("round ");
    render.signal("-USR1");
    render.wait_for("snapshot after ");
    assert!(bench.image("out.exr").mean() > 0.01 && bench.has("out.png"));
    let snapshot = stats(&bench);
    assert_eq!(snapshot["complete"], false);
    render.wait_for("round ");
    render.signal("-INT");
    assert_eq!(render.end(), Some(5));
    assert!(stats(&bench)["rounds"].as_u64() > snapshot["rounds"].as_u64());
}

#[test]
fn an_interrupted_render_resumes_where_it_was() {
    for (integrator, signal) in INTEGRATORS.map(|it| (it, "-INT")).into_iter().chain([("mlt", "-TERM")]) {
        let bench = Bench::new();
        let how = format!("--integrator {integrator} --stats-json stats.json");
        let mut render = Render::start(&bench, &format!("{how} --checkpoint saved"));
        render.wait_for("round ");
        render.signal(signal);
        assert_eq!(render.end(), Some(5), "{integrator} {signal}");
        let rounds = stats(&bench)["rounds"].as_u64().unwrap() + 2;
        let again = format!("render kitchen/scene.toml --integrator {integrator} --rounds {rounds}");
        bench.run(&format!("{again} -o resumed.exr --resume saved")).exits(0);
        bench.run(&format!("{again} -o whole.exr")).exits(0);
        assert!(content(&bench, "resumed.exr") == content(&bench, "whole.exr"), "{integrator} {signal}");
    }
}

#[test]
fn a_killed_render_was_saved_in_time() {
    let bench = Bench::new();
    let mut render = Render::start(&bench, "--checkpoint saved --checkpoint-interval 1s");
    render.wait_for("round ");
    render.signal("-KILL");
    assert_eq!(render.end(), None);
    bench.run("merge saved -o saved.exr").exits(0);
    let image = content(&bench, "saved.exr");
    assert!(image.attributes["ajar:complete"].contains('0') && bench.image("saved.exr").mean() > 0.01);
}
