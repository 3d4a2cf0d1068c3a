use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Share done, in [0, 1].
    pub fraction: f64,
    /// Time since the start.
    pub elapsed: Duration,
    /// Estimated time left.
    pub remaining: Duration,
    /// Samples or mutations so far.
    pub steps: u64,
    /// Samples or mutations a second.
    pub rate: f64,
    /// Acceptance of small and of large steps; `None` without a chain.
    pub acceptance: Option<[f64; 2]>,
    /// Normalisation and its standard error; `None` without a chain.
    pub normalisation: Option<[f64; 2]>,
}

/// A render's strings: when to stop, whom to tell.
#[derive(Default)]
pub struct Control<'a> {
    /// Becomes true when the render is to stop soon and give what it has.
    pub stop: Option<&'a AtomicBool>,
    /// Told after every round.
    pub progress: Option<&'a mut dyn FnMut(&Progress)>,
}

impl Control<'_> {
    pub(crate) fn stopped(&self) -> bool {
        is_stopped(self.stop)
    }

    pub(crate) fn tell(&mut self, progress: &Progress) {
        if let Some(listener) = &mut self.progress {
            listener(progress);
        }
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control")
            .field("stop", &self.stop)
            .finish_non_exhaustive()
    }
}

/// Has the flag been raised?
pub(crate) fn is_stopped(stop: Option<&AtomicBool>) -> bool {
    #[cfg(test)]
    crate::stops::look(stop);
    stop.is_some_and(|flag| flag.load(Ordering::Relaxed))
}
