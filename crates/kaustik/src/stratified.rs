//! Coordinates of a pixel's samples that keep out of each other's way.
//!
//! The first coordinates of a path come from an Owen-scrambled Sobol sequence over the pixel's
//! samples (Burley 2020, by the crate `sobol_burley`), the rest from a generator. Each sample is
//! uniform by itself, so that means are unbiased as ever; together they cover the pixel, the
//! wavelengths, the emitters and the first directions evenly, and the picture has less noise. Pixels
//! scramble differently, so that what is left over does not show as a pattern.

use kaustik_path::layout;
use kaustik_pss::{Coordinates, Stream};

/// Vertices whose directions and emitter points are stratified.
const VERTICES: usize = 3;
/// Sets of four dimensions: one for raster and wavelength, one a vertex.
const SETS: usize = 1 + VERTICES;
/// The sequence is made for so many samples; then it begins anew, scrambled otherwise.
const PERIOD_BITS: u32 = 16;

/// Coordinates of one sample of one cell of the raster.
pub(crate) struct Stratified<C> {
    inner: C,
    /// Lower corner of the cell in cells, and the size of a cell as a share of the window.
    corner: [f64; 2],
    size: [f64; 2],
    index: u32,
    seed: u32,
    sets: [Option<[f32; 4]>; SETS],
}

impl<C: Coordinates> Stratified<C> {
    /// Sample `index` of a cell; `seed` tells cells apart. `inner` gives what is not stratified.
    pub(crate) fn new(inner: C, corner: [f64; 2], size: [f64; 2], index: u64, seed: u64) -> Self {
        let seed = mix(seed ^ mix(index >> PERIOD_BITS));
        Self {
            inner,
            corner,
            size,
            index: (index & ((1 << PERIOD_BITS) - 1)) as u32,
            seed: (seed >> 32) as u32,
            sets: [None; SETS],
        }
    }

    fn set(&mut self, set: usize) -> [f32; 4] {
        let (index, seed) = (self.index, self.seed);
        *self.sets[set].get_or_insert_with(|| sobol_burley::sample_4d(index, set as u32, seed))
    }
}

impl<C: Coordinates> Coordinates for Stratified<C> {
    #[inline]
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let Some((set, lane)) = dimension(stream, index) else {
            return self.inner.get(stream, index);
        };
        // 24 bits, which is what a ray in single precision resolves.
        let u = f64::from(self.set(set)[lane]);
        if stream == Stream::Camera && index < 2 {
            let axis = index as usize;
            return (self.corner[axis] + u) * self.size[axis];
        }
        u
    }
}

/// Set and lane of a coordinate that is stratified.
#[inline]
fn dimension(stream: Stream, index: u32) -> Option<(usize, usize)> {
    match stream {
        Stream::Camera if index < 2 => Some((0, index as usize)),
        Stream::Wavelength if index == 0 => Some((0, 2)),
        // The choice of an emitter leads only at the first vertex.
        Stream::Connection if index == 0 => Some((0, 3)),
        Stream::Connection => {
            let (vertex, number) = (index / layout::CONNECTION, index % layout::CONNECTION);
            let stratified = (number == 1 || number == 2) && (vertex as usize) < VERTICES;
            stratified.then(|| (1 + vertex as usize, number as usize - 1))
        }
        Stream::Camera if index >= layout::CAMERA_HEAD => {
            let at = index - layout::CAMERA_HEAD;
            let (vertex, number) = (at / layout::BOUNCE, at % layout::BOUNCE);
            let direction = number == 1 || number == 2;
            let stratified = direction && (vertex as usize) < VERTICES;
            stratified.then(|| (1 + vertex as usize, 1 + number as usize))
        }
        _ => None,
    }
}

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
                    assert!(at.0 < SETS && at.1 < 4);
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
