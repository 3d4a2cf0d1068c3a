//! SIGINT and SIGTERM: the picture so far is written; a second SIGINT leaves at once. SIGHUP, where states are kept:
//! both are written, and the render goes on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::Failure;

/// What the signals have said so far.
#[derive(Debug)]
pub(crate) struct Signals {
    /// Raised by either.
    pub(crate) stop: Arc<AtomicBool>,
    /// Raised by SIGHUP, lowered by whoever has written what it asks for.
    pub(crate) hangup: Arc<AtomicBool>,
    which: Arc<AtomicUsize>,
}

impl Signals {
    /// Listens from now on; to SIGHUP, which would end the process, only if asked to.
    pub(crate) fn listen(hangup_too: bool) -> Result<Self, Failure> {
        let stop = Arc::new(AtomicBool::new(false));
        let hangup = Arc::new(AtomicBool::new(false));
        let which = Arc::new(AtomicUsize::new(0));
        // In this order: the shutdown looks at the flag that an earlier signal raised.
        flag::register_conditional_shutdown(SIGINT, 130, Arc::clone(&stop))
            .map_err(Failure::other)?;
        for (signal, status) in [(SIGINT, 130), (SIGTERM, 143)] {
            flag::register_usize(signal, Arc::clone(&which), status).map_err(Failure::other)?;
            flag::register(signal, Arc::clone(&stop)).map_err(Failure::other)?;
        }
        #[cfg(unix)]
        if hangup_too {
            flag::register(signal_hook::consts::SIGHUP, Arc::clone(&hangup))
                .map_err(Failure::other)?;
        }
        Ok(Self {
            stop,
            hangup,
            which,
        })
    }

    /// Exit status after a signal, if there was one.
    pub(crate) fn status(&self) -> Option<u8> {
        u8::try_from(self.which.load(Ordering::Relaxed))
            .ok()
            .filter(|status| *status != 0)
    }
}
