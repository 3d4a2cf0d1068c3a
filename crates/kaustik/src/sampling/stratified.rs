//! Coordinates of a pixel's samples that keep out of each other's way.
//!
//! The first coordinates of a path come from an Owen-scrambled Sobol sequence over the pixel's
//! samples (Burley 2020, see [`Sobol`]), the rest from a generator. Each sample is
//! uniform by itself, so that means are unbiased as ever; together they cover the pixel, the
//! wavelengths, the emitters and the first directions evenly, and the picture has less noise. Pixels
//! scramble differently, so that what is left over does not show as a pattern.

use kaustik_path::layout;
use kaustik_pss::{Coordinates, Stream};

use crate::sampling::sobol::{PERIOD_BITS, SETS, Sobol};

/// Vertices whose directions and emitter points are stratified.
const VERTICES: usize = 3;
// One set of four dimensions for raster and wavelength, one a vertex.
const _: () = assert!(SETS == 1 + VERTICES);

/// Coordinates of one sample of one cell of the raster.
pub(crate) struct Stratified<C> {
    inner: C,
    /// Lower corner of the cell in cells, and the size of a cell as a share of the window.
    corner: [f64; 2],
    size: [f64; 2],
    point: Sobol,
    sets: [Option<[f32; 4]>; SETS],
}

impl<C: Coordinates> Stratified<C> {
    /// Sample `index` of a cell; `seed` tells cells apart. `inner` gives what is not stratified.
    pub(crate) fn new(inner: C, corner: [f64; 2], size: [f64; 2], index: u64, seed: u64) -> Self {
        // Past the period the sequence begins anew, scrambled otherwise.
        let seed = mix(seed ^ mix(index >> PERIOD_BITS));
        let index = (index & ((1 << PERIOD_BITS) - 1)) as u32;
        Self {
            inner,
            corner,
            size,
            point: Sobol::new(index, (seed >> 32) as u32),
            sets: [None; SETS],
        }
    }

    #[inline]
    fn set(&mut self, set: usize) -> [f32; 4] {
        let point = &self.point;
        *self.sets[set].get_or_insert_with(|| point.set(set))
    }

    /// A stratified coordinate as the path is to see it. It has 23 bits: about what a ray in single precision
    /// resolves.
    #[inline]
    fn placed(&self, dimension: usize, u: f32) -> f64 {
        match dimension {
            0 | 1 => (self.corner[dimension] + f64::from(u)) * self.size[dimension],
            _ => f64::from(u),
        }
    }
}

impl<C: Coordinates> Coordinates for Stratified<C> {
    #[inline]
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let Some(dimension) = dimension(stream, index) else {
            return self.inner.get(stream, index);
        };
        let u = self.set(dimension / 4)[dimension % 4];
        self.placed(dimension, u)
    }

    #[inline]
    fn get2(&mut self, stream: Stream, index: u32) -> [f64; 2] {
        match dimension(stream, index) {
            // What is asked for in pairs lies side by side in one set.
            Some(first) if dimension(stream, index + 1) == Some(first + 1) && first % 4 < 3 => {
                let set = self.set(first / 4);
                let (a, b) = (set[first % 4], set[(first + 1) % 4]);
                [self.placed(first, a), self.placed(first + 1, b)]
            }
            _ => [self.get(stream, index), self.get(stream, index + 1)],
        }
    }
}

/// Number of a coordinate that is stratified: four times its set and its lane.
#[inline]
fn dimension(stream: Stream, index: u32) -> Option<usize> {
    let row = DIMENSIONS.get(index as usize)?;
    let dimension = row[stream as usize];
    (dimension != NONE).then_some(usize::from(dimension))
}

/// Not stratified.
const NONE: u8 = u8::MAX;

/// One more than the largest index of a coordinate that is stratified.
const ROWS: usize = layout::CAMERA_HEAD as usize + VERTICES * layout::BOUNCE as usize;

/// For each index and stream the dimension; looked up because every coordinate of every path asks.
static DIMENSIONS: [[u8; Stream::COUNT]; ROWS] = {
    let mut rows = [[NONE; Stream::COUNT]; ROWS];
    rows[0][Stream::Camera as usize] = 0;
    rows[1][Stream::Camera as usize] = 1;
    rows[0][Stream::Wavelength as usize] = 2;
    // The choice of an emitter leads only at the first vertex.
    rows[0][Stream::Connection as usize] = 3;
    let mut vertex = 0;
    while vertex < VERTICES {
        let set = 4 * (1 + vertex as u8);
        let point = layout::CONNECTION as usize * vertex + 1;
        rows[point][Stream::Connection as usize] = set;
        rows[point + 1][Stream::Connection as usize] = set + 1;
        let direction = layout::CAMERA_HEAD as usize + layout::BOUNCE as usize * vertex + 1;
        rows[direction][Stream::Camera as usize] = set + 2;
        rows[direction + 1][Stream::Camera as usize] = set + 3;
        vertex += 1;
    }
    rows
};

/// A bijection of 64 bits (the finaliser of SplitMix64).
pub(crate) fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    struct Half;
    impl Coordinates for Half {
        fn get(&mut self, _: Stream, _: u32) -> f64 {
            0.5
        }
    }

    #[test]
    fn no_two_coordinates_share_a_dimension() {
        let mut seen = HashSet::new();
        for stream in Stream::ALL {
            for index in 0..200 {
                if let Some(at) = dimension(stream, index) {
                    assert!(seen.insert(at), "{stream:?} {index}");
                    assert!(at < 4 * SETS);
                }
            }
        }
        assert_eq!(seen.len(), 4 * SETS);
    }

    /// 256 samples fall into 256 different strips of each coordinate, in every cell and past the period.
    #[test]
    fn samples_are_stratified() {
        for (seed, first) in [(1, 0), (2, 0), (3, 1 << 17)] {
            for (stream, index) in [
                (Stream::Wavelength, 0),
                (Stream::Camera, 5),
                (Stream::Connection, 6),
            ] {
                let strips: HashSet<u64> = (first..first + 256)
                    .map(|sample| {
                        let mut u = Stratified::new(Half, [0.0; 2], [1.0; 2], sample, seed);
                        (u.get(stream, index) * 256.0) as u64
                    })
                    .collect();
                assert_eq!(strips.len(), 256);
            }
        }
    }
}
