//! The normalising constant of one chain from a bridge to independent samples.

/// Sums for Bennett's acceptance ratio (J. Comput. Phys. 22, 1976) between the uniform law and a chain's.
///
/// With x the density over a rough constant b0, and for any bounded function of it,
///
/// ```text
/// b / b0 = E over independent samples of [ x / (1 + x) ] / E over the chain of [ 1 / (1 + x) ]
/// ```
///
/// The plain mean of x has the noise of the few samples that met by chance what is ten thousand times brighter
/// than the rest. Here each counts at most 1, and how much of the light such paths bring is what the
/// chain tells, which knows them well once it has found them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bridge {
    up: f64,
    squares: f64,
    down: f64,
}

impl Bridge {
    /// So many (0 or 1) independent samples had this density over b0.
    #[inline]
    pub fn sample(&mut self, count: f64, x: f64) {
        let share = x / (1.0 + x);
        self.up += count * share;
        self.squares += count * share * share;
    }

    /// The chain spent so many steps where the density over b0 is x.
    #[inline]
    pub fn visit(&mut self, weight: f64, x: f64) {
        self.down += weight / (1.0 + x);
    }

    /// Adds that of another chain.
    pub fn merge(&mut self, other: &Self) {
        self.up += other.up;
        self.squares += other.squares;
        self.down += other.down;
    }

    /// `b / b0`, from so many independent samples (those of density zero included) and so many steps;
    /// `None` while one of both has seen nothing.
    pub fn ratio(&self, samples: u64, steps: f64) -> Option<f64> {
        let known = self.up > 0.0 && self.down > 0.0;
        known.then(|| (self.up / samples as f64) / (self.down / steps))
    }

    /// Relative standard error that the independent samples bring, if so many of all were taken here.
    pub fn relative_error(&self, samples: u64) -> f64 {
        let n = samples as f64;
        let mean = self.up / n;
        let variance = (self.squares / n - mean * mean).max(0.0);
        (variance / n).sqrt() / mean
    }
}

#[cfg(test)]
mod tests {
    use kaustik_mcmc::{Draws, generator};

    use super::*;

    /// Density 6 x^2 on [0, 1], of integral 2, thought to be 1/2.
    #[test]
    fn it_finds_the_constant() {
        let mut rng = generator(34, 0);
        let mut bridge = Bridge::default();
        assert_eq!(bridge.ratio(10, 10.0), None);
        let density = |u: f64| 6.0 * u * u;
        for _ in 0..100_000 {
            bridge.sample(1.0, density(rng.uniform()) / 0.5);
            bridge.visit(1.0, density(libm::cbrt(rng.uniform())) / 0.5);
        }
        let ratio = bridge.ratio(100_000, 100_000.0).unwrap_or_default();
        assert!((ratio / 4.0 - 1.0).abs() < 0.01, "{ratio}");
        // x / (1 + x) is spread over most of [0, 1]
        let error = bridge.relative_error(100_000) * 100_000_f64.sqrt();
        assert!((0.2..0.6).contains(&error), "{error}");
    }
}
