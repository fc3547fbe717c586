//! Images of before as files, one a change: `0003-box.mtl.exr`. A thread of its own writes them, so that the next image does
//! not wait for the disk.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, Sender, SyncSender, sync_channel},
    thread::{self, JoinHandle},
};

use ajar_scene::{Diagnostic, Severity};

use super::{Event, View, Watch, finished::write_as, opened::Opened};
use crate::{image::Destination, session::Rendered};

/// Images that may wait to be written; films are large.
const WAITING: usize = 2;
/// Longest name of a file, without number and extension.
const LONGEST: usize = 60;

/// A folder of images.
pub(super) struct Archive {
    folder: PathBuf,
    /// Number of the next file.
    next: u32,
    images: SyncSender<Image>,
    thread: JoinHandle<()>,
}

/// An image to be kept.
struct Image {
    exr: PathBuf,
    opened: Opened,
    rendered: Rendered,
    comment: String,
}

impl Archive {
    /// Begins to keep images in a folder, after those that are there. What is to be said about them becomes an event.
    ///
    /// # Errors
    /// The folder cannot be read, or the thread not be started.
    pub fn start(folder: PathBuf, events: Sender<Event>) -> io::Result<Self> {
        let next = fs::read_dir(&folder)?.filter_map(|entry| number(&entry.ok()?.path())).max();
        let (images, waiting) = sync_channel::<Image>(WAITING);
        let thread = thread::Builder::new().name("snapshots".into()).spawn(move || {
            for image in waiting {
                if let Some(message) = image.write() {
                    let _ = events.send(Event::Said(message));
                }
            }
        })?;
        Ok(Self { folder, next: next.map_or(1, |last| last.saturating_add(1)), images, thread })
    }

    /// Keeps an image of a scene, made for what `changed`.
    ///
    /// # Errors
    /// A warning: changes come faster than they can be written.
    fn keep(&mut self, opened: Opened, rendered: Rendered, changed: &[String]) -> Result<(), Diagnostic> {
        let label = if changed.is_empty() { "first image".into() } else { changed.join(", ") };
        let exr = self.folder.join(format!("{:04}-{}.exr", self.next, file_name(&label)));
        self.next = self.next.saturating_add(1);
        let comment = if changed.is_empty() { label } else { format!("changed: {label}") };
        self.images.try_send(Image { exr: exr.clone(), opened, rendered, comment }).map_err(|_| {
            Diagnostic::warning("is not kept: changes come faster than it can be written").in_file(exr)
        })
    }

    /// Waits until all are written; returns what was still to be said.
    pub fn end(self, events: &Receiver<Event>) -> Vec<Diagnostic> {
        drop(self.images);
        // A panic there is told as all others are.
        let _ = self.thread.join();
        let said = |event| if let Event::Said(message) = event { Some(message) } else { None };
        events.try_iter().filter_map(said).collect()
    }
}

impl Image {
    /// Returns what is to be said.
    fn write(self) -> Option<Diagnostic> {
        let output = self.opened.output.as_ref()?;
        let form = output.to.form.clone();
        let to = Destination { png: self.exr.with_extension("png"), exr: self.exr, form };
        match write_as(&to, &self.opened, output, &self.rendered, Some(&self.comment)) {
            Ok(_) => Some(Diagnostic::note("kept").in_file(&to.exr)),
            Err(error) => Some(Diagnostic { severity: Severity::Warning, ..error }),
        }
    }
}

impl Watch<'_> {
    /// The image at rest, if there is one, becomes a file where that is wanted.
    pub(super) fn keep_on_disk(&mut self, view: &mut dyn View) {
        let Some(archive) = &mut self.archive else { return };
        let rendered = self.resting.take().map(|it| it.rendered).filter(|it| it.film.rounds() > 0);
        let (Some(rendered), Some(opened)) = (rendered, self.opened.take()) else { return };
        if let Err(warning) = archive.keep(opened, rendered, &self.state.shown_for) {
            view.say(&[warning]);
        }
    }
}

/// What file systems and people can read of a label.
fn file_name(label: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
    let name: String = label.chars().map(plain).take(LONGEST).collect();
    name.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-")
}

/// The number of a file that was kept.
fn number(path: &Path) -> Option<u32> {
    path.file_name()?.to_str()?.split_once('-')?.0.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_become_names_of_files() {
        assert_eq!(file_name("box.mtl, scene.toml"), "box.mtl-scene.toml");
        assert_eq!(file_name("../../Möbel red/x:y"), "..-..-Möbel-red-x-y");
        assert_eq!(file_name(&"ä".repeat(100)).chars().count(), LONGEST);
    }

    #[test]
    fn numbers_are_read_back() {
        assert_eq!(number(Path::new("a/0042-box.mtl.exr")), Some(42));
        assert_eq!(number(Path::new("a/note.txt")), None);
        assert_eq!(number(Path::new("a/x-1.exr")), None);
    }
}
