//! SIGINT and SIGTERM: the first asks what runs to stop at a step and write what it has, the second
//! ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::Failure;

/// A shell's exit code for a program that a signal ended is this and the signal's number.
const BY_SIGNAL: usize = 128;

/// What came from outside to stop the program.
pub struct Signals {
    stop: Arc<AtomicBool>,
    /// 0 until one came.
    number: Arc<AtomicUsize>,
}

impl Signals {
    /// From now on signals ask to stop instead of ending the program.
    ///
    /// # Errors
    /// A handler that the system refuses.
    pub fn catch() -> Result<Signals, Failure> {
        Signals::caught().map_err(|error| Failure::message(format!("signals: {error}")))
    }

    fn caught() -> std::io::Result<Signals> {
        let signals = Signals {
            stop: Arc::default(),
            number: Arc::default(),
        };
        for number in [SIGINT, SIGTERM] {
            let code = BY_SIGNAL as i32 + number;
            // In this order: the flag is set by the first signal, so that the second finds it.
            flag::register_conditional_shutdown(number, code, Arc::clone(&signals.stop))?;
            flag::register_usize(number, Arc::clone(&signals.number), number as usize)?;
            flag::register(number, Arc::clone(&signals.stop))?;
        }
        Ok(signals)
    }

    /// Set once a signal came.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Whether a signal came.
    pub fn came(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The exit code that tells of the signal, if one came: 130 for SIGINT, 143 for SIGTERM.
    pub fn exit_code(&self) -> Option<u8> {
        let code = BY_SIGNAL + self.number.load(Ordering::Relaxed);
        self.came().then(|| u8::try_from(code).unwrap_or(u8::MAX))
    }
}
