//! Do two methods agree? Welch's test over the tiles of their pictures.

/// Mean and variance of the mean of independent runs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Runs {
    /// Number of runs.
    pub(crate) count: f64,
    /// Their mean.
    pub(crate) mean: f64,
    /// Variance of the mean.
    pub(crate) variance: f64,
}

impl Runs {
    /// From the values of at least two runs.
    pub(crate) fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Self {
            count,
            mean,
            variance: squares / (count - 1.0) / count,
        }
    }

    /// Two-sided p-value of Welch's test of equal means. Two sets of runs without any spread
    /// agree if they are equal up to rounding.
    pub(crate) fn p_value(&self, other: &Self) -> f64 {
        let variance = self.variance + other.variance;
        let difference = (self.mean - other.mean).abs();
        let scale = self.mean.abs().max(other.mean.abs());
        if difference <= 1e-6 * scale || scale == 0.0 {
            return 1.0;
        }
        if variance <= 0.0 {
            return 0.0;
        }
        let freedom = variance * variance
            / (self.variance * self.variance / (self.count - 1.0)
                + other.variance * other.variance / (other.count - 1.0));
        two_sided_t(difference / variance.sqrt(), freedom)
    }
}

/// P(|T| >= t) of Student's distribution, by the regularised incomplete beta function.
fn two_sided_t(t: f64, freedom: f64) -> f64 {
    statrs::function::beta::beta_reg(freedom / 2.0, 0.5, freedom / (freedom + t * t))
}

/// What independent pictures say of a tile.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tile {
    /// Red, green, blue.
    pub(crate) channels: [Runs; 3],
    pub(crate) luminance: Runs,
}

impl Tile {
    /// From its means in at least two runs.
    pub(crate) fn of(runs: &[[f64; 3]]) -> Self {
        let channel = |c| runs.iter().map(|rgb| rgb[c]).collect::<Vec<f64>>();
        let luminance = |rgb: &[f64; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        Self {
            channels: [0, 1, 2].map(|c| Runs::of(&channel(c))),
            luminance: Runs::of(&runs.iter().map(luminance).collect::<Vec<f64>>()),
        }
    }
}

/// The verdict on two methods: tiles that differ, tiles whose error is too large to tell.
#[derive(Debug)]
pub(crate) struct Verdict {
    /// Tiles (by index) where Welch's test rejects equality in a channel.
    pub(crate) rejected: Vec<usize>,
    /// Tiles whose pooled standard error exceeds the share of their mean asked for.
    pub(crate) uncertain: Vec<usize>,
    /// The largest relative pooled standard error.
    pub(crate) worst_error: f64,
    /// By how much the second is brighter in each tile that counts, as a share of the first, and the standard error of that.
    pub(crate) differences: Vec<Difference>,
}

impl Verdict {
    /// Tiles that are known to the share, and differ. Of the others Welch's test knows nothing: where one seed in ten meets
    /// what is bright, means are not normal.
    pub(crate) fn known_to_differ(&self) -> Vec<usize> {
        let known = |tile: &usize| !self.uncertain.contains(tile);
        self.rejected.iter().copied().filter(known).collect()
    }
}

/// Between two methods in a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Difference {
    pub(crate) tile: usize,
    pub(crate) share: f64,
    pub(crate) error: f64,
}

/// Welch's test in every channel of every tile that `counts`, Sidak-corrected to 0.01 in all.
/// Errors are those of luminance: channels near zero have no meaningful relative error.
pub(crate) fn agree(a: &[Tile], b: &[Tile], counts: impl Fn(usize) -> bool, share: f64) -> Verdict {
    let tiles: Vec<usize> = (0..a.len()).filter(|&tile| counts(tile)).collect();
    let level = 1.0 - (1.0f64 - 0.01).powf(1.0 / (3 * tiles.len()).max(1) as f64);
    let differs = |tile: &usize| {
        let [a, b] = [&a[*tile], &b[*tile]];
        (0..3).any(|c| a.channels[c].p_value(&b.channels[c]) < level)
    };
    let error = |tile: usize| {
        let [a, b] = [a[tile].luminance, b[tile].luminance];
        let pooled = (a.variance + b.variance).sqrt();
        if a.mean > 0.0 { pooled / a.mean } else { 0.0 }
    };
    let difference = |&tile: &usize| {
        let [a, b] = [a[tile].luminance.mean, b[tile].luminance.mean];
        Difference {
            tile,
            share: if a > 0.0 { b / a - 1.0 } else { 0.0 },
            error: error(tile),
        }
    };
    Verdict {
        rejected: tiles.iter().copied().filter(differs).collect(),
        uncertain: tiles
            .iter()
            .copied()
            .filter(|&tile| error(tile) > share)
            .collect(),
        worst_error: tiles.iter().map(|&tile| error(tile)).fold(0.0, f64::max),
        differences: tiles.iter().map(difference).collect(),
    }
}

#[test]
fn welch_knows_known_values() {
    // t = 2.0, 10 degrees of freedom: p = 0.07339 (tables).
    assert!((two_sided_t(2.0, 10.0) - 0.073_388).abs() < 1e-5);
    let a = Runs::of(&[1.0, 1.1, 0.9, 1.0]);
    let b = Runs::of(&[1.5, 1.6, 1.4, 1.5]);
    assert!(a.p_value(&b) < 1e-3 && a.p_value(&a) > 0.99);
}
