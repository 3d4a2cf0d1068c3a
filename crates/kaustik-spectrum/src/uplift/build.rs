//! Solves the table anew and packs it: how the committed bytes came to be.

use super::solver::{Solution, solve};
use super::table::{CELLS, NEXT, NX, NZ, T, index, z_of};
use crate::uplift::axis::Axis;

/// The codes of all cells, three a cell, and the largest CIELab error of a solution.
pub(super) fn build() -> (Vec<[u16; 3]>, f64) {
    let mut codes = vec![[0; 3]; CELLS];
    let mut worst: f64 = 0.0;
    for m in 0..3 {
        for j in 0..NX {
            for i in 0..NX {
                for (k, solution) in column(m, i, j) {
                    worst = worst.max(solution.error);
                    codes[index(m, j, i, k)] = encode(solution.coefficients, k);
                }
            }
        }
    }
    (codes, worst)
}

/// The colour of a node.
pub(super) fn colour(m: usize, i: usize, j: usize, k: usize) -> [f64; 3] {
    let z = z_of(k);
    let mut rgb = [z; 3];
    rgb[NEXT[m]] = Axis::<NX>::node(i) * z;
    rgb[NEXT[NEXT[m]]] = Axis::<NX>::node(j) * z;
    rgb
}

/// One column along z, from a dark grey level upward, then downward, each solve from its
/// neighbour's answer; from nothing where that stalled.
fn column(m: usize, i: usize, j: usize) -> Vec<(usize, Solution)> {
    const START: usize = NZ / 4;
    let mut out = Vec::with_capacity(NZ);
    for nodes in [(START..NZ).collect::<Vec<_>>(), (0..START).rev().collect()] {
        let mut from = [0.0; 3];
        for k in nodes {
            let rgb = colour(m, i, j, k);
            let mut solution = solve(rgb, from);
            if solution.error > 1e-3 {
                let again = solve(rgb, [0.0; 3]);
                if again.error < solution.error {
                    solution = again;
                }
            }
            from = solution.coefficients;
            out.push((k, solution));
        }
    }
    out
}

/// See `ratio` in the table: the code is linear in a / (a + b), a and b the fourth roots of S / z and 1 - S.
fn encode(coefficients: [f64; 3], k: usize) -> [u16; 3] {
    T.map(|t| {
        let x = (coefficients[0] * t + coefficients[1]) * t + coefficients[2];
        let r = (1.0 + x * x).sqrt();
        let odds = if x < 0.0 {
            1.0 / ((r - x) * (r - x))
        } else {
            (r + x) * (r + x)
        };
        let root = (odds / z_of(k)).sqrt().sqrt();
        (root / (1.0 + root) * 65535.0).round() as u16
    })
}

/// The committed form: along z, second differences, folded so that small ones of either sign are
/// small, high bytes before low bytes, deflated.
pub(super) fn pack(codes: &[[u16; 3]]) -> Vec<u8> {
    let (mut high, mut low) = (Vec::new(), Vec::new());
    for row in codes.chunks(NZ) {
        for channel in 0..3 {
            let (mut code, mut slope) = (0u16, 0u16);
            for cell in row {
                let next = cell[channel].wrapping_sub(code);
                let bend = next.wrapping_sub(slope);
                (code, slope) = (cell[channel], next);
                let folded = (bend << 1) ^ (bend >> 15).wrapping_neg();
                let [h, l] = folded.to_be_bytes();
                high.push(h);
                low.push(l);
            }
        }
    }
    high.extend(low);
    miniz_oxide::deflate::compress_to_vec_zlib(&high, 10)
}
