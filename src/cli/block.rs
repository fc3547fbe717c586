//! What `ajar watch` says on a terminal: messages, and below them a few lines that are kept up to date. Without a terminal,
//! a line for each thing that happens.

use std::{
    io,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use ajar_scene::{Diagnostic, Severity};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::{
    log::Format,
    progress::{PLAIN_INTERVAL, duration},
};
use crate::{
    image::Destination,
    watch::{Phase, State, View},
};

pub(super) struct Block<'a> {
    log: Format,
    least: Severity,
    /// The lines that are kept up to date, on a terminal.
    lines: Option<ProgressBar>,
    /// Link to the page.
    url: Option<String>,
    /// What is run after each finished image.
    command: Option<&'a str>,
    /// It at work.
    child: Option<Child>,
    /// What was last said where there is no terminal.
    said: Option<(u64, Phase, Instant)>,
}

impl<'a> Block<'a> {
    pub fn new(log: Format, least: Severity, url: Option<String>, command: Option<&'a str>) -> Self {
        let lines = (log.interactive() && least < Severity::Error).then(|| {
            let style =
                ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new_spinner().with_style(style)
        });
        let block = Self { log, least, lines, url, command, child: None, said: None };
        if let Some(url) = block.url.as_ref().filter(|_| block.lines.is_none() && least < Severity::Error) {
            log.progress(&format!("page {url}"), json!({ "page": url }));
        }
        block
    }

    /// Leaves the terminal as it is found, once the last command has ended.
    pub fn end(&mut self) {
        self.wait();
        if let Some(lines) = &self.lines {
            lines.finish_and_clear();
        }
    }

    /// Waits for the command of the image before: two at once could write the same files.
    fn wait(&mut self) {
        let Some(mut child) = self.child.take() else { return };
        match child.wait() {
            Ok(status) if status.success() => {}
            Ok(status) => self.complain(&format!("the command ended with {status}")),
            Err(error) => self.complain(&format!("the command cannot be waited for: {error}")),
        }
    }

    fn complain(&self, message: &str) {
        let warning = Diagnostic::warning(message).element("--exec");
        self.aside(|| self.log.messages(&[warning], Severity::Warning));
    }

    fn aside(&self, write: impl FnOnce()) {
        match &self.lines {
            Some(lines) => lines.suspend(write),
            None => write(),
        }
    }

    /// Says what a line would show, where there is none: whatever is new, and how the render goes now and then.
    fn plainly(&mut self, state: &State) {
        let is_new = self.said.is_none_or(|(image, phase, _)| (image, phase) != (state.image, state.phase));
        let is_due = self.said.is_none_or(|(.., at)| at.elapsed() >= PLAIN_INTERVAL);
        if (is_new || is_due) && self.least < Severity::Error {
            self.said = Some((state.image, state.phase, Instant::now()));
            let changed = if is_new && !state.shown_for.is_empty() {
                format!(" of {}", state.shown_for.join(", "))
            } else {
                String::new()
            };
            self.log.progress(&format!("image {}{changed}: {}", state.image, progress(state)), state);
        }
    }
}

impl View for Block<'_> {
    fn say(&mut self, messages: &[Diagnostic]) {
        self.aside(|| self.log.messages(messages, self.least));
    }

    fn show(&mut self, state: &State) {
        match &self.lines {
            Some(lines) => lines.set_message(describe(state, self.url.as_deref())),
            None => self.plainly(state),
        }
    }

    fn finish(&mut self, _state: &State, written: Option<&Destination>) {
        let Some(to) = written else { return };
        if self.least < Severity::Error {
            let note = Diagnostic::note("written").in_file(&to.exr);
            self.aside(|| self.log.messages(&[note], Severity::Note));
        }
        if let Some(command) = self.command {
            self.wait();
            match execute(command, to) {
                Ok(child) => self.child = Some(child),
                Err(error) => self.complain(&format!("the command cannot be run: {error}")),
            }
        }
    }
}

/// Starts a command.
fn execute(command: &str, image: &Destination) -> io::Result<Child> {
    let mut shell = if cfg!(windows) { Command::new("cmd") } else { Command::new("sh") };
    shell.arg(if cfg!(windows) { "/C" } else { "-c" }).arg(command);
    shell.env("AJAR_EXR", &image.exr).env("AJAR_PNG", &image.png).stdin(Stdio::null()).spawn()
}

/// The lines that are kept up to date.
fn describe(state: &State, url: Option<&str>) -> String {
    let mut lines = vec![format!("scene   {}", state.scene)];
    lines.extend(url.map(|url| format!("page    {url}")));
    if !state.shown_for.is_empty() {
        lines.push(format!("change  {}", state.shown_for.join(", ")));
    }
    lines.push(format!("image   {}: {}", state.image, progress(state)));
    lines.extend(state.errors.iter().take(3).map(|error| format!("error   {error}")));
    lines.join("\n")
}

fn progress(state: &State) -> String {
    let phase = match state.phase {
        Phase::Loading => return "reading the scene".into(),
        Phase::Waiting => return "waiting for a scene that can be rendered".into(),
        Phase::Rendering => "rendering",
        Phase::Done => "done",
        Phase::Stopped => "stopped",
    };
    let [width, height] = state.size;
    if state.rounds == 0 {
        return format!("{phase} {width}x{height}, no round finished yet");
    }
    let noise = state.noise.map_or(String::new(), |noise| format!(", noise {:.1} %", noise * 100.0));
    let time =
        Duration::try_from_secs_f64(state.seconds).map_or(String::new(), |t| format!(", {}", duration(t)));
    let left = state.seconds_left.and_then(|left| Duration::try_from_secs_f64(left).ok());
    let left = left.map_or(String::new(), |left| format!(", about {} left", duration(left)));
    format!("{phase} {width}x{height}, {} samples a pixel{noise}{time}{left}", state.samples)
}
