//! A step of a particle, shown once more.

use std::sync::atomic::AtomicU64;

use kaustik_estimate::PathTarget;
use kaustik_mcmc::{
    Draws, Extinct, Metropolis, Population, Resampling, SampleGenerators, generator,
};
use kaustik_path::{Event, note, trace};

use super::{AnnealingEngine, Climbing, Step, target};
use crate::methods::relt::kernels::{kernel, kernels, mutation};
use crate::{RenderError, StepId};

impl<const K: usize> AnnealingEngine<'_, K> {
    /// Takes the round of a place as far as its step, and tells what happens in that: a round follows from
    /// its number alone.
    ///
    /// # Errors
    /// A level that the round did not come to.
    pub(super) fn told_again(
        &mut self,
        StepId { ladder, step }: StepId,
    ) -> Result<Vec<Event>, RenderError> {
        let at = Step::of(step, self.particles, self.cost());
        let Some(told) = self.told.iter_mut().find(|told| told.ladder == ladder) else {
            return Ok(Vec::new());
        };
        told.rounds = at.round;
        let told = told.next();
        let nonfinite = AtomicU64::new(0);
        let target = target(self.scene, self.builder.as_ref(), &nonfinite);
        let draws = SampleGenerators::new(self.seed, told(at.level as usize)).at(at.particle);
        if at.level == 0 {
            return Ok(self.sample_again(target, at, draws));
        }
        match self.population(target, at, told) {
            Ok(population) => Ok(self.step_again(target, at, population, draws)),
            Err(Extinct { level: died }) => Err(RenderError::Setting {
                what: "the step",
                found: format!("{step}, at level {} of round {}", at.level, at.round),
                expected: format!("one below level {died}, which none of its particles reached"),
            }),
        }
    }

    /// What happens in an independent sample.
    fn sample_again(&self, target: PathTarget<'_>, at: Step, mut draws: impl Draws) -> Vec<Event> {
        let first = mutation(&self.set, self.steps, 0);
        let sample = || {
            tell(at);
            Metropolis::start(&target, &self.family, 0, first, &mut draws)
        };
        trace(sample).1
    }

    /// The population of a step's round as it comes to the step's level, from the generators of this number
    /// for each level.
    fn population(
        &self,
        target: PathTarget<'_>,
        at: Step,
        told: impl Fn(usize) -> u64,
    ) -> Result<Climbing<K>, Extinct> {
        let level = at.level as usize;
        let kernels = kernels::<K>(target, &self.set, self.steps);
        let mut central = generator(self.seed, told(K));
        let samples = self.samples(target, told(0), None).unwrap_or_default();
        let mut population =
            Population::from_samples(samples, &self.family, Resampling::Systematic);
        for (below, kernel) in kernels.iter().enumerate().take(level + 1) {
            population.advance(below, kernel, &mut central)?;
            if (1..level).contains(&below) {
                let generators = SampleGenerators::new(self.seed, told(below));
                self.climb((at.round, below, 1.0), &generators, &mut population, None);
            }
        }
        Ok(population)
    }

    /// What happens in a step of a particle of this population, after those that it takes before at the level.
    fn step_again(
        &self,
        target: PathTarget<'_>,
        at: Step,
        mut population: Climbing<K>,
        mut draws: impl Draws,
    ) -> Vec<Event> {
        let level = at.level as usize;
        let mut deposit = self.deposit(level, 1.0, 1);
        let kernel = kernel(target, &self.set, self.steps, level);
        let particle = &mut population.particles_mut()[at.particle as usize];
        for _ in 0..at.step {
            particle.step(&kernel, &self.family, &mut draws, &mut deposit);
        }
        let step = || {
            tell(at);
            let accepted = particle.step(&kernel, &self.family, &mut draws, &mut deposit);
            note(|| Event::Decision { accepted });
        };
        trace(step).1
    }
}

/// Where the step lies.
fn tell(at: Step) {
    let numbers = [
        ("round", at.round),
        ("level", at.level),
        ("particle", at.particle),
        ("step", at.step),
    ];
    for (of, number) in numbers {
        note(|| Event::Index { of, number });
    }
}
