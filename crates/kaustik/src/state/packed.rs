//! Sums of films in as few bytes as they need.
//!
//! Sums have 64 bits and use some 40 of them; most of a film of lamps is zero. Of each block of sums stands first how many bytes
//! each takes, then the low bytes of all. It costs less time than it saves, in what need not be hashed, copied and synced.

/// Sums that share a width.
const BLOCK: usize = 64;
/// Bytes of a sum that is not packed.
const WHOLE: usize = 8;

/// Packs sums behind what is in `bytes`; at most [`BLOCK`] of them.
fn pack_block(sums: &[i64], bytes: &mut Vec<u8>) {
    // all bits that any of them has, and one for the sign
    let bits = sums.iter().fold(0_i64, |bits, sum| {
        let sign = sum >> 63;
        bits | ((sum ^ sign) << 1) | (sign & 1)
    });
    let width = WHOLE - bits.leading_zeros() as usize / 8;
    bytes.push(width as u8);
    for sum in sums {
        bytes.extend_from_slice(&sum.to_le_bytes()[..width]);
    }
}

/// Packs sums and hands on pieces of bytes.
pub(crate) fn pack<E>(
    sums: impl Iterator<Item = i64>,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), E> {
    const PIECE: usize = 1 << 16;
    let mut bytes = Vec::with_capacity(PIECE + BLOCK * WHOLE + 1);
    let (mut block, mut held) = ([0; BLOCK], 0);
    for sum in sums {
        block[held] = sum;
        held += 1;
        if held == BLOCK {
            pack_block(&block, &mut bytes);
            held = 0;
        }
        if bytes.len() >= PIECE {
            take(&bytes)?;
            bytes.clear();
        }
    }
    if held > 0 {
        pack_block(&block[..held], &mut bytes);
    }
    take(&bytes)
}

/// So many packed sums, the first of these bytes.
pub(crate) struct Packed<'a> {
    rest: &'a [u8],
    left: usize,
    /// Sums that are left of the block, and the width of each.
    block: usize,
    width: usize,
}

impl<'a> Packed<'a> {
    /// Splits them off `bytes`; `None` if these are not so many sums.
    pub(crate) fn split(bytes: &'a [u8], count: usize) -> Option<(Self, &'a [u8])> {
        let (mut rest, mut left) = (bytes, count);
        while left > 0 {
            let (&width, sums) = rest.split_first()?;
            let (width, block) = (usize::from(width), left.min(BLOCK));
            rest = sums.get(block * width..).filter(|_| width <= WHOLE)?;
            left -= block;
        }
        let packed = Self {
            rest: &bytes[..bytes.len() - rest.len()],
            left: count,
            block: 0,
            width: 0,
        };
        Some((packed, rest))
    }

    /// The fewest bytes that so many sums take.
    pub(super) fn least(count: usize) -> usize {
        count.div_ceil(BLOCK)
    }
}

impl Iterator for Packed<'_> {
    type Item = i64;

    fn next(&mut self) -> Option<i64> {
        if self.left == 0 {
            return None;
        }
        if self.block == 0 {
            let (&width, rest) = self.rest.split_first()?;
            (self.width, self.rest) = (usize::from(width), rest);
            self.block = self.left.min(BLOCK);
        }
        let (low, rest) = self.rest.split_at_checked(self.width)?;
        self.rest = rest;
        self.left -= 1;
        self.block -= 1;
        let mut sum = [0; WHOLE];
        sum[..self.width].copy_from_slice(low);
        let shift = 8 * (WHOLE - self.width) as u32;
        // the highest byte has the sign
        let sum = i64::from_le_bytes(sum);
        Some(sum.checked_shl(shift).map_or(0, |high| high >> shift))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Packed<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(sums: &[i64]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let done: Result<(), ()> = pack(sums.iter().copied(), |piece| {
            bytes.extend_from_slice(piece);
            Ok(())
        });
        done.expect("memory");
        bytes
    }

    /// Every width, both signs, whole and broken blocks, more than a piece.
    #[test]
    fn sums_come_back() {
        let edges = (0..63).flat_map(|bit| {
            let high = 1_i64 << bit;
            [high - 1, high, -high, -high - 1]
        });
        let edges: Vec<i64> = edges.chain([0, -1, i64::MAX, i64::MIN]).collect();
        for &edge in &edges {
            let bytes = packed(&[edge]);
            let (back, rest) = Packed::split(&bytes, 1).expect("one sum");
            assert!(back.eq([edge]) && rest.is_empty(), "{edge:x} {bytes:x?}");
            // no byte more than its bits need
            let bits = 65 - (edge ^ (edge >> 63)).leading_zeros() as usize;
            let least = if edge == 0 { 0 } else { bits.div_ceil(8) };
            assert!(bytes.len() <= 1 + least, "{edge:x} {bytes:x?}");
        }
        for count in [0, 1, 63, 64, 65, 1_000, 30_000] {
            let sums: Vec<i64> = (0..count)
                .map(|i| edges[i * 7 % edges.len()] >> (i / 64 % 60))
                .collect();
            let mut bytes = packed(&sums);
            bytes.extend([9; 5]);
            let (back, rest) = Packed::split(&bytes, count).expect("all sums");
            assert_eq!((back.len(), rest), (count, &[9; 5][..]));
            assert!(back.eq(sums), "{count}");
        }
        assert_eq!(packed(&[0; 6_400]).len(), Packed::least(6_400));
    }

    #[test]
    fn what_is_no_packed_sums_is_refused() {
        let bytes = packed(&[3, 1 << 40, -7]);
        assert!(Packed::split(&bytes, 3).is_some());
        assert!(Packed::split(&bytes[..bytes.len() - 1], 3).is_none());
        assert!(Packed::split(&bytes, 4).is_none() && Packed::split(&[], 1).is_none());
        let mut wide = bytes;
        wide[0] = 9;
        wide.extend([0; 64]);
        assert!(Packed::split(&wide, 3).is_none());
    }
}
