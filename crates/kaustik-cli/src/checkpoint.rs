//! States on the way: written now and then, on SIGHUP, and at the end.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use kaustik::film::WriteError;
use kaustik::{
    Progress, RenderError, RenderSettings, RenderStatistics, Rendered, Snapshot, Source, Watch,
};

use crate::arguments::{OutputWords, RenderWords};
use crate::signals::Signals;
use crate::{output, picture};

/// Writes states and, on SIGHUP, the picture so far. What cannot be written is said, and tried again.
pub(crate) struct Checkpoints<'a> {
    /// Where the state goes; `None` keeps none.
    path: Option<&'a Path>,
    every: Duration,
    outputs: &'a OutputWords,
    settings: &'a RenderSettings,
    source: &'a Source,
    signals: &'a Signals,
    last: Instant,
    /// SIGHUP was heard in the round that ended just now.
    asked: bool,
    written: u32,
    failed: u32,
    /// Why the last state could not be written, if so.
    failure: Option<String>,
    /// Where the last one is, if no more than its name was refused.
    beside: Option<PathBuf>,
    spent: Duration,
}

impl<'a> Checkpoints<'a> {
    pub(crate) fn new(
        words: &'a RenderWords,
        settings: &'a RenderSettings,
        source: &'a Source,
        signals: &'a Signals,
    ) -> Self {
        Self {
            path: words.checkpoint.as_deref(),
            every: words.checkpoint_every,
            outputs: &words.outputs,
            settings,
            source,
            signals,
            last: Instant::now(),
            asked: false,
            written: 0,
            failed: 0,
            failure: None,
            beside: None,
            spent: Duration::ZERO,
        }
    }

    /// Where all that was rendered is kept, if the last state could be written.
    pub(crate) fn kept(&self) -> Option<&Path> {
        let there = self.written > 0 && self.failure.is_none();
        self.path.filter(|_| there)
    }

    /// Says what states cost and whether they are there; is the last one?
    pub(crate) fn report(&self, words: &OutputWords, statistics: &RenderStatistics) -> bool {
        let Some(path) = self.path else {
            return true;
        };
        let spent = self.spent.as_secs_f64();
        let share = 100.0 * spent / statistics.seconds.max(spent).max(1e-9);
        let (path, written) = (path.display(), self.written);
        picture::remark(
            words,
            &format!("{path}: {written} states in {spent:.2} s ({share:.2} % of the time)"),
        );
        if self.failed > 0 {
            output::note(&format!(
                "warning: {} of {} states could not be written",
                self.failed,
                self.failed + written
            ));
        }
        if let Some(failure) = &self.failure {
            output::note(&format!(
                "error: the last state could not be written, {path} holds an older one or none: {failure}"
            ));
        }
        self.failure.is_none()
    }
}

impl Watch for Checkpoints<'_> {
    fn wants_image(&mut self, _: &Progress) -> bool {
        std::mem::take(&mut self.asked)
    }

    fn see_image(&mut self, rendered: Rendered) {
        if let Err(failure) = picture::write(self.outputs, self.source, self.settings, rendered) {
            output::note(&format!("warning: {failure}; the render goes on"));
        }
    }

    fn image_failed(&mut self, error: RenderError) {
        output::note(&format!(
            "warning: no picture could be made: {error}; the render goes on"
        ));
    }

    fn pilot_done(&mut self) {
        self.signals.sampling();
    }

    fn wants_state(&mut self, _: &Progress, last: bool) -> bool {
        self.asked |= self.signals.hangup.swap(false, Ordering::Relaxed);
        self.path.is_some() && (last || self.asked || self.last.elapsed() >= self.every)
    }

    fn see_state(&mut self, snapshot: &Snapshot<'_>) {
        let Some(path) = self.path else {
            return;
        };
        let start = Instant::now();
        let written = snapshot.write(path, self.source);
        // Of states that could not take their name the newest is enough.
        let beside = match &written {
            Err(WriteError::NotRenamed { kept, .. }) => Some(kept.clone()),
            Err(_) => self.beside.take(),
            Ok(()) => None,
        };
        if let Some(older) = std::mem::replace(&mut self.beside, beside) {
            // Where it stays it is in nobody's way.
            let _ = std::fs::remove_file(older);
        }
        match written {
            Ok(()) => {
                self.written += 1;
                self.failure = None;
            }
            Err(error) => {
                self.failed += 1;
                self.failure = Some(error.to_string());
                output::note(&format!(
                    "warning: the state could not be written: {error}; the render goes on, an older state stays"
                ));
            }
        }
        self.last = Instant::now();
        self.spent += start.elapsed();
    }
}
