//! The folders that the system is asked to tell about.

use std::{
    collections::{BTreeMap, BTreeSet, btree_map::Entry},
    path::{Path, PathBuf},
    sync::mpsc::Sender,
};

use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};

use super::Message;

pub(super) struct Folders {
    watcher: Option<RecommendedWatcher>,
    /// Those asked about, and whether the system agreed.
    folders: BTreeMap<PathBuf, bool>,
}

impl Folders {
    /// Folders whose events are sent.
    pub fn watched(events: Sender<Message>) -> Self {
        let send = move |event: notify::Result<notify::Event>| {
            if let Ok(event) = event {
                // Who receives has ended, and this will too.
                let _ = events.send(Message::Event(event));
            }
        };
        Self { watcher: notify::recommended_watcher(send).ok(), folders: BTreeMap::new() }
    }

    /// Folders that nobody tells about.
    pub fn unwatched() -> Self {
        Self { watcher: None, folders: BTreeMap::new() }
    }

    /// Watches the folders of these files and no others. Returns whether there is a new one.
    pub fn watch(&mut self, files: &BTreeSet<PathBuf>) -> bool {
        let wanted: BTreeSet<PathBuf> =
            files.iter().flat_map(|file| above(file)).map(Path::to_owned).collect();
        let Some(watcher) = &mut self.watcher else { return false };
        let mut is_new = false;
        self.folders.retain(|folder, _| {
            let stays = wanted.contains(folder);
            if !stays {
                // It may be gone.
                let _ = watcher.unwatch(folder);
            }
            stays
        });
        for folder in wanted {
            if let Entry::Vacant(place) = self.folders.entry(folder) {
                let agreed = watcher.watch(place.key(), RecursiveMode::NonRecursive).is_ok();
                place.insert(agreed);
                is_new = true;
            }
        }
        is_new
    }

    /// The same after `folder` or one below came or went: the system may still tell about the old one.
    pub fn renew(&mut self, folder: &Path, files: &BTreeSet<PathBuf>) {
        if let Some(watcher) = &mut self.watcher {
            self.folders.retain(|known, _| {
                let stays = !known.starts_with(folder);
                if !stays {
                    let _ = watcher.unwatch(known);
                }
                stays
            });
        }
        self.watch(files);
    }

    /// Whether changes of the file will be told.
    pub fn tells_of(&self, file: &Path) -> bool {
        let links = file.ancestors().filter(|path| path.is_symlink()).filter_map(Path::parent);
        above(file).take(2).chain(links).all(|folder| self.folders.get(folder) == Some(&true))
    }
}

/// All folders above that exist, the nearest first: in that one the file or a folder on the way to it comes to be, and the
/// others see the folders on the way go, or links lead elsewhere.
fn above(file: &Path) -> impl Iterator<Item = &Path> {
    file.ancestors().skip(1).filter(|folder| folder.is_dir())
}
