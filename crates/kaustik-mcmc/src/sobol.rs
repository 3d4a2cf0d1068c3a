//! Sobol's sequence, scrambled as Owen does.
//!
//! The sequence (Sobol 1967) in base 2: digit vectors v of a dimension follow from a
//! primitive polynomial over two elements and its first numbers m by Bratley and Fox's
//! recurrence (1988). Polynomials and numbers are those of Joe and Kuo (2008, the set
//! new-joe-kuo-6.21201), whose two-dimensional projections are good.
//!
//! A number is the exclusive or of the vectors of the index's digits. Nested uniform
//! scrambling (Owen 1995) then flips each digit by a random bit that depends on all digits
//! above it. Read backwards, that is a function in which each bit depends on lower ones
//! alone, and sums, products with odd numbers and exclusive or with even multiples are such
//! (Laine and Karras 2011): a hash of a few of them is the scrambling.

use crate::Draws;

/// How many dimensions there are.
pub(crate) const DIMENSIONS: usize = 16;

/// Digits of the index that count.
const DIGITS: usize = 32;

/// Per dimension from the second on: the inner coefficients of the polynomial, and m. The
/// degree is the length of m.
const JOE_KUO: [(u32, &[u32]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
];

type Vectors = [[u32; DIGITS]; DIMENSIONS];

static VECTORS: Vectors = vectors();

/// Digit vectors of all dimensions, the first digit in the highest bit.
const fn vectors() -> Vectors {
    let mut all = [[0; DIGITS]; DIMENSIONS];
    let mut i = 0;
    while i < DIGITS {
        all[0][i] = 1 << (DIGITS - 1 - i); // van der Corput's
        i += 1;
    }
    let mut dimension = 1;
    while dimension < DIMENSIONS {
        let (inner, first) = JOE_KUO[dimension - 1];
        let degree = first.len();
        let mut v = [0; DIGITS];
        let mut i = 0;
        while i < DIGITS {
            v[i] = if i < degree {
                first[i] << (DIGITS - 1 - i)
            } else {
                let mut next = v[i - degree] ^ (v[i - degree] >> degree);
                let mut k = 1;
                while k < degree {
                    if (inner >> (degree - 1 - k)) & 1 == 1 {
                        next ^= v[i - k];
                    }
                    k += 1;
                }
                next
            };
            i += 1;
        }
        all[dimension] = v;
        dimension += 1;
    }
    all
}

/// A point's digits in one dimension, before scrambling: 32 binary digits, first the highest.
fn plain(index: u32, dimension: usize) -> u32 {
    let vectors = &VECTORS[dimension];
    let (mut rest, mut x) = (index, 0);
    while rest != 0 {
        x ^= vectors[rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    x
}

/// A scrambled sequence.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sobol {
    /// One scrambling a dimension.
    keys: [u64; DIMENSIONS],
}

impl Sobol {
    /// With random scramblings.
    pub(crate) fn new(mut draws: impl Draws) -> Self {
        // 53 random bits each; the hash below brings them to all of its own
        let mut key = || (draws.uniform() * (1u64 << 53) as f64) as u64;
        Self {
            keys: std::array::from_fn(|_| key() ^ (key() << 32)),
        }
    }

    /// The number of a point in a dimension, in [0, 1), with 53 digits.
    ///
    /// The lower 32 bits of `index` are the place in the sequence, the upper ones choose
    /// another, independent scrambling.
    pub(crate) fn number(&self, index: u64, dimension: usize) -> f64 {
        let mut key = self.keys[dimension];
        let block = index >> 32;
        if block != 0 {
            key = mix(key ^ mix(block));
        }
        let digits = u64::from(plain(index as u32, dimension)) << 32;
        let scrambled = scramble(digits.reverse_bits(), key).reverse_bits();
        (scrambled >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// A bijection in which each bit depends on itself and lower ones alone, whichever the key;
/// averaged over keys its value is uniform, whatever `x` is.
fn scramble(mut x: u64, key: u64) -> u64 {
    let (first, second) = (mix(key), mix(key ^ 0x6a09_e667_f3bc_c908));
    x ^= x.wrapping_mul(0x9e6c_63d0_876a_68de);
    x = x.wrapping_add(first);
    x = x.wrapping_mul((first >> 32) | 1);
    x ^= x.wrapping_mul(0xd6e8_feb8_6659_fd92);
    x = x.wrapping_mul((second >> 32) | 1);
    x ^= x.wrapping_mul(0xa076_1d64_78bd_642e);
    x.wrapping_add(second)
}

/// A bijection of 64 bits that leaves no pattern (the finaliser of SplitMix64).
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mean, generator};

    fn sobol(seed: u64) -> Sobol {
        Sobol::new(generator(seed, 5))
    }

    /// How many of `n` points from `from` on share an interval of length 1/n with another.
    fn crowded(n: u64, from: u64, number: impl Fn(u64) -> f64) -> usize {
        let mut cells = vec![0u32; n as usize];
        (from..from + n).for_each(|i| cells[(number(i) * n as f64) as usize] += 1);
        cells.iter().filter(|n| **n != 1).count()
    }

    #[test]
    fn each_dimension_has_one_number_in_each_interval() {
        for dimension in 0..DIMENSIONS {
            for bits in 0..13 {
                let n = 1 << bits;
                let numbers = sobol(bits);
                for from in [0, n, 5 * n, 1 << 33] {
                    let crowd = crowded(n, from, |i| numbers.number(i, dimension));
                    assert_eq!(crowd, 0, "dimension {dimension}, {n} from {from}");
                }
            }
        }
        // what a wrong sequence and plain random numbers would do
        let numbers = sobol(0);
        assert!(crowded(256, 7, |i| numbers.number(i, 5)) > 0, "not aligned");
        let shifted = |i| (numbers.number(i, 0) + numbers.number(i, 1)).fract();
        assert!(crowded(256, 0, shifted) > 0);
    }

    /// The first two dimensions are a net: one point in each rectangle of area 1/n.
    #[test]
    fn the_first_two_dimensions_are_a_net() {
        let numbers = sobol(11);
        for bits in 0..11u32 {
            let n = 1u64 << bits;
            for columns in (0..=bits).map(|b| 1u64 << b) {
                let rows = n / columns;
                let cell = |i: u64| {
                    let (x, y) = (numbers.number(i, 0), numbers.number(i, 1));
                    let column = (x * columns as f64).floor();
                    (column * rows as f64 + (y * rows as f64).floor() + 0.5) / n as f64
                };
                assert_eq!(crowded(n, 0, cell), 0, "{columns} x {rows}");
            }
        }
    }

    /// Polynomials are primitive (their shift register runs through all its states), m odd
    /// and small enough, dimensions differ.
    #[test]
    fn tables_are_sound() {
        for (dimension, (inner, first)) in JOE_KUO.iter().enumerate() {
            let degree = first.len() as u32;
            let polynomial = (1 << degree) | (inner << 1) | 1;
            let (mut state, mut period) = (1u32, 0);
            loop {
                state <<= 1;
                if state >> degree == 1 {
                    state ^= polynomial;
                }
                period += 1;
                if state == 1 || period > 1 << degree {
                    break;
                }
            }
            assert_eq!(period, (1 << degree) - 1, "dimension {dimension}");
            for (i, m) in first.iter().enumerate() {
                assert!(m % 2 == 1 && *m < 2 << i, "dimension {dimension}: {m}");
            }
        }
        let distinct: std::collections::BTreeSet<_> = VECTORS.iter().collect();
        assert_eq!(distinct.len(), DIMENSIONS);
        // the third dimension by hand: m = 1, 3 and 2 * 3 ^ 4 * 1 ^ 1 = 3, over 2, 4 and 8
        let eighths = |i| plain(i, 2) >> 29;
        assert_eq!([1, 2, 3, 4].map(eighths), [4, 6, 2, 3]);
    }

    /// Nested: numbers that share k digits share k after scrambling, and differ in the next.
    /// Uniform: digits below are independent, over seeds.
    #[test]
    fn scrambling_is_nested_and_uniform() {
        let mut digit = [[Mean::new(); 16]; 3];
        let mut product = [[Mean::new(); 15]; 2];
        for seed in 0..4000 {
            let key = mix(seed);
            // 0.000.., 0.100.., 0.0001..: digits from the top, as bits from the bottom
            let all = [0, 1, 8].map(|x| scramble(x, key));
            let [a, b, c] = all;
            assert!((a ^ b) & 1 == 1 && (a ^ c) & 15 == 8);
            for (means, x) in digit.iter_mut().zip(all) {
                for (k, mean) in means.iter_mut().enumerate() {
                    mean.push(f64::from((x >> k) as u32 & 1));
                }
            }
            for (means, x) in product.iter_mut().zip([b, c]) {
                for (k, mean) in means.iter_mut().enumerate() {
                    mean.push(f64::from(((a ^ x) >> (k + 1)) as u32 & 1));
                }
            }
        }
        let fair = |mean: &Mean| (mean.mean() - 0.5).abs() < 5.0 * 0.5 / 4000f64.sqrt();
        assert!(digit.as_flattened().iter().all(fair));
        assert!(
            product[0].iter().all(fair),
            "digits below the first difference: {product:?}"
        );
        assert!(product[1][3..].iter().all(fair), "{product:?}");
        // the planted fault: a digital shift alone keeps all digits in step
        let shift = |x: u64, key: u64| x ^ mix(key);
        assert!((0..100).all(|key| (shift(0, key) ^ shift(1, key)) == 1));
    }

    #[test]
    fn values_are_pinned() {
        let numbers = sobol(1);
        let found = [(0, 0), (1, 0), (1, 15), (1 << 40, 3)].map(|(i, d)| numbers.number(i, d));
        assert_eq!(
            found.map(f64::to_bits),
            [
                4_606_189_241_449_689_921,
                4_599_695_981_091_246_360,
                4_594_703_034_665_975_016,
                4_602_986_430_740_235_015,
            ]
        );
    }
}
