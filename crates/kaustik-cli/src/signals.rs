//! SIGINT and SIGTERM: the picture so far is written. A second SIGINT leaves at once, and so does either
//! signal before the first sample, as nothing is lost then. SIGHUP, where states are kept: picture and state
//! are written, and the render goes on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::lock::Locks;
use crate::{Failure, output};

/// What the signals have said so far.
#[derive(Debug)]
pub(crate) struct Signals {
    /// Raised by either.
    pub(crate) stop: Arc<AtomicBool>,
    /// Raised by SIGHUP, lowered by whoever has written what it asks for.
    pub(crate) hangup: Arc<AtomicBool>,
    which: Arc<AtomicUsize>,
    /// Raised when samples are taken.
    sampling: Arc<AtomicBool>,
}

impl Signals {
    /// Listens from now on; to SIGHUP, which would end the process, only if asked to.
    /// Who leaves before the first sample gives the locks back.
    pub(crate) fn listen(hangup_too: bool, locks: &Locks) -> Result<Self, Failure> {
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
        let sampling = Arc::new(AtomicBool::new(false));
        #[cfg(unix)]
        leave_early(&sampling, locks.release())?;
        Ok(Self {
            stop,
            hangup,
            which,
            sampling,
        })
    }

    /// From now on the render itself ends when it is told to.
    pub(crate) fn sampling(&self) {
        self.sampling.store(true, Ordering::Relaxed);
    }

    /// Exit status after a signal, if there was one.
    pub(crate) fn status(&self) -> Option<u8> {
        u8::try_from(self.which.load(Ordering::Relaxed))
            .ok()
            .filter(|status| *status != 0)
    }
}

/// Waits for a signal on a thread of its own: pilots do not look at flags.
#[cfg(unix)]
fn leave_early(
    sampling: &Arc<AtomicBool>,
    release: impl Fn() + Send + 'static,
) -> Result<(), Failure> {
    let sampling = Arc::clone(sampling);
    let mut signals =
        signal_hook::iterator::Signals::new([SIGINT, SIGTERM]).map_err(Failure::other)?;
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            let first = signals.forever().next();
            if sampling.load(Ordering::Relaxed) {
                return;
            }
            output::note("stopped before the first sample: nothing was written");
            release();
            std::process::exit(if first == Some(SIGINT) { 130 } else { 143 });
        })
        .map(drop)
        .map_err(Failure::other)
}
