//! How much memory and time an input takes.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    fs,
    path::PathBuf,
    process,
    sync::{
        Arc,
        atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed},
    },
    thread,
    time::Duration,
};

/// The allocator of the system, with an eye on how much is held.
pub struct Meter;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

fn grow(bytes: usize) {
    MOST.fetch_max(HELD.fetch_add(bytes, Relaxed) + bytes, Relaxed);
}

// SAFETY: the system's allocator does all of it.
unsafe impl GlobalAlloc for Meter {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        grow(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        grow(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        grow(size);
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(memory, layout, size) }
    }
}

/// Forgets the most so far; answers with what is held.
pub fn reset() -> usize {
    let held = HELD.load(Relaxed);
    MOST.store(held, Relaxed);
    held
}

/// The most that was held since [`reset`].
pub fn most() -> usize {
    MOST.load(Relaxed)
}

/// Processor time of the whole process, where the system tells it as Linux does: in hundredths of a second.
pub fn processor_time() -> Option<Duration> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field, a name in parentheses, may hold spaces. User's and system's are the 14th and 15th.
    let (_, fields) = stat.rsplit_once(')')?;
    let ticks = fields.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<u64>().ok());
    Some(Duration::from_millis(10 * ticks.sum::<Option<u64>>()?))
}

/// Seconds on the clock after which an input counts as hung. Everything takes milliseconds, on a busy machine too.
const HANG: u64 = 120;

/// Ends the process when an input hangs: a thread cannot be stopped.
pub struct Watch {
    number: Arc<AtomicU64>,
}

impl Watch {
    /// `folder` holds the input that is tried.
    pub fn start(folder: PathBuf) -> Self {
        let number = Arc::new(AtomicU64::new(u64::MAX));
        let seen = Arc::downgrade(&number);
        thread::spawn(move || {
            let (mut last, mut seconds) = (u64::MAX, 0);
            while let Some(now) = seen.upgrade().map(|number| number.load(Relaxed)) {
                seconds = if now == last { seconds + 1 } else { 0 };
                last = now;
                if seconds >= HANG && now != u64::MAX {
                    eprintln!("input {now} hangs, it is in {}", folder.display());
                    process::abort();
                }
                thread::sleep(Duration::from_secs(1));
            }
        });
        Self { number }
    }

    /// An input begins.
    pub fn begin(&self, number: u64) {
        self.number.store(number, Relaxed);
    }
}
