//! Independent samples that share the cube among them.

use kaustik_pss::{Coordinates, Stream};
use rand_pcg::Pcg64Dxsm;

use crate::sobol::{DIMENSIONS, Sobol};
use crate::{Draws, SampleGenerators};

/// Which coordinates are stratified, and how: a randomised Sobol sequence for a pool.
///
/// A [`Pool`](crate::Pool) of independent samples estimates the normaliser with an error of
/// 1/sqrt(N). If the first few coordinates, those that matter most, come from a
/// low-discrepancy sequence instead, the samples spread evenly and the error falls faster:
/// for what is smooth in them, as fast as N^(-3/2) (Owen 1997). The sequence is scrambled
/// as Owen does (see [`Stratification::at`]), so that *each sample by itself* is uniform on
/// the cube; hence whatever is unbiased with independent samples stays so, the choice of a
/// start and its normaliser included. Only the [standard
/// error](crate::Mean::standard_error) of a pool, which takes the samples for independent,
/// is too large.
///
/// Use it for pools and plain Monte Carlo. A chain's own large steps must be independent of
/// its past: they stay random.
///
/// ```
/// use kaustik_mcmc::{Exponential, Metropolis, Pool, Stratification, generator, target, Target};
/// use kaustik_pss::{Coordinates, Stream};
///
/// let target = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0) * u.get(Stream::Light, 2));
/// let family = |x: &f64| [*x];
/// let plan = Stratification::new(7, 0)
///     .with(Stream::Camera, 0)
///     .with(Stream::Light, 2);
/// let mut value = 0.0;
/// let pool = Pool::new((0..4096).map(|i| {
///     target.evaluate(&mut plan.at(i), &mut value);
///     value
/// }));
/// assert!((pool.normaliser().mean() - 0.25).abs() < 1e-4);
/// // such a sample is rebuilt from its own coordinates
/// let mut rng = generator(7, 0);
/// let start = pool.choose(&mut rng).expect("not dark");
/// let mutation = Exponential::default();
/// let chain =
///     Metropolis::rebuild_from(&target, &family, 0, mutation, &start, &mut plan.at(start.index))?;
/// # let _: Metropolis<_, _, 1> = chain;
/// # Ok::<(), kaustik_mcmc::StartError>(())
/// ```
#[doc(alias = "randomised quasi-Monte Carlo")]
#[doc(alias = "RQMC")]
#[doc(alias = "Sobol")]
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Written"))]
pub struct Stratification {
    sobol: Sobol,
    generators: SampleGenerators,
    /// The dimension of each coordinate; `NONE` for none.
    dimensions: [Vec<u8>; Stream::COUNT],
    used: usize,
}

const NONE: u8 = u8::MAX;

impl Stratification {
    /// How many coordinates can be stratified.
    pub const DIMENSIONS: usize = DIMENSIONS;

    /// Of the samples of a ladder: no coordinate yet. (seed, ladder) decide the scrambling
    /// and all numbers that are not stratified.
    pub fn new(seed: u64, ladder: u64) -> Self {
        let generators = SampleGenerators::new(seed, ladder);
        Self {
            sobol: Sobol::new(generators.at(u64::MAX)),
            generators,
            dimensions: std::array::from_fn(|_| Vec::new()),
            used: 0,
        }
    }

    /// Stratifies one more coordinate. The most important ones should come first: the
    /// sequence's first dimensions are its best. Nothing happens if it is stratified
    /// already, or all [`DIMENSIONS`](Self::DIMENSIONS) are taken.
    #[must_use]
    pub fn with(mut self, stream: Stream, index: u32) -> Self {
        let (stored, index) = (&mut self.dimensions[stream as usize], index as usize);
        if index >= stored.len() {
            stored.resize(index + 1, NONE);
        }
        if stored[index] == NONE && self.used < DIMENSIONS {
            stored[index] = self.used as u8;
            self.used += 1;
        }
        self
    }

