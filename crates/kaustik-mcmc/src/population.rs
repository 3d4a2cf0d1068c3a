//! A population of chains that climbs a family level by level.

use std::fmt;

use crate::resample::descend;
use crate::{
    Draws, Estimate, Family, Kernel, Metropolis, Mutation, Point, Recorder, Resampling, Target,
    Visit,
};

/// N particles that climb from level to level by weighting and resampling: population
/// annealing (Hukushima and Iba 2003; a sequential Monte Carlo sampler, Del Moral, Doucet and
/// Jasra 2006; RELT sec. 4.3, Algorithm 2).
///
/// A population is a value, and annealing is done in stages, so that the dear part, moving
/// particles, can be spread over threads by whoever has them:
///
/// 1. [`from_samples`](Self::from_samples): independent samples of the base law, usually
///    the uniform law on the cube, evaluated by the caller wherever;
/// 2. [`advance`](Self::advance) to the next level: weigh, resample, and bring every particle
///    under the level's kernel (central, cheap: no evaluation);
/// 3. move each particle a few steps: [`step`](Self::step), or the caller's own loop over
///    [`particles_mut`](Self::particles_mut). A particle is a [`Metropolis`] chain that shares
///    nothing with the others. Give each *slot* a generator of its own
///    ([`sample_generator`](crate::sample_generator) of its index, say), and the bits do
///    not depend on which thread moved what in which order;
/// 4. [`choose`](Self::choose) a particle, or [`visit`](Self::visit) all; again from 2.
///
/// [`anneal`](crate::anneal) does all this on one generator.
///
/// # What is exact
///
/// With Z_k the [normaliser](Stage::normaliser) of stage k, for every N, every number of
/// moves that leave q_k invariant, and both [`Resampling`]s:
///
/// * E\[Z_k\] = b_k, the integral of q_k under the base law;
/// * E\[Z_k h(particle)\] = integral of q_k h, for a particle chosen uniformly; so Z_k / N times
///   a sum over [visits](Self::visit) is unbiased too;
///
/// if the supports are nested on the way (q_k is zero wherever the level before is). Extinct
/// runs take part with Z = 0. The particles *alone* follow p_k only approximately.
///
/// Ratios of Z_k, and whatever is divided by Z_k, are consistent but biased.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serial::Written<S, V, K>",
        bound(deserialize = "S: serde::Deserialize<'de>, V: serde::Deserialize<'de> + Default")
    )
)]
#[doc(alias = "sequential Monte Carlo")]
#[doc(alias = "SMC")]
pub struct Population<S, V, const K: usize> {
    particles: Vec<Metropolis<S, V, K>>,
    /// Which initial particle each descends from.
    founders: Vec<u32>,
    resampling: Resampling,
    /// `None`: still the base law.
    level: Option<usize>,
    extinct: Option<Extinct>,
    normaliser: f64,
    /// Product of N / (N - 1) over independent choices of all N members.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::known"))]
    correction: f64,
    defects: u64,
    #[cfg_attr(feature = "serde", serde(skip))]
    memory: Memory,
}

/// Buffers.
#[derive(Clone, Debug, Default)]
struct Memory {
    weights: Vec<f64>,
    copies: Vec<u32>,
    sums: Vec<f64>,
    /// Weight of the descendants of each founder.
    shares: Vec<f64>,
}

/// What it took to come to a level.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stage {
    /// The level.
    pub level: usize,
    /// The mean weight, an estimate of the normaliser of this level over that of the one before.
    pub ratio: f64,
    /// The product of mean weights up to here: an unbiased estimate of the normaliser, with
    /// its standard error.
    ///
    /// The error comes from genealogy (Chan and Lai 2013; Lee and Whiteley 2018, eq. 5):
    /// weights of particles that descend from different initial ones are as good as
    /// independent, those of one family are not. When all descend from one, the error is of
    /// the size of the estimate, and nothing is known. See
    /// [`relative_variance`](Self::relative_variance).
    pub normaliser: Estimate,
    /// The estimated variance of the normaliser over its square: the error before a root is
    /// drawn from it, and so sometimes below 0. Infinite for fewer than two particles.
    ///
    /// With multinomial resampling, this times Z^2 is an unbiased estimate of the variance of
    /// Z, for every N. With systematic resampling no such theorem is known; the same formula is
    /// used without the terms for the noise that multinomial choices would add, and was found
    /// within 7 % (itself the noise of 150 runs) of the spread of repeated runs, at four levels
    /// of a rare event with 1, 4 and 16 moves.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::known"))]
    pub relative_variance: f64,
    /// Effective number of particles, (sum of weights)^2 / sum of squared weights, in [1, N]:
    /// before resampling. Much below N says that levels are too far apart.
    pub effective: f64,
    /// How many of the initial particles have descendants.
    pub founders: usize,
    /// Whether anything was resampled. Equal weights are left as they are, which is exact and
    /// adds no noise. (Not a reason to leave out moves: whether particles are moved must not
    /// depend on where they are.)
    pub resampled: bool,
}

