//! Files that somebody depends on, and word of it when what they hold has changed.
//!
//! The folders of the files are watched, not the files: most editors write a new file and rename it over the old one, and
//! a file that is missing has nothing to watch. What an event names counts as changed only if its content has another hash
//! than before, so that reading, touching and writing the same again are not changes. Files on network mounts, where the
//! system tells of no changes by others, are looked at now and then.

mod content;
mod folders;
mod mounts;
mod pending;
#[cfg(test)]
mod tests;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    thread,
    time::{Duration, Instant, SystemTime},
};

use notify::{
    Event, EventKind,
    event::{AccessKind, AccessMode},
};

use content::{Content, Stamp};
use folders::Folders;
use pending::Pending;

/// How often files are looked at where the system does not tell.
const POLL: Duration = Duration::from_millis(500);

/// Watches files; ends when dropped.
#[derive(Debug)]
pub struct Watcher(Sender<Message>);

enum Message {
    /// Watch these, of which those that are written since then are changed already.
    Watch(BTreeSet<PathBuf>, SystemTime),
    Event(Event),
    /// The watcher is gone.
    End,
}

impl Watcher {
    /// Starts to watch nothing. `changed` hears, on another thread, of files whose content has changed: once a burst of
    /// changes, as soon as it is over. With `poll`, the system is not asked to tell of changes.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn new(poll: bool, changed: impl Fn(BTreeSet<PathBuf>) + Send + 'static) -> std::io::Result<Self> {
        let (sender, receiver) = channel();
        let events = sender.clone();
        thread::Builder::new().name("files".into()).spawn(move || {
            let folders = if poll { Folders::unwatched() } else { Folders::watched(events) };
            State { files: BTreeMap::new(), folders, pending: Pending::default() }.run(&receiver, changed);
        })?;
        Ok(Self(sender))
    }

    /// Watches these files and no others, whether they exist or not. Those that are written or put there after `since`
    /// count as changed, whatever they hold: who has read them meanwhile may have read anything.
    pub fn watch(&self, files: BTreeSet<PathBuf>, since: SystemTime) {
        // The thread ends with this watcher only.
        let _ = self.0.send(Message::Watch(files, since));
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.0.send(Message::End);
    }
}

/// A file that is watched.
struct File {
    /// As of the last word of a change.
    content: Content,
    /// Where links lead.
    real: PathBuf,
    /// As of the last look.
    stamp: Option<Stamp>,
    /// Whether it has to be looked at.
    polled: bool,
}

