//! States of stages.

use std::io;

use serde::{Deserialize, Serialize};

use super::past::Past;
use super::sums::Sums;
use super::{StagedEngine, begin, sees};
use crate::state::{Keep, Reader, StateError, Writer};

/// Where a render stands among its stages.
#[derive(Serialize, Deserialize)]
struct Written {
    began: usize,
    stage: usize,
    past: Past,
}

/// The pictures of the stages before and the state of the one at work; its map and pool are made again.
impl Keep for StagedEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        let start = self.start();
        let taken = self.engine.taken().into_iter();
        taken.map(|taken| start + taken).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&Written {
            began: self.began,
            stage: self.stage,
            past: self.past.clone(),
        })?;
        if self.began > 0 {
            self.sums.write(out)?;
        }
        self.besides.write(out)?;
        self.engine.write(out)
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let kept: Written = from.value()?;
        self.check(&kept)?;
        let layout = self.settings.layout();
        let ladders = u64::from(self.settings.options.ladders);
        let sums = match kept.began {
            0 => Sums::black(&layout),
            began => Sums::read(
                &layout,
                self.plan.start(began).saturating_mul(ladders),
                from,
            )?,
        };
        // A picture on the way takes a render back to where it is: its pool need not be filled again.
        if kept.began != self.began || sums != self.sums {
            let (plan, settings) = (&self.plan, &self.settings);
            let engine = begin(self.scene, settings, (plan, kept.began, self.many), &sums);
            self.engine = engine.map_err(|error| StateError::damaged(error.to_string()))?;
            if kept.began > 0 && !sees(self.engine.as_ref()) {
                return Err(StateError::damaged("one of its stages sees no light"));
            }
        }
        (self.began, self.stage, self.past) = (kept.began, kept.stage, kept.past);
        self.sums = sums;
        let passes = self.besides.take_up(from)?;
        self.engine.take_up(from)?;
        self.check_steps()?;
        let steps = self.steps();
        self.besides.check(passes, steps)?;
        self.besides.keep_up(steps);
        Ok(())
    }
}

impl StagedEngine<'_> {
    /// Refuses what no render of this plan can have written.
    fn check(&self, kept: &Written) -> Result<(), StateError> {
        let wrong = || StateError::damaged("its stages are not those of its settings");
        if kept.began > kept.stage || kept.stage > self.plan.most() {
            return Err(wrong());
        }
        let stages = kept.past.stages();
        if stages.len() > kept.began {
            return Err(wrong());
        }
        // So few counts have a sum.
        kept.past.check()?;
        let ladders = u64::from(self.settings.options.ladders);
        let before = self.plan.start(kept.began).saturating_mul(ladders);
        let sum: u64 = stages.iter().map(|stage| stage.mutations).sum();
        if sum != before {
            return Err(wrong());
        }
        Ok(())
    }

    /// Ladders are within their stage.
    fn check_steps(&self) -> Result<(), StateError> {
        let within = self.plan.start(self.stage)..=self.plan.stage(self.stage).end;
        if self.taken().iter().all(|taken| within.contains(taken)) {
            return Ok(());
        }
        Err(StateError::damaged("a ladder is in another stage"))
    }
}
