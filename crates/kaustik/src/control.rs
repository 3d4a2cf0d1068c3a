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

/// When a render is to stop, and whom it tells how far it is.
///
/// ```
/// use std::sync::atomic::{AtomicBool, Ordering};
/// use kaustik::scene::{Scene, builtin};
/// use kaustik::{Budget, Control, Outcome, Progress, RenderSettings, render};
///
/// let settings = RenderSettings {
///     width: 8,
///     height: 8,
///     budget: Budget::PerPixel(1_000_000),
///     ..RenderSettings::default()
/// };
/// let scene = Scene::new(&builtin::load("cornell")?, &settings.scene_options())?;
/// // Raised by a signal, a button or, as here, by what the render itself tells.
/// let stop = AtomicBool::new(false);
/// let mut progress = |progress: &Progress| stop.store(progress.steps > 0, Ordering::Relaxed);
/// let mut control = Control {
///     stop: Some(&stop),
///     progress: Some(&mut progress),
/// };
/// let done = render(&scene, &settings, &mut control)?;
/// assert_eq!(done.outcome, Outcome::Stopped);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Control<'a> {
    /// Becomes true when the render is to stop soon and give what it has. It must not become false again before the render
    /// returns: what has stopped and what has not yet would no longer fit.
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
