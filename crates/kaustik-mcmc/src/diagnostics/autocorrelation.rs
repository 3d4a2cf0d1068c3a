use crate::Mean;

/// The integrated autocorrelation time of a functional, and the effective sample size.
///
/// Push the functional once a step. The numbers are averaged in batches of 1, 2, 4, ... (the
/// blocking of Flyvbjerg and Petersen 1989), which takes a fixed few kilobytes and about two
/// additions a step. If batches of length B are much longer than the chain remembers, their
/// means are independent, and
///
/// tau = B Var(mean of a batch) / Var(number) = 1 + 2 (sum of all autocorrelations)
///
/// is how many steps are worth one independent sample. B is the shortest batch with B^3 > 2
/// n tau^2, which balances what is left of the memory against the noise of few batches (Lee,
/// Conduit, Nemec, Lopez Rios and Drummond 2011; Wolff 2004). If none is, the chain is too
/// short to tell, and there is no answer.
///
/// Consistent, not unbiased: tau comes out a little small (by about tau / B).
#[doc(alias = "integrated autocorrelation time")]
#[doc(alias = "effective sample size")]
#[doc(alias = "ESS")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Autocorrelation {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    levels: [Level; LEVELS],
}

/// Batches of up to 2^39 numbers.
const LEVELS: usize = 40;

/// Batches of one length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Level {
    means: Mean,
    /// A batch that waits for its other half.
    half: Option<f64>,
}

impl Autocorrelation {
    /// Of nothing.
    pub fn new() -> Self {
        Self {
            levels: [Level::default(); LEVELS],
        }
    }

    /// Takes the number of the state after a step. A number that is not finite is left out.
    pub fn push(&mut self, x: f64) {
        if !x.is_finite() {
            return;
        }
        let mut mean = x;
        for level in &mut self.levels {
            level.means.push(mean);
            match level.half.take() {
                Some(other) => mean = 0.5 * (other + mean),
                None => {
                    level.half = Some(mean);
                    return;
                }
            }
        }
    }

    /// Adds another chain's batches. What the chains' own means differ by then counts as
    /// memory of the longest batches.
    pub fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.levels.iter_mut().zip(&other.levels) {
            mine.means.merge(&theirs.means);
        }
    }

    /// The mean of all numbers. Its standard error is *not* that of independent numbers, see
    /// [`standard_error`](Self::standard_error).
    pub fn numbers(&self) -> &Mean {
        &self.levels[0].means
    }

    /// The integrated autocorrelation time in steps: 1 for independent numbers, below 1 for
    /// alternating ones. `None` if the chains are too short to tell, or nothing varies.
    pub fn time(&self) -> Option<f64> {
        let n = self.numbers().count() as f64;
        let variance = self.numbers().variance();
        if !(variance > 0.0 && variance.is_finite()) {
            return None;
        }
        let levels = self.levels.iter().enumerate();
        let enough = levels.take_while(|(_, level)| level.means.count() >= FEWEST);
        enough
            .map(|(k, level)| {
                let length = (1u64 << k) as f64;
                (length, length * level.means.variance() / variance)
            })
            .find(|(length, tau)| length * length * length > 2.0 * n * tau * tau)
            .map(|(_, tau)| tau)
            // Batches that are all alike, as of numbers that alternate, tell of no error at all.
            .filter(|tau| *tau > 0.0)
    }

    /// How many independent samples the numbers are worth: their count over
    /// [`time`](Self::time).
    pub fn effective_samples(&self) -> Option<f64> {
        self.time().map(|tau| self.numbers().count() as f64 / tau)
    }

    /// The standard error of the mean, memory included.
    pub fn standard_error(&self) -> Option<f64> {
        let samples = self.effective_samples()?;
        Some((self.numbers().variance() / samples).sqrt())
    }
}

/// Fewer batches have no variance to speak of.
const FEWEST: u64 = 16;

impl Default for Autocorrelation {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Draws, generator};

    #[test]
    fn numbers_that_alternate_tell_of_no_error() {
        let mut numbers = Autocorrelation::new();
        (0..10_000).for_each(|i| numbers.push(f64::from(i % 2)));
        assert_eq!((numbers.time(), numbers.standard_error()), (None, None));
    }

    /// x' = phi x + uniform noise: autocorrelations phi^k.
    fn autoregressive(phi: f64, steps: usize, ladder: u64) -> Autocorrelation {
        let mut rng = generator(71, ladder);
        let (mut x, mut result) = (0.0, Autocorrelation::new());
        for step in 0..steps + 1000 {
            x = phi * x + rng.uniform() - 0.5;
            if step >= 1000 {
                result.push(x);
            }
        }
        result
    }

    #[test]
    fn the_time_of_an_autoregressive_chain_is_known() {
        for phi in [-0.5f64, 0.0, 0.5, 0.9, 0.99] {
            let exact = (1.0 + phi) / (1.0 - phi);
            let found = autoregressive(phi, 1 << 20, 0);
            let tau = found.time().unwrap();
            assert!((tau / exact - 1.0).abs() < 0.1, "{phi}: {tau} for {exact}");
            let samples = found.effective_samples().unwrap();
            assert!((samples * tau / f64::from(1 << 20) - 1.0).abs() < 1e-12);
        }
    }

    /// The stated error of the mean is the spread of the means of many chains.
    #[test]
    fn the_standard_error_is_the_spread_of_chains() {
        let (mut means, mut errors) = (Mean::new(), Mean::new());
        for ladder in 0..400 {
            let chain = autoregressive(0.8, 1 << 12, ladder);
            means.push(chain.numbers().mean());
            errors.push(chain.standard_error().unwrap());
        }
        let ratio = errors.mean() / means.variance().sqrt();
        assert!((ratio - 1.0).abs() < 0.12, "{ratio}"); // 3.5 % is the spread's own error
    }

    #[test]
    fn merged_chains_have_the_time_of_each() {
        let mut all = Autocorrelation::new();
        (1..9).for_each(|ladder| all.merge(&autoregressive(0.9, 1 << 16, ladder)));
        assert_eq!(all.numbers().count(), 8 << 16);
        let tau = all.time().unwrap();
        assert!((tau / 19.0 - 1.0).abs() < 0.1, "{tau}");
    }

    #[test]
    fn too_short_or_constant_chains_have_no_time() {
        assert_eq!(autoregressive(0.999, 1000, 0).time(), None);
        let mut constant = Autocorrelation::new();
        (0..1000).for_each(|_| constant.push(0.25));
        assert_eq!(constant.time(), None);
        constant.push(f64::NAN);
        assert_eq!(constant.numbers().count(), 1000);
        assert_eq!(Autocorrelation::new().effective_samples(), None);
    }
}
