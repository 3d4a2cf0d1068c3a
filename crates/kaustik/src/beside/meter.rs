//! How bright a picture is as a whole, measured apart from the chains that make it.
//!
//! Chains know what is bright beside what, not how bright all of it is: that is an integral over all paths,
//! which independent samples know. Where light runs into a small lamp by way of glass, mirrors or water,
//! those of most methods hardly ever meet it: a share of the picture that one seed misses and another counts
//! ten times over. So what nothing else finds of such light ([`Class::L0`](kaustik_path::Class::L0)) is looked for by
//! scouts, walks from the camera alone, many of them and where it comes from, and all other light is measured by
//! bidirectional samples, which meet it well. Of replicas all but the specific one know their light by samples
//! of the uniform one: there the meter has scouts alone.

mod grid;
mod look;
mod places;
mod samples;

use std::io;
use std::ops::Range;

use kaustik_estimate::{Contribution, Mis, ScalarTarget};
use kaustik_mcmc::{Estimate, Mean};
use kaustik_path::{Event, trace};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::beside::Beside;
use crate::engine::Nonfinite;
use crate::methods::relt::scouts::scouting;
use crate::sampling::streams;
use crate::state::{Reader, StateError, Writer};
use crate::{Builder, Method, Normaliser, RenderSettings, StepId};
use look::Look;
pub(crate) use places::{Hunt, Places};
use samples::{At, Samples, Scratch, WORTH};

/// Samples a pass in each cell that join two walks, for methods that do not know the rest of the light by themselves.
const JOINED_SAMPLES: u64 = 6;
/// Scouts a pass, for each cell in the mean, that look at Dirac surfaces.
const SCOUTS: u64 = 16;
/// Passes that tell how well the meter knows the light, and are no part of what it says of it.
const TRIALS: Range<u64> = (1 << 40)..(1 << 40) + 4;
/// A meter whose estimate would have less than this weight beside the method's own is not run.
const LEAST_WEIGHT: f64 = 0.25;
/// Passes before the first mutation.
const FIRST_PASSES: u64 = 4;
/// The most passes: who merges shares, which have the same ones, has to take no more. In `ring-and-sphere` 15
/// know the light to half a percent, so many to a twentieth.
const MOST_PASSES: u64 = 2048;
/// Passes that are taken at once.
const PASSES_AT_ONCE: u64 = 16;

/// Independent samples that the method already makes (of `relt`: its scouts).
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnSamples {
    /// Variance of one sample, as a pilot saw it. Not used for scouts, whose variance the meter
    /// itself estimates.
    pub(crate) variance: f64,
    /// How many there are for each mutation.
    pub(crate) per_mutation: f64,
}

/// What makes a meter fit a method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    /// Mutations of the chains for each cell of a pass.
    pub(crate) mutations_a_cell: u64,
    /// The method's `b`, or what is measured in its place, over the mean of the scalar contribution of
    /// samples on the window.
    pub(crate) unit: f64,
}

impl Fit {
    /// One pass for each mutation: for who wants to see a pass.
    const ANY: Self = Self {
        mutations_a_cell: 1,
        unit: 1.0,
    };
}

/// Passes over a coarse grid of the image: in each cell bidirectional samples for all light but the implicit
/// specular, and scouts for that, more of them where they are likely to find some.
pub(crate) struct Meter<'a> {
    samples: Samples<'a>,
    /// Samples of a cell that join two walks; none where scouts alone are wanted.
    joined: u64,
    /// Number of the first sample of each cell in a pass, and of the first of the next pass.
    first: Vec<u64>,
    fit: Fit,
    passes: u64,
    /// The method's `b`, by passes.
    light: Mean,
    /// The same of trials.
    trials: Mean,
    /// Variance of a sample of the method's own, by what was known before the first; infinite where it is not known.
    own_variance: f64,
    /// A pass knows the light of scouts as well as so many of a method's own would.
    pass_in_scouts: f64,
    nonfinite: Nonfinite,
}

/// Does the method measure the same light as bidirectional samples?
fn is_wanted(scene: &Scene, settings: &RenderSettings) -> bool {
    let options = &settings.options;
    let points = scene.has_punctual_lights();
    let all_light = match settings.method {
        Method::Pssmlt => options.builder == Builder::Bidirectional || !points,
        Method::Mmlt => true,
        // What scouts of the specific replica look for.
        Method::Relt => scouting(&options.replica_set()).is_some(),
        // It has no paths that run into a lens by chance, which alone show a point by way of Dirac surfaces.
        Method::Mlt => !(points && scene.camera().has_aperture()),
        _ => false,
    };
    // Replicas show all light whatever the weights and contributions of other methods.
    let scaled = match settings.method {
        Method::Relt => true,
        // the paper's weights need no scale
        Method::Mlt => options.contribution == Contribution::Sum,
        _ => options.contribution == Contribution::Sum && options.mis != Mis::Printed,
    };
    // What else there is to see by way of Dirac surfaces alone no scout runs into.
    options.meter
        && scene.has_extended_lights()
        && all_light
        && scaled
        && options.normaliser == Normaliser::Running
}

