//! INT and TERM ask the render to stop and save; a second INT ends the program at once. USR1 asks for the image as it is.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};

/// What signals have asked for.
pub(super) struct Signals {
    stop: Arc<AtomicBool>,
    snapshot: Arc<AtomicBool>,
}

impl Signals {
    /// Begins to listen.
    ///
    /// # Errors
    /// The system refuses handlers.
    pub fn new() -> std::io::Result<Self> {
        let (stop, snapshot) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        // Order matters: the shutdown must see the flag as the first INT left it.
        flag::register_conditional_shutdown(SIGINT, 130, Arc::clone(&stop))?;
        for signal in [SIGINT, SIGTERM] {
            flag::register(signal, Arc::clone(&stop))?;
        }
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&snapshot))?;
        Ok(Self { stop, snapshot })
    }

    /// Raised by INT and TERM.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Whether USR1 came since this was last asked.
    pub fn snapshot_asked(&self) -> bool {
        self.snapshot.swap(false, Ordering::Relaxed)
    }
}
