//! Points of Owen-scrambled Sobol sequences, four dimensions at a time.
//!
//! The numbers are those of `sobol_burley::sample_4d` (Burley 2020) to the last bit. They are made here from
//! the crate's parts because what its samples share is worked out once: the shuffled index belongs to a sample and
//! not to a dimension, and the sequence is linear in the bits of its index, so that four looks into a table
//! of four kilobytes take the place of a loop over sixteen bits.

use std::sync::LazyLock;

use sobol_burley::parts::{
    Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev,
};

/// Sets of four dimensions in the table.
pub(crate) const SETS: usize = 4;
/// The sequence is made for so many samples.
pub(crate) const PERIOD_BITS: u32 = 16;

const NIBBLE: u32 = 4;
const NIBBLES: usize = (PERIOD_BITS / NIBBLE) as usize;
const VALUES: usize = 1 << NIBBLE;

/// For each set, what each value of each four bits of the shuffled index brings to the four dimensions.
type Table = [[[[u32; 4]; VALUES]; NIBBLES]; SETS];

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    std::array::from_fn(|set| {
        std::array::from_fn(|nibble| {
            std::array::from_fn(|value| {
                let bits = (value as u32) << (PERIOD_BITS + NIBBLE * nibble as u32);
                sobol_int4_rev(bits, set as u32).into()
            })
        })
    })
});

/// One point of a sequence.
#[derive(Clone, Copy)]
pub(crate) struct Sobol {
    table: &'static Table,
    /// Index in the sequence, shuffled.
    shuffled: u32,
    /// Tells sequences apart.
    seed: u32,
}

impl Sobol {
    /// Point `index`, below 2^[`PERIOD_BITS`], of the sequence `seed`.
    #[inline]
    pub(crate) fn new(index: u32, seed: u32) -> Self {
        let shuffled = owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
        Self {
            table: &TABLE,
            shuffled: shuffled >> PERIOD_BITS,
            seed: seed.wrapping_mul(0x9c8f_2d3b),
        }
    }

    /// Four of its coordinates in [0, 1), of 23 bits each; `set` is below [`SETS`].
    #[inline]
    pub(crate) fn set(&self, set: usize) -> [f32; 4] {
        let mut point = Int4::from([0; 4]);
        for (nibble, values) in self.table[set].iter().enumerate() {
            let value = self.shuffled >> (NIBBLE as usize * nibble);
            point ^= values[value as usize % VALUES].into();
        }
        let salt = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
        let scramble = Int4::from([self.seed ^ set as u32; 4]) ^ salt.into();
        owen_scramble_int4_rev(point, hash_int4(scramble))
            .reverse_bits()
            .to_f32_norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_the_crates() {
        for seed in [0, 1, 0x1234_5678, u32::MAX] {
            for index in (0..1 << PERIOD_BITS).step_by(97).chain([1, 2, 65_535]) {
                for set in 0..SETS {
                    let expected = sobol_burley::sample_4d(index, set as u32, seed);
                    let found = Sobol::new(index, seed).set(set);
                    assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits));
                }
            }
        }
    }
}