impl<'a> Meter<'a> {
    /// `None` where the method's own samples measure other light, or the same well enough, or where no
    /// surface that is seen scatters into a Dirac direction. Takes the first passes.
    pub(crate) fn new(
        scene: &'a Scene,
        settings: &RenderSettings,
        own: OwnSamples,
        fit: Fit,
    ) -> Option<Self> {
        let (mut meter, look) = Self::prepared(scene, settings, fit)?;
        if meter.joined > 0
            && let Some(second_moment) = look.second_moment
        {
            meter.own_variance = own.variance + second_moment * fit.unit * fit.unit;
            meter.trials = meter.take(TRIALS).0.into_iter().collect();
        }
        if meter.first_share(own) < LEAST_WEIGHT {
            return None;
        }
        meter.keep_up(0);
        Some(meter)
    }

    /// What share the first pass would have beside the method's own samples of the same time; 0 where variances
    /// say nothing.
    fn first_share(&self, own: OwnSamples) -> f64 {
        let samples = own.per_mutation * self.mutations_a_pass() as f64;
        let share = match self.joined {
            // Scouts alone stand beside others.
            0 => self.pass_in_scouts / (self.pass_in_scouts + samples),
            // All of it where the variance of the method's own is not known: who meets light seldom does not know
            // how much he misses.
            _ => 1.0 - self.weight(samples, 1),
        };
        if share.is_nan() { 0.0 } else { share }
    }

    /// Before any pass.
    fn prepared(scene: &'a Scene, settings: &RenderSettings, fit: Fit) -> Option<(Self, Look)> {
        if !is_wanted(scene, settings) {
            return None;
        }
        let (target, joined) = match settings.method {
            Method::Relt => (ScalarTarget::Xyz, 0),
            _ => (settings.options.target, JOINED_SAMPLES),
        };
        let samples = |stream| Samples::new(scene, settings, target, stream);
        let look = Look::new(&samples(streams::METER_LOOK))?;
        let samples = samples(streams::METER);
        let scouts = look.often(&samples, SCOUTS, JOINED_SAMPLES);
        let meter = Self {
            first: first(joined, &scouts),
            samples,
            joined,
            fit,
            passes: 0,
            light: Mean::new(),
            trials: Mean::new(),
            own_variance: f64::INFINITY,
            pass_in_scouts: WORTH * look.equivalent_walks(&scouts),
            nonfinite: Nonfinite::default(),
        };
        Some((meter, look))
    }

    fn mutations_a_pass(&self) -> u64 {
        self.fit.mutations_a_cell * self.samples.grid.count() as u64
    }

    fn samples_a_pass(&self) -> u64 {
        self.first[self.samples.grid.count()]
    }

    /// The light by each of these passes.
    fn take(&self, passes: Range<u64>) -> (Vec<f64>, Nonfinite) {
        let cells = self.samples.grid.count();
        let count = (passes.end - passes.start) as usize * cells;
        let cell = |scratch: &mut Scratch, at: usize| {
            let (pass, cell) = (passes.start + (at / cells) as u64, at % cells);
            self.cell(pass, cell, scratch)
        };
        let all: Vec<(f64, Nonfinite)> = (0..count)
            .into_par_iter()
            .with_min_len(16)
            .map_init(Scratch::default, cell)
            .collect();
        let mean = |pass: &[(f64, Nonfinite)]| {
            let sum: f64 = pass.iter().map(|(light, _)| light).sum();
            self.fit.unit * sum / cells as f64
        };
        let faults = all.iter().map(|(_, faults)| *faults);
        (
            all.chunks(cells).map(mean).collect(),
            faults.fold(Nonfinite::default(), Nonfinite::and),
        )
    }

    /// What a pass finds in a cell.
    fn cell(&self, pass: u64, cell: usize, scratch: &mut Scratch) -> (f64, Nonfinite) {
        let mut faults = Nonfinite::default();
        let first = pass * self.samples_a_pass();
        let mut light = 0.0;
        for number in self.first[cell]..self.first[cell + 1] {
            let step = first + number;
            light += self.sample(step, scratch);
            faults.count(u64::from(scratch.nonfinite), step);
        }
        (light, faults)
    }

    /// What the sample of this number says of the light of its cell: the sum over a pass's is the cell's.
    fn sample(&self, step: u64, scratch: &mut Scratch) -> f64 {
        let (at, joins) = self.at(step);
        if joins {
            self.samples.join(at, scratch) / self.joined as f64
        } else {
            self.samples.scout(at, scratch).light / self.scouts(at.cell)
        }
    }

