//! The command that runs after each finished image, on a thread of its own: the watch goes on meanwhile.

use std::{
    io,
    process::{Command, Stdio},
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use crate::image::Destination;

/// How long a command may go on after the user ended the program.
const GRACE: Duration = Duration::from_secs(3);
/// How long the wish of the user may go unnoticed.
const TICK: Duration = Duration::from_millis(50);

/// Runs a command for images, one at a time, for two at once could write the same files. Images that come while it runs
/// wait, of which the newest takes the place of those before.
pub(super) struct After {
    images: Sender<Destination>,
    /// Ends when the thread does.
    over: Receiver<()>,
}

impl After {
    /// For a command of the shell. What is wrong with it is told to `complain`.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn start(command: String, complain: impl Fn(&str) + Send + 'static) -> io::Result<Self> {
        let (images, waiting) = channel::<Destination>();
        let (alive, over) = channel();
        thread::Builder::new().name("command".into()).spawn(move || {
            let _alive: Sender<()> = alive;
            while let Ok(first) = waiting.recv() {
                let newest = waiting.try_iter().last().unwrap_or(first);
                match run(&command, &newest) {
                    Ok(None) => {}
                    Ok(Some(failure)) => complain(&failure),
                    Err(error) => complain(&format!("the command cannot be run: {error}")),
                }
            }
        })?;
        Ok(Self { images, over })
    }

    /// Runs it for an image that is written.
    pub fn image(&self, image: &Destination) {
        // The thread ends with this only.
        let _ = self.images.send(image.clone());
    }

    /// Waits until it has run for the last image, not for long once `stop` is raised. Returns whether it has.
    pub fn end(self, stop: &AtomicBool) -> bool {
        drop(self.images);
        let mut latest = None;
        loop {
            match self.over.recv_timeout(TICK) {
                Err(RecvTimeoutError::Timeout) => {}
                Ok(()) | Err(RecvTimeoutError::Disconnected) => return true,
            }
            if stop.load(Ordering::Relaxed)
                && Instant::now() >= *latest.get_or_insert_with(|| Instant::now() + GRACE)
            {
                return false;
            }
        }
    }
}

/// Runs a command to its end; returns how it failed, if it did.
fn run(command: &str, image: &Destination) -> io::Result<Option<String>> {
    let mut shell = if cfg!(windows) { Command::new("cmd") } else { Command::new("sh") };
    shell.arg(if cfg!(windows) { "/C" } else { "-c" }).arg(command);
    shell.env("AJAR_EXR", &image.exr).env("AJAR_PNG", &image.png).stdin(Stdio::null());
    let status = shell.status()?;
    Ok((!status.success()).then(|| format!("the command ended with {status}")))
}
