//! A program that is run with limits on silence and output.

use std::{
    fmt,
    io::{self, Read, Write},
    process::{Child, Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use ajar_scene::Cause;

/// Bytes of messages after which a program is stopped.
const MOST_MESSAGES: u64 = 16 << 20;
/// Time between two looks at a program that has closed its streams.
const LOOK: Duration = Duration::from_millis(2);
/// Bytes that are read at once.
const BLOCK: usize = 1 << 20;

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

/// What the threads that read its streams tell: that something came, or that it was too much.
type Sign = Result<(), Failure>;

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
        let (send, signs) = channel();
        let output = read(child.stdout.take(), self.most, send.clone());
        let messages = read(child.stderr.take(), MOST_MESSAGES, send);
        let ended = self.listen(&signs).and_then(|()| {
            let status = self.wait(&mut child)?;
            let [output, messages] = [output, messages].map(|thread| thread.join().unwrap_or_default());
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

    /// Waits until both streams are closed.
    fn listen(&self, signs: &Receiver<Sign>) -> Result<(), Failure> {
        loop {
            match signs.recv_timeout(self.silence) {
                Ok(sign) => sign?,
                Err(RecvTimeoutError::Timeout) => return Err(Failure::Silence(self.silence)),
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
    }
}

/// Ends a program.
fn stop(child: &mut Child) {
    // It may have ended by itself meanwhile.
    let _ = child.kill();
    let _ = child.wait();
}

/// Reads a stream to its end, in a thread of its own, unless it has more than `most` bytes.
fn read(pipe: Option<impl Read + Send + 'static>, most: u64, signs: Sender<Sign>) -> JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let (mut bytes, mut filled) = (Vec::new(), 0);
        if let Some(mut pipe) = pipe {
            loop {
                bytes.resize(filled + BLOCK, 0);
                // What was read before an error tells more than the error.
                let Ok(count @ 1..) = pipe.read(&mut bytes[filled..]) else { break };
                filled += count;
                let is_much = filled as u64 > most;
                let sign = if is_much { Err(Failure::Size(most)) } else { Ok(()) };
                if signs.send(sign).is_err() || is_much {
                    break;
                }
            }
        }
        bytes.truncate(filled);
        bytes
    })
}