    /// Sample `step`, below 2^64 - 1: stratified with all others whose steps have the same
    /// upper 32 bits.
    ///
    /// Any 2^k successive steps from a multiple of 2^k on have, in each stratified
    /// coordinate, exactly one number in each of 2^k equal intervals. The scrambling is
    /// nested and uniform (Owen 1995), by a hash of the digits above (Laine and Karras 2011,
    /// Burley 2020), over all 53 digits: averaged over seeds each number is uniform.
    pub fn at(&self, step: u64) -> Stratified<'_, Pcg64Dxsm> {
        Stratified {
            plan: self,
            step,
            draws: self.generators.at(step),
        }
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Written {
    sobol: Sobol,
    generators: SampleGenerators,
    dimensions: [Vec<u8>; Stream::COUNT],
    used: usize,
}

#[cfg(feature = "serde")]
impl TryFrom<Written> for Stratification {
    type Error = &'static str;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        let Written {
            sobol,
            generators,
            dimensions,
            used,
        } = written;
        let exists = |&dimension: &u8| dimension == NONE || usize::from(dimension) < used;
        if used > DIMENSIONS || !dimensions.iter().flatten().all(exists) {
            return Err("a dimension that does not exist");
        }
        Ok(Self {
            sobol,
            generators,
            dimensions,
            used,
        })
    }
}

/// One sample of a [`Stratification`]: coordinates to evaluate a target at.
///
/// As with [`Independent`](crate::Independent), each address may be asked for once.
#[derive(Clone, Debug)]
pub struct Stratified<'a, D> {
    plan: &'a Stratification,
    step: u64,
    draws: D,
}

impl<D: Draws> Coordinates for Stratified<'_, D> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let stored = &self.plan.dimensions[stream as usize];
        match stored.get(index as usize) {
            Some(&dimension) if dimension != NONE => {
                self.plan.sobol.number(self.step, usize::from(dimension))
            }
            _ => self.draws.uniform(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mean, generator};

    fn plan(seed: u64) -> Stratification {
        Stratification::new(seed, 3)
            .with(Stream::Camera, 0)
            .with(Stream::Camera, 5)
            .with(Stream::Camera, 0) // a second time
    }

    /// Only what was asked for is stratified; the rest is as independent samples are.
    #[test]
    fn other_coordinates_are_random_and_all_are_replayed() {
        let plan = plan(1);
        let addresses = [
            (Stream::Camera, 0),
            (Stream::Camera, 5),
            (Stream::Camera, 4),
            (Stream::Light, 0),
            (Stream::Light, 900),
        ];
        let mut cells = [[0u32; 256]; 5];
        for step in 0..256 {
            let (mut u, mut again) = (plan.at(step), plan.at(step));
            for (count, (stream, index)) in cells.iter_mut().zip(addresses) {
                let x = u.get(stream, index);
                assert_eq!(x.to_bits(), again.get(stream, index).to_bits());
                count[(x * 256.0) as usize] += 1;
            }
        }
        let even = cells.map(|count| count.iter().all(|n| *n == 1));
        assert_eq!(even, [true, true, false, false, false]);
    }

    #[test]
    fn naming_a_coordinate_twice_takes_no_dimension() {
        let all = (0..40).fold(plan(2), |plan, _| plan.with(Stream::Camera, 5));
        let all = (0..20).fold(all, |plan, index| plan.with(Stream::Light, index));
        let even = |index| {
            let mut cells = [0u32; 64];
            for step in 0..64 {
                cells[(all.at(step).get(Stream::Light, index) * 64.0) as usize] += 1;
            }
            cells.iter().all(|n| *n == 1)
        };
        let stratified = (0..20).filter(|index| even(*index)).count();
        assert_eq!(stratified, Stratification::DIMENSIONS - 2);
    }

    /// The mean of a smooth function of two coordinates over a pool of 256, over seeds:
    /// right, and with a hundred times less variance than of independent samples.
    #[test]
    fn means_are_unbiased_and_far_less_noisy() {
        let f = |x: f64, y: f64| (3.0 * x).exp() * (1.0 + y * y);
        let exact = (3f64.exp() - 1.0) / 3.0 * (4.0 / 3.0);
        let (mut means, mut independent) = (Mean::new(), Mean::new());
        let mut rng = generator(9, 0);
        for seed in 0..400 {
            let plan = plan(seed);
            let (mut sum, mut plain) = (0.0, 0.0);
            for step in 0..256 {
                let mut u = plan.at(step);
                sum += f(u.get(Stream::Camera, 0), u.get(Stream::Camera, 5)) / 256.0;
                plain += f(rng.uniform(), rng.uniform()) / 256.0;
            }
            means.push(sum);
            independent.push(plain);
        }
        let z = (means.mean() - exact) / means.standard_error();
        assert!(z.abs() < 3.5, "{z}");
        let gain = independent.variance() / means.variance();
        assert!(gain > 100.0, "{gain}");
    }
}
