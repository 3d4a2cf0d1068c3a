use kaustik_mcmc::{Independent, generator};
use kaustik_path::{Contributions, PathBuilder};
use kaustik_scene::Scene;

/// Batches of an estimate: enough for a variance.
const BATCHES: u32 = 32;

/// Parts of the image that are looked at: all, the left half, the upper half.
pub(crate) const REGIONS: usize = 3;

/// A mean over independent batches.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    /// Variance of the mean.
    variance: f64,
    count: f64,
}

impl Estimate {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Self {
            mean,
            variance: squares / (count - 1.0) / count,
            count,
        }
    }

    /// Standard error of the mean.
    pub(crate) fn error(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Is the expected value a plausible mean (4.5 standard errors, and rounding)?
    pub(crate) fn holds(&self, expected: f64) -> bool {
        (self.mean - expected).abs() <= 4.5 * self.error() + 1e-4 * expected.abs()
    }

    /// Two-sided p-value of Welch's test of equal means.
    pub(crate) fn p_value(&self, other: &Self) -> f64 {
        let variance = self.variance + other.variance;
        let difference = self.mean - other.mean;
        if difference.abs() <= 1e-5 * self.mean.abs() {
            return 1.0;
        }
        if variance <= 0.0 {
            return 0.0;
        }
        let part = |e: &Self| e.variance * e.variance / (e.count - 1.0);
        let freedom = variance * variance / (part(self) + part(other));
        let x = freedom / (freedom + difference * difference / variance);
        statrs::function::beta::beta_reg(0.5 * freedom, 0.5, x)
    }
}

/// Mean of X + Y + Z over each region of the image, from `samples` points of the cube.
pub(crate) fn image_means(
    scene: &Scene,
    builder: &dyn PathBuilder,
    samples: u32,
    seed: u64,
) -> [Estimate; REGIONS] {
    let mut values = [const { Vec::new() }; REGIONS];
    let per_batch = samples / BATCHES;
    let mut out = Contributions::default();
    for batch in 0..BATCHES {
        let mut u = Independent::new(generator(seed, u64::from(batch)));
        let mut sums = [0.0; REGIONS];
        for _ in 0..per_batch {
            builder.build(scene, &mut u, &mut out);
            assert_eq!(out.nonfinite(), 0);
            for splat in out.splats() {
                let value = f64::from(splat.xyz.sum());
                let within = [true, splat.raster.x < 0.5, splat.raster.y < 0.5];
                for (sum, _) in sums.iter_mut().zip(within).filter(|(_, within)| *within) {
                    *sum += value;
                }
            }
        }
        for (values, sum) in values.iter_mut().zip(sums) {
            values.push(sum / f64::from(per_batch));
        }
    }
    values.map(|values| Estimate::of(&values))
}

#[test]
fn welch_knows_known_values() {
    let a = Estimate::of(&[1.0, 1.1, 0.9, 1.0]);
    let b = Estimate::of(&[1.5, 1.6, 1.4, 1.5]);
    let c = Estimate::of(&[1.05, 1.15, 0.95, 1.05]);
    assert!(a.p_value(&b) < 1e-3 && a.p_value(&a) > 0.99);
    // t = 0.05 / (sqrt(2) * 0.0408) = 0.866 with 6 degrees of freedom
    assert!((a.p_value(&c) - 0.4198).abs() < 1e-3, "{}", a.p_value(&c));
}
