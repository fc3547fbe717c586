//! A program that is run with limits on silence and output.

use std::{
    fmt,
    io::{self, Read, Write},
    process::{Child, Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    thread,
    time::{Duration, Instant},
};

use ajar_scene::Cause;

/// Bytes of messages that are kept.
const MOST_MESSAGES: usize = 1 << 22;
/// Bytes that are read at once.
const BLOCK: usize = 1 << 16;
/// Between two looks whether it has ended.
const POLL: Duration = Duration::from_millis(2);

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
        let (send, events) = channel();
        read(child.stdout.take(), Event::Output, &send);
        read(child.stderr.take(), Event::Message, &send);
        let collected = self.collect(&events);
        let ended = collected.and_then(|said| Ok((self.ended(&mut child)?, said)));
        if ended.is_err() {
            stop(&mut child);
        }
        let (status, (output, messages)) = ended?;
        Ok(End { status, output, messages })
    }

    /// How it ended, now that both streams are closed and nothing is left for it to do.
    fn ended(&self, child: &mut Child) -> Result<ExitStatus, Failure> {
        let closed = Instant::now();
        loop {
            match child.try_wait().map_err(Failure::Start)? {
                Some(status) => return Ok(status),
                None if closed.elapsed() > self.silence => return Err(Failure::Silence(self.silence)),
                None => thread::sleep(POLL),
            }
        }
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
                    messages.truncate(MOST_MESSAGES);
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
fn read(pipe: Option<impl Read + Send + 'static>, event: fn(Vec<u8>) -> Event, events: &Sender<Event>) {
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
