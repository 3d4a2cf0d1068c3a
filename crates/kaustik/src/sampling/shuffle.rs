//! An order without a pattern.

use crate::sampling::stratified::mix;

/// Rounds of the network: with four it is hard to tell from chance.
const ROUNDS: usize = 4;

/// A permutation of `0..count`, of which any place is known without those before it.
///
/// A Feistel network permutes the numbers of an even number of bits; it is applied until it lands among the
/// first `count` of them, at most four times in the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shuffle {
    count: u64,
    /// Bits of half a number.
    half: u32,
    keys: [u64; ROUNDS],
}

impl Shuffle {
    /// Of so many, `count` > 0.
    pub(crate) fn new(count: u64, seed: u64) -> Self {
        let bits = u64::BITS - (count - 1).leading_zeros();
        Self {
            count,
            half: bits.div_ceil(2).max(1),
            keys: std::array::from_fn(|round| mix(seed.wrapping_add(round as u64))),
        }
    }

    /// What stands at a place, both below `count`.
    pub(crate) fn at(&self, place: u64) -> u64 {
        debug_assert!(place < self.count);
        let mut number = place;
        loop {
            number = self.network(number);
            if number < self.count {
                return number;
            }
        }
    }

    fn network(&self, number: u64) -> u64 {
        let mask = (1 << self.half) - 1;
        let halves = (number >> self.half, number & mask);
        let (left, right) = self.keys.iter().fold(halves, |(left, right), key| {
            (right, left ^ (mix(right ^ key) & mask))
        });
        left << self.half | right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_one_place() {
        for count in [1, 2, 3, 4, 5, 63, 64, 65, 1000, 4096, 4097] {
            for seed in [0, 1, u64::MAX] {
                let shuffle = Shuffle::new(count, seed);
                let mut all: Vec<u64> = (0..count).map(|place| shuffle.at(place)).collect();
                all.sort_unstable();
                assert!(all.into_iter().eq(0..count), "{count} by {seed}");
            }
        }
    }

    /// What follows on what is as good as chance: of 1,000 numbers, as many steps are long as by chance.
    #[test]
    fn neighbours_are_strangers() {
        let shuffle = Shuffle::new(1_000, 3);
        let step = |place| shuffle.at(place).abs_diff(shuffle.at(place + 1));
        let mean = (0..999).map(step).sum::<u64>() as f64 / 999.0;
        // A third of the range; the mean of so many steps is known to some 8.
        assert!((mean - 333.0).abs() < 30.0, "{mean}");
    }
}
