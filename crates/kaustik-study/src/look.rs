//! One render, looked at once or at several times, each look kept as soon as it is taken.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use kaustik::{
    Budget, Control, Outcome, Progress, RenderError, RenderSettings, Rendered, Watch,
    render_watched,
};

use crate::clock::Clock;
use crate::key::{Amount, Key, Render};
use crate::stage::Stage;
use crate::store::{Record, Store};
use crate::study::options;
use crate::{Study, StudyError};

/// What to render and what to keep of it.
pub(crate) struct Look<'a> {
    pub(crate) study: &'a Study,
    pub(crate) store: &'a Store,
    pub(crate) clock: &'a dyn Clock,
    /// When, under which key, and whether that is kept already. One amount of samples, or rising times.
    pub(crate) looks: &'a [(Amount, Key, bool)],
}

/// Longer than any study.
const FOREVER: Duration = Duration::from_secs(100 * 365 * 86_400);

impl Look<'_> {
    /// Renders until the last look. `tell` hears the share done and may break it off.
    pub(crate) fn render(
        &self,
        stage: &Stage<'_>,
        render: &Render<'_>,
        tell: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), StudyError> {
        let settings = self.settings(render)?;
        let scene = stage.scene(settings.options.compensation)?;
        let stop = AtomicBool::new(false);
        let mut eyes = Eyes {
            look: self,
            start: self.clock.seconds(),
            now: 0.0,
            away: 0.0,
            next: 0,
            stop: &stop,
            broken: false,
            failed: None,
            tell,
        };
        let mut control = Control {
            stop: Some(&stop),
            progress: None,
        };
        let done = render_watched(scene, &settings, &mut control, &mut eyes);
        let done = done.map_err(|source| StudyError::Render {
            what: format!("{}, seed {}", render.method, render.seed),
            source,
        })?;
        if let Some(error) = eyes.failed.take() {
            return Err(error);
        }
        if eyes.broken {
            return Err(StudyError::Stopped);
        }
        // The end of a count of samples; or of a render that found no light, however long.
        if done.outcome != Outcome::Stopped {
            eyes.now = eyes.elapsed();
            eyes.keep(&done, self.looks.len());
        }
        eyes.failed.map_or(Ok(()), Err)
    }

    fn settings(&self, render: &Render<'_>) -> Result<RenderSettings, StudyError> {
        let options = options(render.method, render.settings)
            .map_err(|message| StudyError::words("settings", message))?;
        let budget = match render.amount {
            Amount::Samples(budget) => budget,
            Amount::Seconds(_) => Budget::Time(FOREVER),
        };
        Ok(RenderSettings {
            method: render.method,
            options,
            width: self.study.width,
            height: self.study.height,
            budget,
            seed: render.seed,
            threads: render.threads,
            max_depth: self.study.max_depth,
            features: render.layers,
            ..RenderSettings::default()
        })
    }
}

struct Eyes<'a, 'b> {
    look: &'a Look<'a>,
    /// By the clock.
    start: f64,
    /// Seconds of rendering when the picture was last wanted.
    now: f64,
    /// Seconds that looking took: developing and writing are not the method's.
    away: f64,
    /// The first look that is not yet taken.
    next: usize,
    stop: &'a AtomicBool,
    broken: bool,
    failed: Option<StudyError>,
    tell: &'b mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Eyes<'_, '_> {
    fn elapsed(&self) -> f64 {
        self.look.clock.seconds() - self.start - self.away
    }

    /// Keeps the picture for all looks before `end`.
    fn keep(&mut self, rendered: &Rendered, end: usize) {
        let record = Record {
            seconds: self.now,
            per_pixel: rendered.statistics.per_pixel,
            statistics: serde_json::to_value(&rendered.statistics).unwrap_or_default(),
        };
        for (_, key, kept) in &self.look.looks[self.next..end] {
            if *kept || self.failed.is_some() {
                continue;
            }
            if let Err(error) = self.look.store.keep(key, &record, &rendered.image) {
                self.failed = Some(error);
            }
        }
        self.next = end;
        if self.failed.is_some() {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    /// How many looks are due after so many seconds.
    fn due(&self) -> usize {
        let due = |amount: &Amount| matches!(amount, Amount::Seconds(s) if *s <= self.now);
        self.look
            .looks
            .iter()
            .take_while(|look| due(&look.0))
            .count()
    }
}

impl Watch for Eyes<'_, '_> {
    fn wants_image(&mut self, progress: &Progress) -> bool {
        self.now = self.elapsed();
        let share = match self.look.looks.last() {
            Some((Amount::Seconds(last), ..)) => self.now / last,
            _ => progress.fraction,
        };
        if (self.tell)(share).is_break() {
            self.broken = true;
            self.stop.store(true, Ordering::Relaxed);
            return false;
        }
        self.due() > self.next
    }

    /// A render that goes on for ever is to end with its last look.
    fn image_failed(&mut self, source: RenderError) {
        let what = "a look at a render".to_owned();
        self.failed = Some(StudyError::Render { what, source });
        self.stop.store(true, Ordering::Relaxed);
    }

    fn see_image(&mut self, rendered: Rendered) {
        self.keep(&rendered, self.due());
        if self.next == self.look.looks.len() {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.away = self.look.clock.seconds() - self.start - self.now;
    }
}