/// A population that has died: no particle has a density at some level.
///
/// That is a result (the estimate of that normaliser is 0), not a mistake: the level may be
/// empty, or the population too small to find it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extinct {
    /// The first level that nobody reached.
    pub level: usize,
}

impl fmt::Display for Extinct {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no particle has reached level {}", self.level)
    }
}

impl std::error::Error for Extinct {}

impl<S, V: Default, const K: usize> Population<S, V, K> {
    /// A population of independent samples of the base law: states with their values.
    ///
    /// Densities of the family are relative to that law. Samples whose densities are
    /// defective count as samples of density zero.
    pub fn from_samples(
        samples: impl IntoIterator<Item = (S, V)>,
        family: &(impl Family<V, K> + ?Sized),
        resampling: Resampling,
    ) -> Self {
        let chain = |(state, value)| Metropolis::at(state, value, family, 0);
        Self::of(samples.into_iter().map(chain).collect(), family, resampling)
    }

    fn of(
        particles: Vec<Metropolis<S, V, K>>,
        family: &(impl Family<V, K> + ?Sized),
        resampling: Resampling,
    ) -> Self {
        const { assert!(K > 0, "a family has a level") };
        let sound =
            |p: &&Metropolis<S, V, K>| crate::checked_densities(family, p.value()).is_some();
        let count = particles.len();
        Self {
            founders: (0..count as u32).collect(),
            resampling,
            level: None,
            extinct: None,
            normaliser: 1.0,
            correction: count as f64 / (count as f64 - 1.0),
            defects: (count - particles.iter().filter(sound).count()) as u64,
            memory: Memory::default(),
            particles,
        }
    }
}

impl<M: Mutation + Clone, V: Default, const K: usize> Population<Point<M>, V, K> {
    /// A population on the unit cube, evaluated here, one sample after the other.
    pub fn start<T, F, D>(
        count: usize,
        target: &T,
        family: &F,
        mutation: &M,
        resampling: Resampling,
        draws: &mut D,
    ) -> Self
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        let start = |_| Metropolis::start(target, family, 0, mutation.clone(), draws);
        Self::of((0..count).map(start).collect(), family, resampling)
    }
}

