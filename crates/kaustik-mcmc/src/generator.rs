//! Random-access generators: the numbers of a ladder, or of one sample of it.
//!
//! A ladder owns its generator, so that the bits of a picture do not depend on which
//! thread ran what, and any single sample can be made again from three numbers. Seeds,
//! ladders and steps are small and close together (0, 1, 2, ...), while neighbouring
//! states of a congruential generator are correlated; so the three are first mixed into
//! all 256 bits of the generator's seed.

use rand::SeedableRng;
use rand_pcg::Pcg64Dxsm;

/// The generator of a ladder: of its proposals and its decisions.
///
/// Its values are pinned: the same seed and ladder give the same numbers in every
/// version of this crate on every machine.
pub fn generator(seed: u64, ladder: u64) -> Pcg64Dxsm {
    from_words([LADDER, seed, ladder, 0])
}

/// The generator of one independent sample: sample `step` of a ladder.
///
/// Any sample of a plain Monte Carlo run, or of a pool of seeds, is replayed from these
/// three numbers without the samples before it. It shares nothing with
/// [`generator`] of the same seed and ladder.
pub fn sample_generator(seed: u64, ladder: u64, step: u64) -> Pcg64Dxsm {
    SampleGenerators::new(seed, ladder).at(step)
}

/// The generators of all samples of one ladder: [`sample_generator`] with the work that
/// does not depend on the step done once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SampleGenerators {
    lanes: [u64; 4],
}

impl SampleGenerators {
    /// Of a ladder.
    pub fn new(seed: u64, ladder: u64) -> Self {
        Self {
            lanes: absorb(LANES, [SAMPLE, seed, ladder]),
        }
    }

    /// The generator of a sample.
    #[inline]
    pub fn at(&self, step: u64) -> Pcg64Dxsm {
        finish(absorb(self.lanes, [step]))
    }
}

/// What the words are for: keeps the two families of generators apart.
const LADDER: u64 = 1;
const SAMPLE: u64 = 2;

/// Where the lanes start: digits of the fractional part of pi.
const LANES: [u64; 4] = [
    0x243f_6a88_85a3_08d3,
    0x1319_8a2e_0370_7344,
    0xa409_3822_299f_31d0,
    0x082e_fa98_ec4e_6c89,
];

fn from_words(words: [u64; 4]) -> Pcg64Dxsm {
    finish(absorb(LANES, words))
}

/// Absorbs words into the four lanes, each a chain of bijective mixers.
#[inline]
fn absorb<const N: usize>(mut lanes: [u64; 4], words: [u64; N]) -> [u64; 4] {
    for word in words {
        for (lane, start) in lanes.iter_mut().zip(LANES) {
            *lane = mix(*lane ^ word).wrapping_add(start);
        }
    }
    lanes
}

/// The generator whose seed the lanes are.
#[inline]
fn finish(lanes: [u64; 4]) -> Pcg64Dxsm {
    let mut seed = [0u8; 32];
    for (bytes, lane) in seed.chunks_exact_mut(8).zip(lanes) {
        bytes.copy_from_slice(&mix(lane).to_le_bytes());
    }
    Pcg64Dxsm::from_seed(seed)
}

/// A bijection of 64 bits in which each input bit moves each output bit about half the
/// time: the finaliser of SplitMix64 (Steele et al. 2014, Stafford's variant 13), twice.
#[inline]
fn mix(mut x: u64) -> u64 {
    for _ in 0..2 {
        x ^= x >> 30;
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x ^= x >> 27;
        x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
    }
    x
}

#[cfg(test)]
mod tests {
    use rand::Rng;

    use super::*;

    #[test]
    fn values_are_pinned() {
        let first = [
            generator(0, 0).next_u64(),
            generator(1, 2).next_u64(),
            sample_generator(1, 2, 3).next_u64(),
        ];
        assert_eq!(
            first,
            [
                3_370_828_522_879_524_568,
                15_740_084_856_284_939_591,
                14_843_352_116_127_726_449
            ]
        );
    }

    /// The share of differing bits of two generators' first numbers.
    fn distance(mut a: Pcg64Dxsm, mut b: Pcg64Dxsm) -> f64 {
        let bits: u32 = (0..64)
            .map(|_| (a.next_u64() ^ b.next_u64()).count_ones())
            .sum();
        f64::from(bits) / 4096.0
    }

    #[test]
    fn neighbours_are_independent() {
        // 4096 fair bits: standard deviation 1/128
        for i in 0..64 {
            for j in 1..4 {
                let pairs = [
                    distance(generator(i, 7), generator(i + j, 7)),
                    distance(generator(7, i), generator(7, i + j)),
                    distance(sample_generator(7, 7, i), sample_generator(7, 7, i + j)),
                    distance(generator(i, j), generator(j, i + 64)),
                    distance(generator(i, j), sample_generator(i, j, 0)),
                ];
                assert!(
                    pairs.iter().all(|d| (d - 0.5).abs() < 5.0 / 128.0),
                    "{pairs:?}"
                );
            }
        }
    }

    /// The first uniform number over a run of indices is itself uniform and uncorrelated.
    #[test]
    fn first_numbers_of_successive_samples_are_uniform() {
        const N: u64 = 100_000;
        let (mut bins, mut lag, mut last) = ([0f64; 16], 0.0, 0.0);
        for step in 0..N {
            let x = (sample_generator(5, 0, step).next_u64() >> 11) as f64 / (1u64 << 53) as f64;
            bins[(x * 16.0) as usize] += 1.0;
            lag += (x - 0.5) * last;
            last = x - 0.5;
        }
        let expected = N as f64 / 16.0;
        let chi2: f64 = bins.iter().map(|n| (n - expected).powi(2) / expected).sum();
        assert!(chi2 < 40.0, "chi2 of 15 degrees: {chi2}");
        let z = lag / (N as f64).sqrt() * 12.0;
        assert!(z.abs() < 4.0, "lag correlation: z = {z}");
    }
}
