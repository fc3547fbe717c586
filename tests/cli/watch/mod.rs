//! `ajar watch`: what is saved is what is rendered.

mod command;
mod edits;
mod faults;
mod page;
mod saves;
mod snapshots;
mod socket;
mod studio;

use std::{
    io::{BufRead, BufReader},
    process::Child,
    sync::mpsc::{Receiver, channel},
    thread,
    time::Duration,
};

use serde_json::Value;

use crate::bench::Bench;
use studio::studio;

/// How long something that must come may take on a machine that is very busy.
const PATIENCE: Duration = Duration::from_secs(180);
/// Files written so shortly before they are opened count as changed, for clocks of file systems are coarse.
const CLOCK: Duration = Duration::from_millis(30);

/// A program that watches, and what it says.
struct Watch {
    child: Child,
    messages: Receiver<Value>,
}

impl Watch {
    fn start(bench: &Bench, arguments: &str) -> Self {
        Self::start_with(bench, arguments, &[])
    }

    /// With these environment variables.
    fn start_with(bench: &Bench, arguments: &str, variables: &[(&str, &str)]) -> Self {
        Self::run(bench, &format!("{arguments} --port 0"), variables)
    }

    /// At the port that it chooses itself.
    fn run(bench: &Bench, arguments: &str, variables: &[(&str, &str)]) -> Self {
        thread::sleep(CLOCK);
        let mut command = bench.command(&format!("watch {arguments} --log-format json -v"));
        // What it remembers is not for the user who runs tests.
        command.env("XDG_STATE_HOME", bench.path("state"));
        let mut child = command.envs(variables.iter().copied()).spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let (sender, messages) = channel();
        thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                // What is no JSON is not ours: what a plug-in says when it dies.
                let _ = sender.send(serde_json::from_str(&line).unwrap_or(Value::String(line)));
            }
        });
        Self { child, messages }
    }

    /// Waits for a message of which this is true.
    #[track_caller]
    fn wait_for(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        loop {
            let message = self.messages.recv_timeout(PATIENCE).unwrap();
            if what(&message) {
                return message;
            }
        }
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

    /// Asks it to end.
    fn interrupt(&self) {
        let id = self.child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    /// Asks it to end and returns all that it said before it did.
    fn end(mut self) -> Vec<Value> {
        self.interrupt();
        let rest = self.messages.iter().collect();
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
