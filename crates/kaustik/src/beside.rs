//! What samples beside chains have in common, whatever they are made for.

pub(crate) mod lamps;
pub(crate) mod lost;
pub(crate) mod meter;

use std::io;

use kaustik_film::{Counters, Film};
use kaustik_path::RayCounts;

use crate::StepId;
use crate::beside::lamps::Lamps;
use crate::beside::meter::Meter;
use crate::engine::add_nonfinite;
use crate::state::{Reader, StateError, Writer};

/// What takes passes beside chains, so many as follow from their steps.
pub(crate) trait Beside {
    /// What it is called.
    const NAME: &'static str;

    /// Passes beside so many steps.
    fn due(&self, steps: u64) -> u64;

    /// Takes the passes that so many steps are due.
    fn keep_up(&mut self, steps: u64);

    /// Takes up what was written. All shares of a render take the same passes, some more of them than others: those
    /// with the most are kept, what the whole is due beyond them is for [`keep_up`](Self::keep_up). Tells how many
    /// passes it has.
    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError>;
}

/// All that a render has beside its chains.
#[derive(Default)]
pub(crate) struct Besides<'a> {
    /// What is seen directly; `None` where the chains see to it themselves.
    pub(crate) lamps: Option<Lamps<'a>>,
    /// Tells how much light there is; `None` where the method's own samples do.
    pub(crate) meter: Option<Meter<'a>>,
}

impl<'a> Besides<'a> {
    /// Without a meter.
    pub(crate) fn of_lamps(lamps: Option<Lamps<'a>>) -> Self {
        Self { lamps, meter: None }
    }

    /// Takes the passes that so many steps are due: of several shares together they are more than the most of any.
    pub(crate) fn keep_up(&mut self, steps: u64) {
        if let Some(lamps) = &mut self.lamps {
            lamps.keep_up(steps);
        }
        if let Some(meter) = &mut self.meter {
            meter.keep_up(steps);
        }
    }

    /// Writes the passes so far.
    pub(crate) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        if let Some(lamps) = &self.lamps {
            lamps.write(out)?;
        }
        self.meter.as_ref().map_or(Ok(()), |meter| meter.write(out))
    }

    /// Takes up what was beside the chains of a state.
    pub(crate) fn take_up(&mut self, from: &mut Reader<'_>) -> Result<Passes, StateError> {
        let lamps = self.lamps.as_mut().map(|lamps| lamps.take_up(from));
        let lamps = lamps.transpose()?;
        let meter = self.meter.as_mut().map(|meter| meter.take_up(from));
        let meter = meter.transpose()?;
        Ok(Passes { lamps, meter })
    }

    /// Refuses so many passes of a state beside so many steps of its chains, rounds or ladders.
    pub(crate) fn check(&self, passes: Passes, steps: u64) -> Result<(), StateError> {
        check(self.lamps.as_ref(), passes.lamps, steps)?;
        check(self.meter.as_ref(), passes.meter, steps)
    }

    /// Films of the picture, with what turns each into its part.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (&Film, f64)> {
        self.lamps.iter().map(Lamps::part)
    }

    /// Contributions left out because they were not finite, and the first samples where that was so.
    pub(crate) fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let of_lamps = self.lamps.as_ref().map(Lamps::nonfinite);
        let of_meter = self.meter.as_ref().map(Meter::nonfinite);
        add_nonfinite(of_lamps.unwrap_or_default(), of_meter)
    }

    /// The rays of what is part of the picture.
    pub(crate) fn rays(&self) -> RayCounts {
        self.lamps.as_ref().map(Lamps::rays).unwrap_or_default()
    }

    /// What films left out.
    pub(crate) fn film_counters(&self) -> Counters {
        let lamps = self.lamps.as_ref().map(Lamps::film_counters);
        lamps.unwrap_or_default()
    }

    /// Has anything been seen?
    pub(crate) fn is_lit(&self) -> bool {
        self.lamps.as_ref().is_some_and(Lamps::is_lit)
    }
}

/// Passes of a state, of what it has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    lamps: Option<u64>,
    meter: Option<u64>,
}

fn check<B: Beside>(beside: Option<&B>, passes: Option<u64>, steps: u64) -> Result<(), StateError> {
    if passes == beside.map(|some| some.due(steps)) {
        return Ok(());
    }
    Err(StateError::damaged(format!(
        "its {} does not keep up with its steps",
        B::NAME
    )))
}
