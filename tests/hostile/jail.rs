//! Runs `ajar validate` on one file with limits on time and memory.

use std::{
    ffi::OsString,
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

/// Seconds of processor time, where the system can limit it: unlike time on the clock it does not depend on what else
/// the machine does.
const CPU_SECONDS: u32 = 5;

/// Time on the clock after which the program counts as hung.
const HANG: Duration = Duration::from_secs(120);

/// Address space of the program, bytes, where USD is read its memory; the file is given a quarter of it.
const MEMORY: u64 = 512 << 20;

/// Address space where USD is read: usd-core reserves more than a GiB that it hardly touches, and crashes without.
const USD_MEMORY: u64 = 2 << 30;

/// Runs a program and writes the largest memory that it or one of its children had at a time, in KiB.
const MEASURED: &str = "import resource, subprocess, sys\n\
    code = subprocess.call(sys.argv[2:])\n\
    with open(sys.argv[1], 'w') as file: file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))\n\
    sys.exit(code if code >= 0 else 128 - code)";

/// Bytes of messages about one file. More would bury what matters.
const MESSAGES: usize = 64 << 10;

/// What must become of a file.
#[derive(Clone, Copy, PartialEq)]
pub enum Fate {
    /// Exit code 3 and an error.
    Refused,
    /// Exit code 4 and an error: it asks for more than the limit.
    TooLarge,
    /// Exit code 0 and a warning.
    Warned,
    /// Refused or warned about.
    Noticed,
    /// Exit code 0 without warning.
    Clean,
    /// Refused, too large, or read with or without warnings.
    Either,
}

/// A folder for hostile files, and what went wrong with them so far.
pub struct Jail {
    folder: tempfile::TempDir,
    /// Environment of the program, besides its own.
    pub variables: Vec<(&'static str, String)>,
    escapes: Vec<String>,
}

impl Jail {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), variables: Vec::new(), escapes: Vec::new() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file that others refer to.
    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path
    }

    /// Writes a file and checks what becomes of it.
    pub fn try_file(&mut self, name: &str, bytes: impl AsRef<[u8]>, fate: Fate) {
        let path = self.put(name, bytes);
        self.try_path(&path, fate);
    }

    /// Checks what becomes of a file.
    pub fn try_path(&mut self, path: &Path, fate: Fate) {
        self.judge(path, fate, limited(MEMORY));
    }

    /// The same for a USD file, which may refer to others in `folder`. Memory is what is really used.
    pub fn try_usd(&mut self, path: &Path, folder: &Path, fate: Fate) {
        let (limited, measure) = (limited(USD_MEMORY), self.path("memory"));
        let mut command = Command::new(std::env::var_os("AJAR_USD_PYTHON").unwrap());
        command.args(["-c", MEASURED]).arg(&measure).arg(limited.get_program()).args(limited.get_args());
        command.arg("--allow").arg(folder);
        self.judge(path, fate, command);
        // Other systems count in other units.
        if cfg!(target_os = "linux") {
            let used = fs::read_to_string(measure).map_or(0, |kib| kib.parse::<u64>().unwrap() << 10);
            println!("{}: {} MiB", path.display(), used >> 20);
            if used > MEMORY {
                self.escapes.push(format!("{}: it takes {} MiB", path.display(), used >> 20));
            }
        }
    }

    fn judge(&mut self, path: &Path, fate: Fate, command: Command) {
        let (status, messages) = self.validate(path, command);
        if let Err(why) = judge(path, status, &messages, fate) {
            let shown: String = messages.chars().take(600).collect();
            self.escapes.push(format!("{}: {why}\n{shown}", path.display()));
        }
    }

    fn validate(&self, path: &Path, mut command: Command) -> (Option<ExitStatus>, String) {
        let log = self.path("messages.log");
        command.args(["--memory-limit", &(MEMORY / 4).to_string()]).arg(path);
        // Every thread reserves address space for itself, so there should not be one for each core.
        command.env("RAYON_NUM_THREADS", "2").env("MALLOC_ARENA_MAX", "2");
        command.envs(self.variables.iter().map(|(name, value)| (name, value)));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(File::create(&log).unwrap());
        let mut child = command.spawn().unwrap();
        let start = Instant::now();
        let status = loop {
            match child.try_wait().unwrap() {
                Some(status) => break Some(status),
                None if start.elapsed() > HANG => {
                    child.kill().unwrap();
                    child.wait().unwrap();
                    break None;
                }
                None => std::thread::sleep(Duration::from_millis(2)),
            }
        };
        (status, String::from_utf8_lossy(&fs::read(log).unwrap()).into_owned())
    }

    /// Fails with all files that had another fate than they should.
    pub fn close(self) {
        let count = self.escapes.len();
        assert!(count == 0, "{count} files:\n\n{}", self.escapes.join("\n\n"));
    }
}

/// `ajar validate` below the limits that the system can set, with this much address space.
fn limited(memory: u64) -> Command {
    let ajar = env!("CARGO_BIN_EXE_ajar");
    let limits = [format!("--as={memory}"), format!("--cpu={CPU_SECONDS}"), "--core=0".into()];
    let mut probe = Command::new("prlimit");
    if !probe.args(&limits).arg("true").status().is_ok_and(|status| status.success()) {
        println!("skipped: limits on memory and processor time, for lack of prlimit");
        let mut command = Command::new(ajar);
        command.arg("validate");
        return command;
    }
    let mut command = Command::new("prlimit");
    command.args(limits).arg(OsString::from(ajar)).arg("validate");
    command
}

fn judge(path: &Path, status: Option<ExitStatus>, messages: &str, fate: Fate) -> Result<(), String> {
    let Some(status) = status else { return Err("it hangs".into()) };
    let Some(code) = status.code() else { return Err(format!("it ends with {status}")) };
    // Messages about a file that this one refers to name that file, which lies in the same folder.
    let folder = path.parent().unwrap();
    let known = [folder.to_path_buf(), folder.canonicalize().unwrap()];
    let said = |what: &str| {
        let about = |line: &str| known.iter().any(|k| line.starts_with(&*k.to_string_lossy()));
        messages.lines().any(|line| about(line) && line.contains(what))
    };
    if messages.contains("panicked") || messages.contains("this is a defect") {
        return Err("it panics".into());
    }
    if messages.len() > MESSAGES {
        return Err(format!("{} bytes of messages", messages.len()));
    }
    match (code, fate) {
        (3, Fate::Refused | Fate::Noticed | Fate::Either) | (4, Fate::TooLarge | Fate::Either) => {
            if said("error: ") { Ok(()) } else { Err("no error names the file".into()) }
        }
        (0, Fate::Warned | Fate::Noticed) if said("warning: ") => Ok(()),
        (0, Fate::Clean) if !said("warning: ") => Ok(()),
        (0, Fate::Either) => Ok(()),
        _ => Err(format!("exit code {code}")),
    }
}
