//! The film: XYZ sums in 64-bit fixed point, shared by all threads.
//!
//! Adds are relaxed atomics: an integer sum needs no order. What must not happen silently is counted
//! instead: a splat that is not finite, a splat too large for the quantum, a sum that leaves +-2^62. A
//! splat is refused from 2^61 quanta on, so that no single add can jump over the guard band between 2^62
//! and the wrap at 2^63 unseen.

use crate::outcome::{Added, Counters, FilmError};
use crate::{Bounds, Filter, Layout, Quantum};
use kaustik_spectrum::Xyz;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering::Relaxed};

/// Largest number of quanta of one splat; larger ones are counted and left out.
const SPLAT_LIMIT: f64 = (1u64 << 61) as f64;
/// A sum at or past this is reported.
const SUM_LIMIT: u64 = 1 << 62;
/// 1.5 x 2^52: adding it to |v| < 2^51 leaves round-to-nearest-even(v) in the low mantissa bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Integer XYZ sums for the pixels of a window. Splatting needs only `&self`.
///
/// 24 bytes a pixel. Pixel (x, y) is in coordinates of the full image, y downwards from the top, whatever
/// the crop window; a raster point (1.5, 0.5) is the centre of pixel (1, 0).
pub struct Film {
    layout: Layout,
    quantum: Quantum,
    inverse: f64,
    crop_min: [f64; 2],
    crop_size: [f64; 2],
    row: usize,
    single: bool,
    sums: Box<[AtomicI64]>,
    non_finite: AtomicU64,
    too_large: AtomicU64,
    overflowed: AtomicU64,
}

impl Film {
    /// A black film of the whole image with the one-pixel box filter.
    ///
    /// # Errors
    /// See [`Film::with_layout`].
    pub fn new(width: u32, height: u32, quantum: Quantum) -> Result<Self, FilmError> {
        Self::with_layout(&Layout::new(width, height), quantum)
    }

    /// A black film.
    ///
    /// # Errors
    /// If the crop window is empty or reaches beyond the image, or the sums do not fit in memory.
    pub fn with_layout(layout: &Layout, quantum: Quantum) -> Result<Self, FilmError> {
        layout.check()?;
        let crop = layout.crop;
        Ok(Self {
            layout: *layout,
            quantum,
            inverse: quantum.inverse(),
            crop_min: [f64::from(crop.x0), f64::from(crop.y0)],
            crop_size: [f64::from(crop.width()), f64::from(crop.height())],
            row: crop.width() as usize,
            single: layout.filter.is_single_pixel(),
            sums: zeros(crop.area())?,
            non_finite: AtomicU64::new(0),
            too_large: AtomicU64::new(0),
            overflowed: AtomicU64::new(0),
        })
    }

    /// Size, crop and filter.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The unit of the sums.
    #[must_use]
    pub fn quantum(&self) -> Quantum {
        self.quantum
    }

    /// The pixel filter.
    #[must_use]
    pub fn filter(&self) -> Filter {
        self.layout.filter
    }

    /// Where raster points are to be drawn from: see [`Layout::extended_bounds`].
    #[must_use]
    pub fn extended_bounds(&self) -> Bounds {
        self.layout.extended_bounds()
    }

    /// Adds a value at a raster point (in pixels of the full image) through the pixel filter.
    #[inline]
    pub fn splat(&self, x: f64, y: f64, value: Xyz) -> Added {
        self.splat_weighted(x, y, value, 1.0)
    }

    /// Adds `value` x `weight` at a raster point through the pixel filter; the product is taken in `f64`.
    #[inline]
    pub fn splat_weighted(&self, x: f64, y: f64, value: Xyz, weight: f64) -> Added {
        let scale = weight * self.inverse;
        let quanta = value.0.map(|v| f64::from(v) * scale);
        if !self.single {
            return self.spread(x, y, quanta);
        }
        // Negative and NaN coordinates fail the comparison as well.
        let (column, row) = (x - self.crop_min[0], y - self.crop_min[1]);
        let inside =
            column >= 0.0 && column < self.crop_size[0] && row >= 0.0 && row < self.crop_size[1];
        if inside && addable(quanta) {
            self.deposit(row as usize * self.row + column as usize, quanta)
        } else {
            self.refuse(x, y, quanta)
        }
    }

