//! A program that is run with limits on silence and output.

use std::{
    fmt,
    io::{self, Read, Write},
    process::{Child, Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread,
    time::{Duration, Instant},
};

use ajar_scene::Cause;

/// Bytes of messages after which a program is stopped.
const MOST_MESSAGES: u64 = 16 << 20;
/// Blocks that wait to be collected.
const WAITING: usize = 16;
/// Time between two looks at a program that has closed its streams.
const LOOK: Duration = Duration::from_millis(2);
/// Bytes that are read at once.
const BLOCK: usize = 1 << 16;

/// What is run, and its limits.
pub(super) struct Program {
    pub command: Command,
    /// What it finds on standard input.
    pub input: Vec<u8>,
    /// How long it may say nothing.
    pub silence: Duration,
    /// Bytes that it may print.
    pub most: u64,
}

/// How it ended.
pub(super) struct End {
    pub status: ExitStatus,
    pub output: Vec<u8>,
    pub messages: Vec<u8>,
}

/// Why it was stopped, or did not start.
#[derive(Debug)]
pub(super) enum Failure {
    Start(io::Error),
    Silence(Duration),
    Size(u64),
}

impl Failure {
    pub fn cause(&self) -> Cause {
        match self {
            Self::Start(_) => Cause::System,
            Self::Silence(_) => Cause::Asset,
            Self::Size(_) => Cause::Resource,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(error) => write!(f, "cannot be run: {error}"),
            Self::Silence(time) => write!(f, "was stopped: it said nothing for {} s", time.as_secs()),
            Self::Size(most) => write!(f, "was stopped: it printed more than {most} bytes"),
        }
    }
}

/// What the threads that read its streams tell.
enum Event {
    Output(Vec<u8>),
    Message(Vec<u8>),
    Closed,
}

impl Program {
    /// Runs it to its end.
    pub fn run(mut self) -> Result<End, Failure> {
        let streams = self.command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = streams.spawn().map_err(Failure::Start)?;
        if let Some(mut pipe) = child.stdin.take() {
            let input = std::mem::take(&mut self.input);
            // A program that does not want its input is no failure.
            thread::spawn(move || drop(pipe.write_all(&input)));
        }
        let (send, events) = sync_channel(WAITING);
        read(child.stdout.take(), Event::Output, &send);
        read(child.stderr.take(), Event::Message, &send);
        let ended = self.collect(&events).and_then(|(output, messages)| {
            let status = self.wait(&mut child)?;
            Ok(End { status, output, messages })
        });
        if ended.is_err() {
            stop(&mut child);
        }
        ended
    }

    /// Waits for the end of a program that has closed its streams: little should be left for it to do.
    fn wait(&self, child: &mut Child) -> Result<ExitStatus, Failure> {
        let start = Instant::now();
        while start.elapsed() < self.silence {
            if let Some(status) = child.try_wait().map_err(Failure::Start)? {
                return Ok(status);
            }
            thread::sleep(LOOK);
        }
        Err(Failure::Silence(self.silence))
    }

    fn collect(&self, events: &Receiver<Event>) -> Result<(Vec<u8>, Vec<u8>), Failure> {
        let (mut output, mut messages, mut open) = (Vec::new(), Vec::new(), 2);
        while open > 0 {
            match events.recv_timeout(self.silence) {
                Ok(Event::Output(block)) => {
                    output.extend(block);
                    if output.len() as u64 > self.most {
                        return Err(Failure::Size(self.most));
                    }
                }
                Ok(Event::Message(block)) => {
                    messages.extend(block);
                    if messages.len() as u64 > MOST_MESSAGES {
                        return Err(Failure::Size(MOST_MESSAGES));
                    }
                }
                Ok(Event::Closed) => open -= 1,
                Err(RecvTimeoutError::Timeout) => return Err(Failure::Silence(self.silence)),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok((output, messages))
    }
}

/// Ends a program.
fn stop(child: &mut Child) {
    // It may have ended by itself meanwhile.
    let _ = child.kill();
    let _ = child.wait();
}

/// Reads a stream to its end in a thread of its own.
fn read(pipe: Option<impl Read + Send + 'static>, event: fn(Vec<u8>) -> Event, events: &SyncSender<Event>) {
    let events = events.clone();
    thread::spawn(move || {
        let mut block = vec![0; BLOCK];
        if let Some(mut pipe) = pipe {
            // What was read before an error tells more than the error.
            while let Ok(count @ 1..) = pipe.read(&mut block) {
                if events.send(event(block[..count].to_vec())).is_err() {
                    return;
                }
            }
        }
        let _ = events.send(Event::Closed);
    });
}
