//! Piecewise-constant distributions in integers.
//!
//! Rounding a running sum in floats makes the probability that is *used* differ from the one that is
//! *reported*, most of all where a sun takes nearly all of it. Here the running sum is rounded
//! to integers once; both sides read the same integers, so they agree exactly, and a cell of
//! positive weight keeps a positive probability however dark it is.

/// The sum of all probabilities.
const TOTAL: u32 = u32::MAX;

/// Writes the starts of the cells of `weights` (finite, >= 0) to `starts`, in units of
/// 1 / `TOTAL`. Returns the sum of the weights; if that is 0, all starts are 0 (the last cell
/// takes all).
pub(super) fn accumulate(weights: &[f64], starts: &mut [u32]) -> f64 {
    let sum: f64 = weights.iter().sum();
    if sum <= 0.0 {
        starts.fill(0);
        return 0.0;
    }
    let (mut running, mut end) = (0.0, 0_u64);
    for (start, &weight) in starts.iter_mut().zip(weights) {
        // `end` may run past TOTAL by the dark cells' minimum; the way back repairs it
        *start = end.min(u64::from(TOTAL)) as u32;
        running += weight;
        let rounded = (running / sum * f64::from(TOTAL)).round() as u64;
        end = rounded.max(end + u64::from(weight > 0.0));
    }
    let mut end = TOTAL;
    for (start, &weight) in starts.iter_mut().zip(weights).rev() {
        *start = (*start).min(end - u32::from(weight > 0.0 && end > 0));
        end = *start;
    }
    sum
}

/// Start and width of cell `i`, in units of probability; `starts` as [`accumulate`] leaves them.
#[inline]
pub(super) fn cell(starts: &[u32], i: usize) -> (f64, f64) {
    let end = starts.get(i + 1).copied().unwrap_or(TOTAL);
    let scale = 1.0 / f64::from(TOTAL);
    let start = f64::from(starts[i]);
    (start * scale, (f64::from(end) - start) * scale)
}

/// The last of `n` cells that starts at or before `x`, and how far into it `x` lies, in [0, 1].
#[inline]
pub(super) fn find(n: usize, x: f64, cell: impl Fn(usize) -> (f64, f64)) -> (usize, f64) {
    let (mut low, mut high) = (0, n);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if cell(middle).0 <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (start, width) = cell(low);
    let into = if width > 0.0 {
        (x - start) / width
    } else {
        0.5
    };
    (low, into.clamp(0.0, 1.0))
}

/// Inverse of the running integral of the density on [0, 1] that goes linearly from `a` to `b`
/// (>= 0, any scale).
#[inline]
pub(super) fn invert_linear(a: f64, b: f64, u: f64) -> f64 {
    let root = a + (a * a + u * (b - a) * (b + a)).max(0.0).sqrt();
    if root > 0.0 {
        (u * (a + b) / root).clamp(0.0, 1.0)
    } else {
        u
    }
}

/// That density at `s`, normalised; 0 if there is none.
#[inline]
pub(super) fn linear(a: f64, b: f64, s: f64) -> f64 {
    if a + b > 0.0 {
        2.0 * (a + (b - a) * s) / (a + b)
    } else {
        0.0
    }
}
