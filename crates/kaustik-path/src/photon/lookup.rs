//! Which discs hold a point.
//!
//! Grids of cells, hashed: a ball goes into every cell that it touches, of the grid whose cells are at least as wide as
//! the ball and less than twice so. A query looks into one cell a grid. Radii follow the distance from the eye, so that
//! a picture has a handful of grids.

use glam::Vec3;

use super::Disc;

/// Grids are this many powers of two apart at most; smaller balls go into the finest grid.
const MOST_GRIDS: i32 = 24;

/// A spatial index over the discs of one iteration, each represented by its bounding ball. It stores
/// indices only; the caller keeps the discs. Memory is reused.
#[derive(Clone, Debug, Default)]
pub struct Lookup {
    grids: Vec<Grid>,
    /// Where each bucket begins in `entries`, and one more for the end of the last.
    starts: Vec<u32>,
    entries: Vec<u32>,
    /// One less than the number of buckets, a power of two.
    mask: u32,
    bounds: [Vec3; 2],
}

#[derive(Clone, Copy, Debug)]
struct Grid {
    /// 1 / width of a cell.
    scale: f32,
    salt: u32,
}

impl Lookup {
    /// Radii whose squares and areas single precision holds.
    pub const RADII: std::ops::RangeInclusive<f32> = 1e-18..=1e18;

    /// Sorts discs (finite, radii within [`RADII`](Self::RADII)) in the place of those that were there.
    pub fn rebuild(&mut self, discs: &[Disc]) {
        self.bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for &Disc { center, radius } in discs {
            let [min, max] = self.bounds;
            self.bounds = [
                min.min(center - Vec3::splat(radius)),
                max.max(center + Vec3::splat(radius)),
            ];
        }
        let levels = discs.iter().map(|disc| level(squared(disc)));
        let top = levels.clone().max().unwrap_or(0);
        let bottom = levels.min().unwrap_or(0).max(top - MOST_GRIDS);
        self.grids.clear();
        self.grids.extend((bottom..=top).map(|level| Grid {
            scale: power_of_two(-level),
            salt: (level as u32).wrapping_mul(0x9e37_79b9),
        }));
        let buckets = (2 * discs.len()).next_power_of_two().max(2);
        self.mask = buckets as u32 - 1;
        self.fill(discs);
    }

    /// Counts, then places: every bucket's balls lie together, in the order of their numbers.
    fn fill(&mut self, discs: &[Disc]) {
        self.starts.clear();
        self.starts.resize(self.mask as usize + 2, 0);
        for disc in discs {
            let cells = self.cells(disc);
            for bucket in cells.iter() {
                self.starts[bucket as usize + 1] += 1;
            }
        }
        for bucket in 0..=self.mask as usize {
            self.starts[bucket + 1] += self.starts[bucket];
        }
        let total = self.starts[self.mask as usize + 1];
        self.entries.clear();
        // No more than that: it may be several numbers a pixel.
        self.entries.reserve_exact(total as usize);
        self.entries.resize(total as usize, 0);
        // Filled from behind, each start ends at its own place.
        for (index, disc) in discs.iter().enumerate().rev() {
            let cells = self.cells(disc);
            for bucket in cells.iter() {
                let end = &mut self.starts[bucket as usize + 1];
                *end -= 1;
                self.entries[*end as usize] = index as u32;
            }
        }
        self.starts.copy_within(1.., 0);
        if let Some(last) = self.starts.last_mut() {
            *last = total;
        }
    }

    /// The most balls in one bucket.
    pub(super) fn fullest(&self) -> u32 {
        let counts = self.starts.windows(2).map(|pair| pair[1] - pair[0]);
        counts.max().unwrap_or(0)
    }

    /// How many of the balls that it was built of touch the cell of this one's centre, in its own grid; those of cells
    /// that share the bucket by chance count with them.
    pub(super) fn crowd(&self, disc: &Disc) -> u32 {
        let grid = self.grid_of(squared(disc));
        let bucket = (grid.bucket(grid.cell(disc.center)) & self.mask) as usize;
        self.starts[bucket + 1] - self.starts[bucket]
    }

    /// The grid of a ball, by its squared radius.
    fn grid_of(&self, squared: f32) -> Grid {
        let bottom = -exponent(self.grids[0].scale);
        self.grids[(level(squared) - bottom).max(0) as usize]
    }

    /// The buckets of a ball, each once.
    fn cells(&self, disc: &Disc) -> Cells {
        let squared = squared(disc);
        let (center, radius) = (disc.center, squared.sqrt());
        let grid = self.grid_of(squared);
        // A little more, so that rounding leaves nothing out.
        let reach = Vec3::splat(radius * 1.0001);
        let (low, high) = (grid.cell(center - reach), grid.cell(center + reach));
        let mut cells = Cells::default();
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    cells.add(grid.bucket([x, y, z]) & self.mask);
                }
            }
        }
        cells
    }

    /// Calls `found` once with the number of each disc that it was built of and whose ball holds the point.
    #[inline]
    pub fn holding(&self, discs: &[Disc], point: Vec3, mut found: impl FnMut(u32)) {
        let [min, max] = self.bounds;
        if !(point.cmpge(min).all() && point.cmple(max).all()) {
            return;
        }
        for grid in &self.grids {
            let bucket = (grid.bucket(grid.cell(point)) & self.mask) as usize;
            let (start, end) = (self.starts[bucket], self.starts[bucket + 1]);
            for &entry in &self.entries[start as usize..end as usize] {
                let disc = &discs[entry as usize];
                let squared = squared(disc);
                if (point - disc.center).length_squared() <= squared && self.is_of(grid, squared) {
                    found(entry);
                }
            }
        }
    }

    /// Buckets are shared by chance: is this a ball of the grid? Else another look would find it again.
    #[inline]
    fn is_of(&self, grid: &Grid, squared: f32) -> bool {
        let own = level(squared).max(-exponent(self.grids[0].scale));
        own == -exponent(grid.scale)
    }
}

impl Grid {
    #[inline]
    fn cell(&self, point: Vec3) -> [i32; 3] {
        (point * self.scale).floor().as_ivec3().to_array()
    }

    #[inline]
    fn bucket(&self, [x, y, z]: [i32; 3]) -> u32 {
        let mut hash = self.salt;
        for at in [x, y, z] {
            hash = (hash ^ at as u32).wrapping_mul(0x85eb_ca6b);
            hash ^= hash >> 15;
        }
        hash.wrapping_mul(0xc2b2_ae35) ^ (hash >> 13)
    }
}

#[inline]
fn squared(disc: &Disc) -> f32 {
    disc.radius * disc.radius
}

/// The least power of two (its exponent) that is at least the diameter, for a squared radius.
#[inline]
fn level(squared: f32) -> i32 {
    // diameter^2 = 4 r^2 <= 4^level
    let diameter = 2.0 * squared.sqrt();
    let exponent = exponent(diameter);
    exponent + i32::from(diameter > power_of_two(exponent))
}

/// Of a positive normal number the exponent of the power of two that is not above it.
#[inline]
fn exponent(x: f32) -> i32 {
    ((x.to_bits() >> 23) & 0xff) as i32 - 127
}

/// A power of two.
#[inline]
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

/// A few different numbers.
#[derive(Default)]
struct Cells {
    buckets: [u32; 27],
    count: usize,
}

impl Cells {
    fn add(&mut self, bucket: u32) {
        let known = self.buckets[..self.count].contains(&bucket);
        if !known && self.count < self.buckets.len() {
            self.buckets[self.count] = bucket;
            self.count += 1;
        }
    }

    fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.buckets[..self.count].iter().copied()
    }
}
