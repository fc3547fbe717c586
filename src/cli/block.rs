//! What `ajar watch` says on a terminal: messages, and below them a few lines that are kept up to date. Without a terminal,
//! a line for each thing that happens.

use std::{
    io,
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

use ajar_scene::{Diagnostic, Severity};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::{
    after::After,
    log::Format,
    progress::{PLAIN_INTERVAL, duration, samples},
};
use crate::{
    image::Destination,
    watch::{Phase, State, View},
};

pub(super) struct Block {
    log: Format,
    least: Severity,
    /// The lines that are kept up to date, on a terminal.
    lines: Option<ProgressBar>,
    /// Link to the page.
    url: Option<String>,
    /// The command that runs after each finished image.
    after: Option<After>,
    /// What was last said where there is no terminal.
    said: Option<(u64, Phase, Instant)>,
}

impl Block {
    /// `command` runs after each finished image.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn new(
        log: Format,
        least: Severity,
        url: Option<String>,
        command: Option<String>,
    ) -> io::Result<Self> {
        let lines = (log.interactive() && least < Severity::Error).then(|| {
            let style =
                ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new_spinner().with_style(style)
        });
        let beside = lines.clone();
        let complains = move |message: &str| complain(log, beside.as_ref(), message);
        let after = command.map(|command| After::start(command, complains)).transpose()?;
        let block = Self { log, least, lines, url, after, said: None };
        if let Some(url) = block.url.as_ref().filter(|_| block.lines.is_none() && least < Severity::Error) {
            log.progress(&format!("page {url}"), json!({ "page": url }));
        }
        Ok(block)
    }

    /// Leaves the terminal as it is found, once the last command has ended; it is not waited for long once `stop` is raised.
    pub fn end(self, stop: &AtomicBool) {
        if let Some(after) = self.after
            && !after.end(stop)
        {
            complain(self.log, self.lines.as_ref(), "the command still runs");
        }
        if let Some(lines) = &self.lines {
            lines.finish_and_clear();
        }
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

impl View for Block {
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
        if let Some(after) = &self.after {
            after.image(to);
        }
    }
}

/// Says what is wrong with the command, above the lines that are kept up to date.
fn complain(log: Format, lines: Option<&ProgressBar>, message: &str) {
    let warning = Diagnostic::warning(message).element("--exec");
    let write = || log.messages(&[warning], Severity::Warning);
    match lines {
        Some(lines) => lines.suspend(write),
        None => write(),
    }
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
        let glance = match state.samples {
            0 => String::new(),
            count => format!(", eye paths of {} meanwhile", samples(count)),
        };
        return format!("{phase} {width}x{height}, no round finished yet{glance}");
    }
    let noise = state.noise.zip(state.worst_tile).map_or(String::new(), |(noise, worst)| {
        format!(", noise {:.1} % (worst tile {:.0} %)", noise * 100.0, worst * 100.0)
    });
    let time =
        Duration::try_from_secs_f64(state.seconds).map_or(String::new(), |t| format!(", {}", duration(t)));
    let left = state.seconds_left.and_then(|left| Duration::try_from_secs_f64(left).ok());
    let left = left.map_or(String::new(), |left| format!(", about {} left", duration(left)));
    let rejected = match state.rejected {
        0 => String::new(),
        rejected => format!(", {rejected} contributions that were not finite left out"),
    };
    format!("{phase} {width}x{height}, {}{noise}{time}{left}{rejected}", samples(state.samples))
}
