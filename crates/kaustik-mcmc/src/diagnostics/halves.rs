use crate::Mean;

/// Mean and variance of a functional over the first and over the second half of a chain,
/// for [`split_r_hat`](crate::split_r_hat), whatever the chain's length will be.
///
/// Keeps up to 64 successive blocks; when they are full, neighbours are merged and blocks
/// become twice as long. So the halves are exact to one block in 32.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Halves {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    blocks: [Mean; BLOCKS],
    /// Blocks begun.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "begun"))]
    begun: usize,
    /// Numbers in a full block.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    length: u64,
}

const BLOCKS: usize = 64;

impl Halves {
    /// Of nothing.
    pub fn new() -> Self {
        Self {
            blocks: [Mean::new(); BLOCKS],
            begun: 0,
            length: 1,
        }
    }

    /// Takes the number of the state after a step. A number that is not finite is left out.
    pub fn push(&mut self, x: f64) {
        if !x.is_finite() {
            return;
        }
        if self.begun == 0 || self.blocks[self.begun - 1].count() == self.length {
            if self.begun == BLOCKS {
                self.halve();
            }
            self.begun += 1;
        }
        self.blocks[self.begun - 1].push(x);
    }

    /// Merges neighbouring blocks.
    fn halve(&mut self) {
        for i in 0..BLOCKS / 2 {
            let mut block = self.blocks[2 * i];
            block.merge(&self.blocks[2 * i + 1]);
            self.blocks[i] = block;
        }
        self.blocks[BLOCKS / 2..].fill(Mean::new());
        self.begun = BLOCKS / 2;
        self.length *= 2;
    }

    /// The first and the second half: of all full blocks, but the middle one if their number
    /// is odd. `None` for fewer than two full blocks.
    pub fn halves(&self) -> Option<[Mean; 2]> {
        let full = self.blocks[..self.begun]
            .iter()
            .take_while(|block| block.count() == self.length)
            .count();
        if full < 2 {
            return None;
        }
        let merged = |blocks: &[Mean]| {
            let mut all = Mean::new();
            blocks.iter().for_each(|block| all.merge(block));
            all
        };
        let half = full / 2;
        Some([
            merged(&self.blocks[..half]),
            merged(&self.blocks[full - half..full]),
        ])
    }
}

#[cfg(feature = "serde")]
fn begun<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let begun = serde::Deserialize::deserialize(deserializer)?;
    crate::serial::check(begun <= BLOCKS, "too many blocks")?;
    Ok(begun)
}

impl Default for Halves {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_halves_of_equal_length_are_nearly_the_whole_series() {
        for n in 2..2000u64 {
            let mut halves = Halves::new();
            (0..n).for_each(|i| halves.push(i as f64));
            let [first, second] = halves.halves().unwrap();
            let k = first.count();
            assert_eq!(k, second.count());
            assert!(2 * k <= n && 2 * k + 2 * halves.length >= n, "{n}: {k}");
            assert!(halves.length == 1 || 32 * halves.length <= n);
            // 0..k, and k numbers that end within a block of n
            assert!((first.mean() - (k - 1) as f64 / 2.0).abs() < 1e-9);
            let end = second.mean() + (k + 1) as f64 / 2.0;
            assert!(end <= n as f64 + 1e-6 && end > (n - halves.length) as f64 - 1e-6);
        }
        let mut short = Halves::new();
        short.push(1.0);
        short.push(f64::INFINITY);
        assert_eq!(short.halves(), None);
    }
}
