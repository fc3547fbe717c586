use std::{fs, sync::mpsc};

use super::*;

/// Longer than any burst may last.
const PATIENCE: Duration = Duration::from_secs(30);
/// A writer that takes its time, longer than a burst is quiet and shorter than it may last.
const PAUSE: Duration = Duration::from_millis(150);

/// A folder, files in it that are watched, and word of their changes.
struct Bench {
    folder: tempfile::TempDir,
    watcher: Watcher,
    heard: mpsc::Receiver<BTreeSet<PathBuf>>,
}

impl Bench {
    /// With the files of these names, which are there, and watches them and `missing` ones.
    fn new(poll: bool, files: &[&str], missing: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (sender, heard) = channel();
        let watcher = Watcher::new(poll, move |paths| drop(sender.send(paths))).unwrap();
        let bench = Self { folder, watcher, heard };
        files.iter().for_each(|name| bench.write(name, "before"));
        let paths = files.iter().chain(missing).map(|name| bench.path(name)).collect();
        // All that is there counts as changed since then: word of it says that watching has begun.
        bench.watcher.watch(paths, SystemTime::UNIX_EPOCH);
        bench.hears(files);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), text).unwrap();
    }

    fn rename(&self, from: &str, to: &str) {
        fs::rename(self.path(from), self.path(to)).unwrap();
    }

    /// Fails unless these files are the next that changed.
    #[track_caller]
    fn hears(&self, names: &[&str]) {
        let paths = self.heard.recv_timeout(PATIENCE).expect("no word of a change");
        assert_eq!(paths, names.iter().map(|name| self.path(name)).collect());
    }
}

/// What is done to a file, and how it is called.
type Save = (&'static str, fn(&Bench, &str, &str));

/// Ways in which programs save a file.
const SAVES: [Save; 5] = [
    ("in place", |bench, name, text| bench.write(name, text)),
    ("rename over", |bench, name, text| {
        bench.write("new.tmp", text);
        bench.rename("new.tmp", name);
    }),
    ("vim", |bench, name, text| {
        bench.rename(name, "backup~");
        bench.write(name, text);
        fs::remove_file(bench.path("backup~")).unwrap();
    }),
    ("truncate, then write", |bench, name, text| {
        bench.write(name, "");
        thread::sleep(PAUSE);
        bench.write(name, text);
    }),
    ("delete, then create", |bench, name, text| {
        fs::remove_file(bench.path(name)).unwrap();
        thread::sleep(PAUSE);
        bench.write(name, text);
    }),
];

#[test]
fn every_way_to_save_is_one_change() {
    for poll in [false, true] {
        let bench = Bench::new(poll, &["a", "b"], &[]);
        for (round, (way, save)) in SAVES.iter().cycle().take(SAVES.len() * 2).enumerate() {
            println!("{way}, poll: {poll}");
            save(&bench, "a", &format!("text {round}"));
            bench.hears(&["a"]);
        }
    }
}

#[test]
fn what_leaves_the_content_as_it_is_is_no_change() {
    for poll in [false, true] {
        let bench = Bench::new(poll, &["a", "b"], &[]);
        for (_, save) in SAVES {
            save(&bench, "a", "before");
        }
        fs::read(bench.path("a")).unwrap();
        bench.write("unknown", "text");
        bench.write("b", "after");
        bench.hears(&["b"]);
    }
}

#[test]
fn files_that_come_and_go_are_changes() {
    for poll in [false, true] {
        let bench = Bench::new(poll, &["a"], &["late", "far/away/file"]);
        bench.write("late", "text");
        bench.hears(&["late"]);
        bench.write("far/away/file", "text");
        bench.hears(&["far/away/file"]);
        bench.write("far/away/file", "text 2");
        bench.hears(&["far/away/file"]);
        fs::remove_file(bench.path("late")).unwrap();
        bench.hears(&["late"]);
        fs::remove_dir_all(bench.path("far")).unwrap();
        bench.hears(&["far/away/file"]);
        bench.write("far/away/file", "text 3");
        bench.hears(&["far/away/file"]);
    }
}

#[test]
fn folders_may_be_replaced() {
    let bench = Bench::new(false, &["look/a", "look/b"], &[]);
    bench.write("new/a", "after");
    bench.write("new/b", "before");
    bench.rename("look", "old");
    bench.rename("new", "look");
    bench.hears(&["look/a"]);
    bench.write("look/b", "after");
    bench.hears(&["look/b"]);
    bench.write("old/a", "nobody minds");
    bench.write("look/a", "after that");
    bench.hears(&["look/a"]);
}

#[test]
fn several_files_saved_together_are_one_change() {
    let bench = Bench::new(false, &["a", "b", "c"], &[]);
    for name in ["a", "c"] {
        bench.write(name, "after");
    }
    bench.hears(&["a", "c"]);
}

#[test]
fn what_is_no_longer_watched_is_no_change() {
    let bench = Bench::new(false, &["a", "b"], &[]);
    bench.write("c", "before");
    bench.watcher.watch(["b", "c"].map(|name| bench.path(name)).into(), SystemTime::UNIX_EPOCH);
    bench.hears(&["b", "c"]);
    bench.write("a", "after");
    bench.write("b", "after");
    bench.hears(&["b"]);
}

#[test]
fn what_took_a_place_since_then_is_a_change_however_old_it_is() {
    let bench = Bench::new(false, &["a"], &[]);
    thread::sleep(PAUSE);
    let since = SystemTime::now();
    bench.write("old", "after");
    let file = fs::File::options().write(true).open(bench.path("old")).unwrap();
    file.set_modified(since - Duration::from_secs(3600)).unwrap();
    thread::sleep(PAUSE);
    bench.rename("old", "b");
    bench.watcher.watch(["a", "b"].map(|name| bench.path(name)).into(), since);
    bench.hears(&["b"]);
}

#[test]
fn what_was_written_while_it_was_read_is_a_change_though_it_holds_the_same() {
    let bench = Bench::new(false, &["a", "b"], &[]);
    thread::sleep(PAUSE);
    let since = SystemTime::now();
    thread::sleep(PAUSE);
    bench.write("a", "before");
    bench.watcher.watch(["a", "b"].map(|name| bench.path(name)).into(), since);
    bench.hears(&["a"]);
}

#[cfg(unix)]
#[test]
fn links_far_above_may_lead_elsewhere() {
    let bench = Bench::new(false, &["v1/deep/down/a", "v2/deep/down/a"], &["latest/deep/down/a"]);
    std::os::unix::fs::symlink("v1", bench.path("latest")).unwrap();
    bench.hears(&["latest/deep/down/a"]);
    bench.write("v2/deep/down/a", "after");
    bench.hears(&["v2/deep/down/a"]);
    std::os::unix::fs::symlink("v2", bench.path("new")).unwrap();
    bench.rename("new", "latest");
    bench.hears(&["latest/deep/down/a"]);
    bench.rename("v2", "v3");
    bench.hears(&["latest/deep/down/a", "v2/deep/down/a"]);
}

#[cfg(unix)]
#[test]
fn links_may_be_changed_and_what_they_lead_to() {
    let bench = Bench::new(false, &["target", "other"], &["link"]);
    std::os::unix::fs::symlink("target", bench.path("link")).unwrap();
    bench.hears(&["link"]);
    bench.write("target", "after");
    bench.hears(&["link", "target"]);
    std::os::unix::fs::symlink("other", bench.path("new")).unwrap();
    bench.rename("new", "link");
    bench.hears(&["link"]);
}