impl<S, V, const K: usize> Population<S, V, K> {
    /// Brings the population to another level: weighs each particle by the quotient of its
    /// densities there and here, resamples, and hands every particle to the level's `kernel`
    /// ([`Kernel::enter`]: what lazy points owe to their old step sizes is paid).
    ///
    /// Levels may be left out or branch off (on a clone), as long as supports stay nested.
    /// What particles have gathered since their last flush is forgotten.
    ///
    /// # Errors
    ///
    /// If no particle has a positive weight. The population then stays where it is, and
    /// every later attempt reports the same.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    pub fn advance<N, D>(
        &mut self,
        level: usize,
        kernel: &N,
        draws: &mut D,
    ) -> Result<Stage, Extinct>
    where
        N: Kernel<S, Value = V>,
        S: Clone,
        V: Clone,
        D: Draws + ?Sized,
    {
        assert!(level < K, "level {level} of a family of {K}");
        if let Some(extinct) = self.extinct {
            return Err(extinct);
        }
        let Some(largest) = self.weigh(level) else {
            self.normaliser = 0.0;
            return Err(*self.extinct.insert(Extinct { level }));
        };
        // weights are relative to the largest, so that no sum overflows
        let weights = &self.memory.weights;
        let count = weights.len() as f64;
        let (sum, squares) = weights
            .iter()
            .fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
        let ratio = largest * (sum / count);
        self.normaliser *= ratio;
        let relative_variance = self.relative_variance(sum);
        let normaliser = Estimate {
            value: self.normaliser,
            standard_error: self.normaliser * relative_variance.max(0.0).sqrt(),
        };
        let resampled = self.memory.weights.iter().any(|w| *w < 1.0);
        if resampled {
            self.resample(draws);
        }
        for particle in &mut self.particles {
            particle.enter(level, kernel, draws);
        }
        self.level = Some(level);
        Ok(Stage {
            level,
            ratio,
            normaliser,
            relative_variance,
            effective: sum * sum / squares,
            founders: self.living_founders(),
            resampled,
        })
    }

    /// Weighs all particles, relative to the largest weight, which is returned; `None` if all
    /// weights are zero.
    fn weigh(&mut self, level: usize) -> Option<f64> {
        let here = self.level;
        let weight = |particle: &Metropolis<S, V, K>| {
            let base = here.map_or(1.0, |here| particle.densities[here]);
            let weight = particle.densities[level] / base;
            // a particle of density zero is dead, one too close to it cannot be weighed
            if weight.is_finite() { weight } else { 0.0 }
        };
        let weights = &mut self.memory.weights;
        weights.clear();
        weights.extend(self.particles.iter().map(weight));
        let largest = weights.iter().copied().fold(0.0, f64::max);
        for weight in weights.iter_mut() {
            *weight /= largest;
        }
        (largest > 0.0).then_some(largest)
    }

    /// The relative variance of the normaliser, of weights with the given sum.
    ///
    /// With W_e the share of family e in the weights it is 1 - correction * (1 - sum of W_e^2). For the first
    /// stage this is the sample variance of the weights over N. (Lee and Whiteley's eq. 5, taken before the
    /// last resampling.)
    fn relative_variance(&mut self, sum: f64) -> f64 {
        let Memory {
            weights, shares, ..
        } = &mut self.memory;
        if weights.len() < 2 {
            return f64::INFINITY;
        }
        shares.clear();
        shares.resize(weights.len(), 0.0);
        for (weight, &founder) in weights.iter().zip(&self.founders) {
            shares[founder as usize] += weight / sum;
        }
        let same: f64 = shares.iter().map(|share| share * share).sum();
        1.0 - self.correction * (1.0 - same)
    }

    /// Overwrites those who get no copy with those who get several.
    fn resample<D: Draws + ?Sized>(&mut self, draws: &mut D)
    where
        S: Clone,
        V: Clone,
    {
        let count = self.particles.len();
        let Memory {
            weights,
            copies,
            sums,
            ..
        } = &mut self.memory;
        self.resampling.copies(weights, copies, sums, draws);
        if self.resampling == Resampling::Multinomial {
            self.correction *= count as f64 / (count as f64 - 1.0);
        }
        let mut parent = 0;
        for dead in 0..count {
            if copies[dead] > 0 {
                continue;
            }
            while copies[parent] < 2 {
                parent += 1;
            }
            copies[parent] -= 1;
            if let Ok([dead, parent]) = self.particles.get_disjoint_mut([dead, parent]) {
                dead.copy_from(parent);
            }
            self.founders[dead] = self.founders[parent];
        }
    }

    fn living_founders(&mut self) -> usize {
        let shares = &mut self.memory.shares;
        shares.clear();
        shares.resize(self.founders.len(), 0.0);
        for &founder in &self.founders {
            shares[founder as usize] = 1.0;
        }
        shares.iter().filter(|share| **share > 0.0).count()
    }

    /// One step of every particle, in order, by one generator.
    ///
    /// Expected-value visits go to the recorder with their level; the same scale as of
    /// [`visit`](Self::visit), over the number of steps, makes them unbiased. Before the first level they are
    /// a sample of the base law, which no step may change: nothing happens.
    pub fn step<N, F, D, R>(&mut self, kernel: &N, family: &F, draws: &mut D, recorder: &mut R)
    where
        N: Kernel<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        if self.level.is_none() {
            return;
        }
        for particle in &mut self.particles {
            particle.step(kernel, family, draws, recorder);
        }
    }

    /// Reports what the particles have gathered in their steps.
    pub fn flush<R: Recorder<V, K> + ?Sized>(&mut self, recorder: &mut R) {
        for particle in &mut self.particles {
            particle.flush(recorder);
        }
    }

    /// Shows every particle to the recorder, with weight 1, at the population's level.
    ///
    /// Z_k / N times the sum of weight * h(value) estimates the integral of q_k h without
    /// bias. Before the first level there is nothing to show.
    pub fn visit<R: Recorder<V, K> + ?Sized>(&self, recorder: &mut R) {
        let Some(level) = self.level else { return };
        for particle in self.particles.iter().filter(|p| p.density() > 0.0) {
            recorder.record(Visit {
                level,
                value: &particle.value,
                densities: &particle.densities,
                weight: 1.0,
                independent: 0.0,
            });
        }
    }

    /// One particle, each with the same probability: where a replica of this level starts.
    /// `None` for a population of nobody.
    pub fn choose<D: Draws + ?Sized>(&self, draws: &mut D) -> Option<&Metropolis<S, V, K>> {
        if self.particles.is_empty() {
            return None;
        }
        let index = descend(self.particles.len(), |i| i as f64, draws);
        self.particles.get(index)
    }

    /// The particles: chains at the population's level.
    pub fn particles(&self) -> &[Metropolis<S, V, K>] {
        &self.particles
    }

    /// The particles, to be moved: by [`Metropolis::step`] under the level's kernel only,
    /// which leaves its density invariant. Before the first level they must not be moved at all.
    pub fn particles_mut(&mut self) -> &mut [Metropolis<S, V, K>] {
        &mut self.particles
    }

    /// The level, or `None` while this is still a sample of the base law.
    pub fn level(&self) -> Option<usize> {
        self.level
    }

    /// The product of mean weights so far: 1 for a sample of the base law, 0 once extinct.
    pub fn normaliser(&self) -> f64 {
        self.normaliser
    }

    /// How many samples had no valid densities at the start. (Later defects are in the
    /// particles' own statistics.)
    pub fn defects(&self) -> u64 {
        self.defects
    }
}

#[cfg(feature = "serde")]
mod serial;
#[cfg(test)]
mod tests;
