//! The table: reflectances at three wavelengths over the largest component.

use std::sync::OnceLock;

use super::axis::Axis;
use crate::Sigmoid;

/// Nodes along the largest component z; odd, so that 1/2, where all emission is looked up, is one.
pub(super) const NZ: usize = 49;
/// Nodes along each of the other two components, divided by z.
pub(super) const NX: usize = 33;
/// Cells: for each largest component m, for each y = rgb\[m + 2\] / z, for each x = rgb\[m + 1\] / z, along z.
pub(super) const CELLS: usize = 3 * NX * NX * NZ;

/// The three wavelengths, as t: 435, 548 and 628 nm. Far enough apart to pin the polynomial down
/// over the range that the eye weighs, near enough that reflectances there are not all 0 or 1.
pub(super) const T: [f64; 3] = [0.16, 0.40, 0.57];

/// z by which reflectances at the node z = 0 are divided; below, colours scale.
pub(super) const DARKEST: f64 = 1e-4;

const Z: Axis<NZ> = Axis::new();
const X: Axis<NX> = Axis::new();
static Z_AXIS: Axis<NZ> = Z;
static X_AXIS: Axis<NX> = X;

/// Largest component below which a colour is black.
const BLACK: f32 = 1e-12;
/// Largest reflectance below 1.
const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Reflectances at [`T`] over z, the fourth lane idle: a cell is one vector.
pub(super) struct Table(Vec<[f32; 4]>);

impl Table {
    /// The committed table, unpacked once.
    pub(super) fn get() -> &'static Self {
        static TABLE: OnceLock<Table> = OnceLock::new();
        TABLE.get_or_init(|| Self::decode(include_bytes!("table.zlib")))
    }

    /// The reflectance of a colour that is not a grey, within [0, 1]^3.
    pub(super) fn look_up(&self, rgb: [f32; 3]) -> Sigmoid {
        let m = largest(rgb);
        let z = rgb[m];
        if z < BLACK {
            return Sigmoid::BLACK;
        }
        let (u, v) = (rgb[NEXT[m]] / z, rgb[NEXT[NEXT[m]]] / z);
        let ratios = self.interpolate(m, X_AXIS.find(u), X_AXIS.find(v), Z_AXIS.find(z));
        through(std::array::from_fn(|i| (ratios[i] * z).min(ALMOST_ONE)))
    }

    #[inline]
    fn interpolate(
        &self,
        m: usize,
        (i, x): (usize, f32),
        (j, y): (usize, f32),
        (k, z): (usize, f32),
    ) -> [f32; 4] {
        let base = index(m, j, i, k);
        let row = |at: usize| mix(self.0[at], self.0[at + 1], z);
        let near = mix(row(base), row(base + NZ), x);
        let far = mix(row(base + NX * NZ), row(base + NX * NZ + NZ), x);
        mix(near, far, y)
    }

    /// From the committed form; an undecodable one gives constant reflectances.
    pub(super) fn decode(packed: &[u8]) -> Self {
        let bytes = miniz_oxide::inflate::decompress_to_vec_zlib(packed).unwrap_or_default();
        if bytes.len() != CELLS * 6 {
            debug_assert!(bytes.is_empty(), "the committed table has another size");
            return Self(vec![[1.0; 4]; CELLS]);
        }
        let (high, low) = bytes.split_at(CELLS * 3);
        let mut cells = vec![[0.0; 4]; CELLS];
        let lines = high.chunks_exact(NZ).zip(low.chunks_exact(NZ));
        for (line, (high, low)) in lines.enumerate() {
            let (row, channel) = (line / 3 * NZ, line % 3);
            let (mut code, mut slope) = (0u16, 0u16);
            for (k, (&high, &low)) in high.iter().zip(low).enumerate() {
                let folded = u16::from_be_bytes([high, low]);
                let bend = (folded >> 1) ^ (folded & 1).wrapping_neg();
                slope = slope.wrapping_add(bend);
                code = code.wrapping_add(slope);
                cells[row + k][channel] = ratio(code, k);
            }
        }
        Self(cells)
    }
}

/// Reflectance over z that a code stands for.
///
/// The code is linear in w = a / (a + b), a and b the fourth roots of S / z and of 1 - S: sixteen
/// bits that resolve both ends of [0, 1] finely and relative to how dark the colour is.
fn ratio(code: u16, k: usize) -> f32 {
    let z = z_of(k);
    let w = f64::from(code) / 65535.0;
    let root = w / (1.0 - w).max(1e-9);
    let odds = root * root * root * root * z;
    (odds / (1.0 + odds) / z) as f32
}

/// z at node k, with [`DARKEST`] for 0.
pub(super) const fn z_of(k: usize) -> f64 {
    Axis::<NZ>::node(k).max(DARKEST)
}

/// Position of a cell.
#[inline]
pub(super) const fn index(m: usize, j: usize, i: usize, k: usize) -> usize {
    ((m * NX + j) * NX + i) * NZ + k
}

/// The component after each, in a circle.
pub(super) const NEXT: [usize; 3] = [1, 2, 0];

#[inline]
fn largest([r, g, b]: [f32; 3]) -> usize {
    if r >= g && r >= b {
        0
    } else if g >= b {
        1
    } else {
        2
    }
}

#[inline]
fn mix(a: [f32; 4], b: [f32; 4], s: f32) -> [f32; 4] {
    std::array::from_fn(|c| a[c] + s * (b[c] - a[c]))
}

/// The sigmoid with these reflectances, inside (0, 1), at [`T`]: inverts s, then interpolates by
/// divided differences.
#[inline]
fn through(reflectances: [f32; 3]) -> Sigmoid {
    let [x0, x1, x2] = reflectances.map(|s| (s - 0.5) / (s * (1.0 - s)).sqrt());
    const T0: f32 = T[0] as f32;
    const T1: f32 = T[1] as f32;
    const WIDTHS: [f32; 3] = [
        (1.0 / (T[1] - T[0])) as f32,
        (1.0 / (T[2] - T[1])) as f32,
        (1.0 / (T[2] - T[0])) as f32,
    ];
    let first = (x1 - x0) * WIDTHS[0];
    let second = ((x2 - x1) * WIDTHS[1] - first) * WIDTHS[2];
    Sigmoid::new([
        second,
        first - second * (T0 + T1),
        x0 - T0 * (first - second * T1),
    ])
}

#[cfg(test)]
impl Table {
    /// Largest relative difference of any entry.
    pub(super) fn largest_difference(&self, other: &Self) -> f32 {
        let pairs = self.0.iter().flatten().zip(other.0.iter().flatten());
        pairs
            .map(|(a, b)| (a - b).abs() / a.max(*b).max(1e-6))
            .fold(0.0, f32::max)
    }
}
