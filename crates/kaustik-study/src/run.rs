//! Rendering what is missing of a study.

use std::ops::ControlFlow;
use std::path::Path;

use kaustik::Budget;
use kaustik::film::metrics::Spread;
use kaustik::film::{Image, Keep};

use crate::clock::{Clock, clock};
use crate::key::{Amount, Key, Render, scene_words};
use crate::look::Look;
use crate::results::{ReferenceResult, Results, evaluate};
use crate::stage::Stage;
use crate::store::{Record, Store};
use crate::{MethodEntry, SceneEntry, Study, StudyError, Unit};

/// How far a study is.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyProgress<'a> {
    /// Share done, in [0, 1], each render and each reference counted alike.
    pub fraction: f64,
    /// What is being rendered.
    pub what: &'a str,
    /// Renders finished so far, those found finished included.
    pub finished: usize,
    /// Of them those that were found finished.
    pub found: usize,
}

/// Hears how far a study is, several times a second, and may break it off.
pub type Listener<'a> = dyn FnMut(&StudyProgress<'_>) -> ControlFlow<()> + 'a;

/// Renders studies in a folder.
pub struct Runner<'a> {
    study: &'a Study,
    folder: &'a Path,
    clock: Option<&'a dyn Clock>,
}

impl std::fmt::Debug for Runner<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Runner")
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

/// First seed of a reference's renders. Seeds of a study's file have 32 bits, so that they never collide.
const REFERENCE_SEED: u64 = 1 << 40;

/// Counts renders and tells.
pub(crate) struct Bar<'a, 'b> {
    listener: &'a mut Listener<'b>,
    what: String,
    items: usize,
    done: usize,
    finished: usize,
    found: usize,
}

impl Bar<'_, '_> {
    /// `inside`: how much of the present item is done.
    pub(crate) fn tell(&mut self, inside: f64) -> ControlFlow<()> {
        let fraction = (self.done as f64 + inside.clamp(0.0, 1.0)) / self.items.max(1) as f64;
        (self.listener)(&StudyProgress {
            fraction: fraction.min(1.0),
            what: &self.what,
            finished: self.finished,
            found: self.found,
        })
    }

    fn check(&mut self, inside: f64) -> Result<(), StudyError> {
        match self.tell(inside) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(StudyError::Stopped),
        }
    }
}

impl<'a> Runner<'a> {
    /// A runner of this study. Finished renders are kept in `folder/cells`.
    #[must_use]
    pub fn new(study: &'a Study, folder: &'a Path) -> Self {
        Self {
            study,
            folder,
            clock: None,
        }
    }

    /// With this clock in place of the one that the study's budgets count in.
    #[must_use]
    pub fn with_clock(self, clock: &'a dyn Clock) -> Self {
        Self {
            clock: Some(clock),
            ..self
        }
    }

    /// Renders what is not yet finished, and measures everything.
    ///
    /// # Errors
    /// A study that is not sound, scenes or files that cannot be read or written, a render that
    /// fails, [`StudyError::Stopped`] if the listener breaks it off.
    pub fn run(&self, listener: &mut Listener<'_>) -> Result<Results, StudyError> {
        let study = self.study;
        study.check()?;
        let own = clock(study.budgets.unit);
        let work = Work {
            study,
            store: Store::open(&self.folder.join("cells"))?,
            clock: self.clock.unwrap_or(own.as_ref()),
        };
        let renders = match study.budgets.unit.is_time() {
            true => 1,
            false => study.budgets.amounts.len(),
        };
        let each = 1 + study.methods.len() * study.seeds.len() * renders;
        let mut bar = Bar {
            listener,
            what: String::new(),
            items: study.scenes.len() * each,
            done: 0,
            finished: 0,
            found: 0,
        };
        let mut scenes = Vec::new();
        for entry in &study.scenes {
            let words = scene_words(entry)?;
            let stage = Stage::new(study, entry);
            let place = StageEntry {
                entry,
                stage: &stage,
                words: &words,
            };
            let reference = work.reference(&place, &mut bar)?;
            for method in &study.methods {
                for &seed in &study.seeds {
                    work.cells(&place, method, seed, &mut bar)?;
                }
            }
            let read = |method: usize, seed: u64, budget: usize, keep| {
                let key = work.key(&place, &study.methods[method], seed, budget)?;
                let name = format!("{}.exr", key.name());
                let lost = || StudyError::page(&name, "was rendered, and cannot be read again");
                work.store.read(&key, keep).ok_or_else(lost)
            };
            scenes.push(evaluate(study, entry, reference, &read)?);
        }
        Ok(Results {
            study: study.clone(),
            scenes,
        })
    }
}

struct Work<'a> {
    study: &'a Study,
    store: Store,
    clock: &'a dyn Clock,
}

struct StageEntry<'a> {
    entry: &'a SceneEntry,
    stage: &'a Stage<'a>,
    words: &'a serde_json::Value,
}