    /// Adds a value to one pixel (coordinates of the full image), past the filter.
    #[inline]
    pub fn add(&self, x: u32, y: u32, value: Xyz) -> Added {
        let quanta = value.0.map(|v| f64::from(v) * self.inverse);
        let crop = &self.layout.crop;
        let inside = x >= crop.x0 && x < crop.x1 && y >= crop.y0 && y < crop.y1;
        if inside && addable(quanta) {
            self.deposit(
                (y - crop.y0) as usize * self.row + (x - crop.x0) as usize,
                quanta,
            )
        } else {
            self.refuse(f64::from(x), f64::from(y), quanta)
        }
    }

    /// A splat through a filter of more than one pixel.
    fn spread(&self, x: f64, y: f64, quanta: [f64; 3]) -> Added {
        let bounds = self.extended_bounds();
        let near =
            x >= bounds.min[0] && x < bounds.max[0] && y >= bounds.min[1] && y < bounds.max[1];
        if !near || !addable(quanta) {
            return self.refuse(x, y, quanta);
        }
        let (columns, rows) = (self.layout.filter.taps(x), self.layout.filter.taps(y));
        let left = columns.first() - i64::from(self.layout.crop.x0);
        let top = rows.first() - i64::from(self.layout.crop.y0);
        let height = i64::from(self.layout.crop.height());
        let width = i64::from(self.layout.crop.width());
        let mut added = Added::Outside;
        for (row, wy) in (top..).zip(rows.weights()) {
            if !(0..height).contains(&row) {
                continue;
            }
            for (column, wx) in (left..).zip(columns.weights()) {
                if (0..width).contains(&column) {
                    let pixel = row as usize * self.row + column as usize;
                    added = self.deposit(pixel, quanta.map(|q| q * (wx * wy)));
                }
            }
        }
        added
    }

    /// The add itself: `pixel` is one of the film's, each |quanta| below the limit.
    #[inline]
    fn deposit(&self, pixel: usize, quanta: [f64; 3]) -> Added {
        let sums = &self.sums[pixel * 3..pixel * 3 + 3];
        let mut past = false;
        for (sum, q) in sums.iter().zip(quanta) {
            let add = round(q);
            let now = sum.fetch_add(add, Relaxed).wrapping_add(add);
            past |= now.unsigned_abs() >= SUM_LIMIT;
        }
        if past {
            self.count_overflow();
        }
        Added::Yes
    }

    #[cold]
    fn count_overflow(&self) {
        self.overflowed.fetch_add(1, Relaxed);
    }

    /// Says why a splat was not added, and counts what is worth a report.
    #[cold]
    fn refuse(&self, x: f64, y: f64, quanta: [f64; 3]) -> Added {
        if !(x.is_finite() && y.is_finite() && quanta.iter().all(|q| q.is_finite())) {
            self.non_finite.fetch_add(1, Relaxed);
            Added::NonFinite
        } else if !addable(quanta) {
            self.too_large.fetch_add(1, Relaxed);
            Added::TooLarge
        } else {
            Added::Outside
        }
    }