/// Where links on the way lead, or the path as it is if there is nothing.
fn real(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

struct State {
    files: BTreeMap<PathBuf, File>,
    folders: Folders,
    pending: Pending,
}

impl State {
    fn run(&mut self, messages: &Receiver<Message>, changed: impl Fn(BTreeSet<PathBuf>)) {
        let mut look = Instant::now() + POLL;
        loop {
            let polls = self.files.values().any(|file| file.polled).then_some(look);
            let next = [polls, self.pending.due()].into_iter().flatten().min();
            let message = match next {
                None => messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(at) => messages.recv_timeout(at.saturating_duration_since(Instant::now())),
            };
            match message {
                Ok(Message::Watch(files, since)) => self.watch(files, since),
                Ok(Message::Event(event)) => self.hear(&event),
                Err(RecvTimeoutError::Timeout) => {}
                Ok(Message::End) | Err(RecvTimeoutError::Disconnected) => return,
            }
            if Instant::now() >= look {
                self.look();
                look = Instant::now() + POLL;
            }
            if let Some(paths) = self.settle()
                && !paths.is_empty()
            {
                changed(paths);
            }
        }
    }

    fn watch(&mut self, files: BTreeSet<PathBuf>, since: SystemTime) {
        self.files.retain(|path, _| files.contains(path));
        for (path, file) in &mut self.files {
            if Stamp::of(path).is_some_and(|stamp| stamp.is_since(since)) {
                file.content = Content::Unknown;
                self.pending.add(path.clone());
            }
        }
        let new: Vec<_> = files.into_iter().filter(|path| !self.files.contains_key(path)).collect();
        let wanted =
            self.paths().into_iter().chain(new.iter().cloned()).chain(new.iter().map(|path| real(path)));
        self.folders.watch(&wanted.collect());
        for path in new {
            let stamp = Stamp::of(&path);
            let is_late = stamp.is_some_and(|stamp| stamp.is_since(since));
            let content = if is_late { Content::Unknown } else { Content::of(&path) };
            let real = real(&path);
            let polled =
                [&path, &real].into_iter().any(|it| !self.folders.tells_of(it) || mounts::is_remote(it));
            if is_late {
                self.pending.add(path.clone());
            }
            self.files.insert(path, File { content, stamp, polled, real });
        }
    }

    /// Where files are and links lead.
    fn paths(&self) -> BTreeSet<PathBuf> {
        self.files.iter().flat_map(|(path, file)| [path, &file.real]).cloned().collect()
    }

    fn hear(&mut self, event: &Event) {
        let is_reading =
            matches!(event.kind, EventKind::Access(kind) if kind != AccessKind::Close(AccessMode::Write));
        if is_reading {
            return;
        }
        if event.need_rescan() {
            // The system lost count: any file may have changed.
            self.files.keys().for_each(|path| self.pending.add(path.clone()));
        }
        for path in &event.paths {
            let named = self.files.iter().filter(|(it, file)| *it == path || file.real == *path);
            let named: Vec<_> = named.map(|(it, _)| it.clone()).collect();
            if named.is_empty() {
                self.hear_of_folder(path);
            }
            named.into_iter().for_each(|path| self.pending.add(path));
        }
    }

    /// A folder above files came or went, or something that nobody depends on changed.
    fn hear_of_folder(&mut self, folder: &Path) {
        let is_below =
            |path: &PathBuf, file: &File| path.starts_with(folder) || file.real.starts_with(folder);
        let below =
            self.files.iter().filter(|(path, file)| is_below(path, file)).map(|(path, _)| path.clone());
        let below: Vec<_> = below.collect();
        if !below.is_empty() {
            self.folders.renew(folder, &self.paths());
            below.into_iter().for_each(|path| self.pending.add(path));
        }
    }

    fn look(&mut self) {
        for (path, file) in self.files.iter_mut().filter(|(_, file)| file.polled) {
            let stamp = Stamp::of(path);
            // Clocks of file systems are coarse: what was just written may change again unseen.
            if stamp != file.stamp || stamp.is_some_and(|stamp| stamp.is_recent()) {
                file.stamp = stamp;
                if Content::of(path) != file.content {
                    self.pending.add(path.clone());
                }
            }
        }
    }

    /// The files that have changed, once they are still.
    fn settle(&mut self) -> Option<BTreeSet<PathBuf>> {
        if !self.pending.is_still() {
            return None;
        }
        // A folder may have come between looking for it and watching the one above, and what is in it changed since.
        if self.folders.watch(&self.paths()) && self.pending.wait_longer() {
            return None;
        }
        let found: BTreeMap<_, _> = self
            .pending
            .paths()
            .filter_map(|path| Some((path, self.files.get(path)?)))
            .map(|(path, file)| (path.clone(), Content::of(path), &file.content))
            .filter(|(_, now, before)| now != *before)
            .map(|(path, now, _)| (path, now))
            .collect();
        // Nobody saves an empty file: it, or another in its place, is about to be written.
        if found.values().any(Content::is_empty) && self.pending.wait_longer() {
            return None;
        }
        self.pending.clear();
        let paths = found.keys().cloned().collect();
        let mut is_moved = false;
        for (path, content) in found {
            if let Some(file) = self.files.get_mut(&path) {
                let real = real(&path);
                is_moved |= real != file.real;
                (file.content, file.real) = (content, real);
            }
        }
        if is_moved {
            self.folders.watch(&self.paths());
        }
        Some(paths)
    }
}
