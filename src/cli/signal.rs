//! Ctrl-C and requests to terminate.
//!
//! The first one asks the render to end, so that the picture is saved; the second ends the program at
//! once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::Code;
use crate::integrate::Control;

/// Whether someone asked to stop.
pub(super) struct Stop {
    interrupted: Arc<AtomicBool>,
    terminated: Arc<AtomicBool>,
}

impl Stop {
    /// Listens from now on. Where the system does not allow it, signals keep their usual effect.
    pub(super) fn listen() -> Self {
        let listen = |signal: i32, code: Code| {
            let asked = Arc::new(AtomicBool::new(false));
            // In this order: the first signal finds the flag unset, sets it and goes on.
            let _ = flag::register_conditional_shutdown(signal, code as i32, Arc::clone(&asked));
            let _ = flag::register(signal, Arc::clone(&asked));
            asked
        };
        Self { interrupted: listen(SIGINT, Code::Interrupted), terminated: listen(SIGTERM, Code::Terminated) }
    }

    /// Whether to stop.
    pub(super) fn requested(&self) -> bool {
        self.code().is_some()
    }

    /// The exit code that says why.
    pub(super) fn code(&self) -> Option<Code> {
        if self.interrupted.load(Ordering::Relaxed) {
            Some(Code::Interrupted)
        } else if self.terminated.load(Ordering::Relaxed) {
            Some(Code::Terminated)
        } else {
            None
        }
    }
}

/// Ends a render, and watches nothing else of it.
impl Control for Stop {
    fn cancelled(&self) -> bool {
        self.requested()
    }
}