    /// What was left out so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        Counters {
            non_finite: self.non_finite.load(Relaxed),
            too_large: self.too_large.load(Relaxed),
            overflowed: self.overflowed.load(Relaxed),
        }
    }

    /// The raw sums in quanta: X, Y, Z of each pixel of the crop window, row by row from the top.
    pub fn sums(&self) -> impl ExactSizeIterator<Item = i64> + '_ {
        self.sums.iter().map(|sum| sum.load(Relaxed))
    }

    /// XYZ of one pixel by its index in the crop window, in the units of what was splatted.
    pub(crate) fn value(&self, pixel: usize) -> [f64; 3] {
        let quantum = self.quantum.value();
        std::array::from_fn(|c| self.sums[pixel * 3 + c].load(Relaxed) as f64 * quantum)
    }

    /// Adds raw sums and counters, as [`Film::sums`] and [`Film::counters`] gave them: restores a black
    /// film from a state file, or merges the share of another process.
    ///
    /// # Errors
    /// If the number of sums is not three a pixel; nothing is added then.
    pub fn add_sums(
        &self,
        sums: impl ExactSizeIterator<Item = i64>,
        counters: &Counters,
    ) -> Result<(), FilmError> {
        if sums.len() != self.sums.len() {
            return Err(FilmError::Length {
                found: sums.len(),
                expected: self.sums.len(),
            });
        }
        for (sum, add) in self.sums.iter().zip(sums) {
            let old = sum.fetch_add(add, Relaxed);
            // Two sums, each of any size: the exact total decides.
            if (i128::from(old) + i128::from(add)).unsigned_abs() >= u128::from(SUM_LIMIT) {
                self.count_overflow();
            }
        }
        self.non_finite.fetch_add(counters.non_finite, Relaxed);
        self.too_large.fetch_add(counters.too_large, Relaxed);
        self.overflowed.fetch_add(counters.overflowed, Relaxed);
        Ok(())
    }

    /// Adds another film's sums and counters to this one.
    ///
    /// # Errors
    /// If the two differ in size, crop, filter or quantum; nothing is added then.
    pub fn merge(&self, other: &Film) -> Result<(), FilmError> {
        let (a, b) = (&self.layout, &other.layout);
        if (a.width, a.height) != (b.width, b.height) {
            return Err(FilmError::Mismatch("size"));
        }
        if a.crop != b.crop {
            return Err(FilmError::Mismatch("crop window"));
        }
        if a.filter != b.filter {
            return Err(FilmError::Mismatch("pixel filter"));
        }
        if self.quantum != other.quantum {
            return Err(FilmError::Mismatch("quantum"));
        }
        self.add_sums(other.sums(), &other.counters())
    }

    /// Makes the film black, for sums of another unit: its memory serves again.
    pub fn renew(&mut self, quantum: Quantum) {
        self.clear();
        self.quantum = quantum;
        self.inverse = quantum.inverse();
    }

    /// Makes the film black again and its counters zero. Wants the film alone, so that no add is lost.
    pub fn clear(&mut self) {
        for sum in &mut self.sums {
            *sum.get_mut() = 0;
        }
        *self.non_finite.get_mut() = 0;
        *self.too_large.get_mut() = 0;
        *self.overflowed.get_mut() = 0;
    }
}

/// Whether each value is finite and below the limit of one splat (a NaN compares false).
#[inline]
fn addable(quanta: [f64; 3]) -> bool {
    quanta.iter().all(|q| q.abs() < SPLAT_LIMIT)
}

/// Nearest integer, ties to even, of |q| < 2^62.
#[inline]
fn round(q: f64) -> i64 {
    if q.abs() < (1u64 << 51) as f64 {
        ((q + ROUNDER).to_bits() as i64).wrapping_sub(ROUNDER.to_bits() as i64)
    } else {
        q.round_ties_even() as i64
    }
}

/// Three black sums a pixel, or an error where the memory is not to be had.
fn zeros(pixels: u64) -> Result<Box<[AtomicI64]>, FilmError> {
    let bytes = pixels.saturating_mul(24);
    let error = FilmError::Memory { pixels, bytes };
    let count = pixels
        .checked_mul(3)
        .and_then(|n| usize::try_from(n).ok())
        .ok_or(error.clone())?;
    let mut sums = Vec::new();
    sums.try_reserve_exact(count).map_err(|_| error)?;
    sums.resize_with(count, || AtomicI64::new(0));
    Ok(sums.into_boxed_slice())
}

impl std::fmt::Debug for Film {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Film")
            .field("layout", &self.layout)
            .field("quantum", &self.quantum)
            .field("counters", &self.counters())
            .finish_non_exhaustive()
    }
}