impl Work<'_> {
    fn amount(&self, method: &MethodEntry, budget: usize) -> Amount {
        let amount = self.study.amount(method, budget);
        match self.study.budgets.unit {
            Unit::Wall | Unit::Cpu => Amount::Seconds(amount),
            Unit::PerPixel => Amount::Samples(Budget::PerPixel(amount as u64)),
            Unit::Total => Amount::Samples(Budget::Total(amount as u64)),
        }
    }

    fn render<'b>(&self, method: &'b MethodEntry, seed: u64, budget: usize) -> Render<'b> {
        Render {
            method: method.method,
            settings: &method.settings,
            seed,
            amount: self.amount(method, budget),
            layers: self.study.layers,
            threads: self.study.threads,
        }
    }

    fn key(
        &self,
        place: &StageEntry<'_>,
        method: &MethodEntry,
        seed: u64,
        budget: usize,
    ) -> Result<Key, StudyError> {
        Key::new(self.study, place.words, &self.render(method, seed, budget))
    }

    /// All budgets of one method and seed.
    fn cells(
        &self,
        place: &StageEntry<'_>,
        method: &MethodEntry,
        seed: u64,
        bar: &mut Bar<'_, '_>,
    ) -> Result<(), StudyError> {
        let budgets: Vec<usize> = (0..self.study.budgets.amounts.len()).collect();
        let together = if self.study.budgets.unit.is_time() {
            budgets.len()
        } else {
            1
        };
        for budgets in budgets.chunks(together) {
            bar.what = format!("{}: {}, seed {seed}", place.entry.name, method.name);
            bar.check(0.0)?;
            let mut looks = Vec::new();
            for &budget in budgets {
                let key = self.key(place, method, seed, budget)?;
                let found = self.store.record(&key).is_some();
                looks.push((self.amount(method, budget), key, found));
            }
            let found = looks.iter().filter(|look| look.2).count();
            bar.found += found;
            if found < looks.len() {
                let render = self.render(method, seed, budgets[0]);
                self.look(place, &looks, &render, &mut |inside| bar.tell(inside))?;
            }
            bar.finished += looks.len();
            bar.done += 1;
            bar.check(0.0)?;
        }
        Ok(())
    }

    fn look(
        &self,
        place: &StageEntry<'_>,
        looks: &[(Amount, Key, bool)],
        render: &Render<'_>,
        tell: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), StudyError> {
        Look {
            study: self.study,
            store: &self.store,
            clock: self.clock,
            looks,
        }
        .render(place.stage, render, tell)
    }

    /// One render of a reference, from the store if it is there.
    fn reference_render(
        &self,
        place: &StageEntry<'_>,
        render: &Render<'_>,
        tell: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(Record, Image), StudyError> {
        let key = Key::new(self.study, place.words, render)?;
        if let Some(kept) = self.store.read(&key, Keep::Main) {
            return Ok(kept);
        }
        let looks = [(render.amount, key.clone(), false)];
        self.look(place, &looks, render, tell)?;
        let lost = || StudyError::page("reference", "a render cannot be read again");
        self.store.read(&key, Keep::Main).ok_or_else(lost)
    }

    /// Independent renders until their mean is known well enough; an even number of them, for two halves
    /// of equal cost.
    fn reference(
        &self,
        place: &StageEntry<'_>,
        bar: &mut Bar<'_, '_>,
    ) -> Result<ReferenceResult, StudyError> {
        let entry = self.study.reference_of(place.entry);
        let mut spread = Spread::new(self.study.width, self.study.height);
        let mut seconds = 0.0;
        let most = entry.most / 2 * 2;
        loop {
            let done = f64::from(spread.count()) / f64::from(most);
            let seed = REFERENCE_SEED + u64::from(spread.count());
            bar.what = format!(
                "{}: reference, render {}",
                place.entry.name,
                spread.count() + 1
            );
            bar.check(done)?;
            let render = Render {
                method: entry.method,
                settings: &entry.settings,
                seed,
                amount: Amount::Samples(Budget::PerPixel(entry.per_pixel)),
                layers: false,
                threads: 0,
            };
            let mut tell = |inside: f64| bar.tell(done + inside / f64::from(most));
            let (record, image) = self.reference_render(place, &render, &mut tell)?;
            seconds += record.seconds;
            spread.add(&image);
            if spread.count() % 2 == 1 {
                continue;
            }
            let error = spread.relative_error().unwrap_or(f64::INFINITY);
            let reached = error <= entry.error;
            if reached || spread.count() >= most {
                bar.done += 1;
                return Ok(ReferenceResult {
                    image: spread.mean()?,
                    halves: spread.halves()?,
                    error,
                    wanted: entry.error,
                    renders: spread.count(),
                    seconds,
                });
            }
        }
    }
}