    /// Where the sample of this number is made, and whether it joins two walks.
    fn at(&self, step: u64) -> (At, bool) {
        let (pass, number) = (step / self.samples_a_pass(), step % self.samples_a_pass());
        let cell = self.first.partition_point(|first| *first <= number) - 1;
        let number = number - self.first[cell];
        let joins = number < self.joined;
        let at = At {
            step,
            pass,
            cell,
            index: if joins { number } else { number - self.joined },
        };
        (at, joins)
    }

    /// How many scouts go out in a cell in a pass.
    fn scouts(&self, cell: usize) -> f64 {
        (self.first[cell + 1] - self.first[cell] - self.joined) as f64
    }

    /// Tells what happens in the sample of this number; `None` where there is nothing to measure.
    pub(crate) fn replay(
        scene: &'a Scene,
        settings: &RenderSettings,
        step: u64,
    ) -> Option<Vec<Event>> {
        let (meter, _) = Self::prepared(scene, settings, Fit::ANY)?;
        Some(trace(|| meter.sample(step, &mut Scratch::default())).1)
    }

    /// Do samples of the method's own count for nothing beside it?
    pub(crate) fn is_alone(&self) -> bool {
        self.own_variance.is_infinite()
    }

    /// Of the mean of so many samples of the method's own beside so many passes: by variances known before
    /// any of them, so that it does not depend on what they find.
    fn weight(&self, own: f64, passes: u64) -> f64 {
        let (own, passes) = (
            own / self.own_variance,
            passes as f64 / self.trials.variance(),
        );
        if own > 0.0 { own / (own + passes) } else { 0.0 }
    }

    /// Its share in the method's `b`, beside so many samples of its own.
    pub(crate) fn share(&self, own: &Mean) -> f64 {
        match own.count() {
            0 | 1 => 1.0,
            count => 1.0 - self.weight(count as f64, self.passes),
        }
    }

    /// The method's `b`, from passes and its own samples beside the chains.
    pub(crate) fn with(&self, own: &Mean) -> Estimate {
        let here = Estimate {
            value: self.light.mean(),
            standard_error: (self.variance() / self.passes as f64).sqrt(),
        };
        let weight = 1.0 - self.share(own);
        if weight <= 0.0 {
            return here;
        }
        Estimate {
            value: weight * own.mean() + (1.0 - weight) * here.value,
            standard_error: (weight * own.standard_error())
                .hypot((1.0 - weight) * here.standard_error),
        }
    }

    /// The light as the mean of so many scouts of a method's own as would know it as well.
    pub(crate) fn in_scouts(&self) -> Mean {
        let count = (self.pass_in_scouts * self.passes as f64).round() as u64;
        Mean::of(count, self.with(&Mean::new()))
    }

    /// Of a pass, as trials know it as well.
    fn variance(&self) -> f64 {
        let mut all = self.trials;
        all.merge(&self.light);
        all.variance()
    }

    /// Writes the passes so far.
    pub(crate) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.passes, self.light, self.nonfinite))
    }

    /// Contributions left out because they were not finite, and the first samples where that was so.
    pub(crate) fn nonfinite(&self) -> (u64, Vec<StepId>) {
        Nonfinite::all(std::iter::once((StepId::METER, self.nonfinite)))
    }
}

impl Beside for Meter<'_> {
    const NAME: &'static str = "meter of light";

    fn due(&self, mutations: u64) -> u64 {
        (FIRST_PASSES + mutations / self.mutations_a_pass()).min(MOST_PASSES)
    }

    fn keep_up(&mut self, mutations: u64) {
        let due = self.due(mutations);
        while self.passes < due {
            let end = (self.passes + PASSES_AT_ONCE).min(due);
            let (light, nonfinite) = self.take(self.passes..end);
            // One by one: the same bits however many are taken at once.
            light.into_iter().for_each(|light| self.light.push(light));
            self.nonfinite = self.nonfinite.and(nonfinite);
            self.passes = end;
        }
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError> {
        let (passes, light, nonfinite): (u64, Mean, Nonfinite) = from.value()?;
        let (passes, nonfinite) = (Reader::count(passes)?, nonfinite.checked()?);
        let spread = passes < 2 || light.variance().is_finite();
        let sound = light.mean().is_finite() && light.mean() >= 0.0 && spread;
        if light.count() != passes || !sound {
            return Err(StateError::damaged("its meter does not agree with itself"));
        }
        if from.is_first() || passes > self.passes {
            (self.passes, self.light, self.nonfinite) = (passes, light, nonfinite);
        }
        Ok(passes)
    }
}

/// Numbers of the first sample of each cell: its scouts, and so many more.
fn first(more: u64, scouts: &[u64]) -> Vec<u64> {
    let mut next = 0;
    let cells = scouts.iter().map(|scouts| {
        next += more + scouts;
        next
    });
    std::iter::once(0).chain(cells).collect()
}
