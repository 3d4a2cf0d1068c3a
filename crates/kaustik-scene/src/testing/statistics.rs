//! What only the tests of this crate share: a generator, Pearson's test, some wavelengths.

use kaustik_spectrum::{WavelengthSampling, Wavelengths};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// SplitMix64: small, seeded, good enough to test samplers with.
#[derive(Debug)]
pub(crate) struct Rng(u64);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn pair(&mut self) -> [f64; 2] {
        [self.uniform(), self.uniform()]
    }
}

/// The p-value of Pearson's test. Cells that expect fewer than five are pooled; a hit in a cell
/// that expects nothing gives 0.
pub(crate) fn chi_square(observed: &[f64], expected: &[f64]) -> f64 {
    let mut statistic = 0.0;
    let mut cells = 0_i32;
    let mut pool = [0.0, 0.0];
    let mut add = |o: f64, e: f64| {
        statistic += (o - e) * (o - e) / e;
        cells += 1;
    };
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 1e-9 && o > 0.0 {
            return 0.0;
        }
        if e >= 5.0 {
            add(o, e);
        } else {
            pool = [pool[0] + o, pool[1] + e];
            if pool[1] >= 5.0 {
                add(pool[0], pool[1]);
                pool = [0.0, 0.0];
            }
        }
    }
    // What is left expects less than five: too much of it is a fault, too little is none.
    let [left, expected] = pool;
    if left > expected {
        add(left, expected.max(1.0));
    }
    let freedom = f64::from(cells - 1);
    ChiSquared::new(freedom).map_or(0.0, |law| law.sf(statistic))
}

/// Level of one of `tests` tests that together reject the truth once in a hundred times (Sidak).
pub(crate) fn level(tests: i32) -> f64 {
    1.0 - 0.99_f64.powf(1.0 / f64::from(tests))
}

/// Mean of samples, and the standard error of it.
pub(crate) fn mean(samples: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for sample in samples {
        count += 1.0;
        sum += sample;
        squares += sample * sample;
    }
    let mean = sum / count;
    let variance: f64 = (squares / count - mean * mean).max(0.0);
    (mean, (variance / count).sqrt())
}

/// Some four wavelengths.
pub(crate) fn wavelengths() -> Wavelengths {
    Wavelengths::sample(0.37, WavelengthSampling::Hero)
}
