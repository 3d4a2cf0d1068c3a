//! The CIE 1931 2-degree observer: colour matching functions and integrals against them.
//!
//! Functions are linear between their 1 nm entries, everywhere in this crate: in the estimator, in
//! the integrals that normalise it and in the pdf. So the expectation of an estimate and the
//! integral it is compared with are the same number, not two quadratures of it.

use crate::data::cie_1931::CIE_1931;

/// Shortest wavelength a path may carry, in nm.
pub const NM_MIN: f32 = 360.0;
/// Longest wavelength a path may carry, in nm.
pub const NM_MAX: f32 = 830.0;

/// Entries of the 1 nm tables, 360 to 830 nm.
pub(crate) const KNOTS: usize = CIE_1931.len();

/// The integral of ybar over 360-830 nm, in nm; 106.857. A spectrum of 1 has Y = 1 because every
/// XYZ of this crate is divided by it.
pub const Y_INTEGRAL: f64 = trapezoid(&CIE_1931)[1];

/// `[xbar, ybar, zbar]` of the CIE 1931 2-degree observer, linear between whole nanometres, zero
/// outside [`NM_MIN`]..=[`NM_MAX`] and for NaN.
#[inline]
pub fn cie_1931(nm: f32) -> [f32; 3] {
    if !(NM_MIN..=NM_MAX).contains(&nm) {
        return [0.0; 3];
    }
    let (i, s) = cell(nm);
    let (a, b) = (CMF[i], CMF[i + 1]);
    std::array::from_fn(|c| a[c] + s * (b[c] - a[c]))
}

/// XYZ of a spectrum, by exact integration of its piecewise linear interpolant at whole
/// nanometres; for tests, calibration and reports, not for rendering.
///
/// `f` is asked at 360, 361, ..., 830 nm. Normalised so that `|_| 1.0` has Y = 1.
pub fn integrate_xyz(f: impl Fn(f64) -> f64) -> [f64; 3] {
    let values: [f64; KNOTS] = std::array::from_fn(|i| f(360.0 + i as f64));
    integrate(&values)
}

/// XYZ, normalised by [`Y_INTEGRAL`], of a function given at the 1 nm knots: the exact integral
/// of the product of two piecewise linear functions.
pub(crate) const fn integrate(values: &[f64; KNOTS]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut i = 0;
    while i + 1 < KNOTS {
        let (v0, v1) = (values[i], values[i + 1]);
        let mut c = 0;
        while c < 3 {
            let (m0, m1) = (CIE_1931[i][c], CIE_1931[i + 1][c]);
            sum[c] += (v0 * m0 + v1 * m1) / 3.0 + (v0 * m1 + v1 * m0) / 6.0;
            c += 1;
        }
        i += 1;
    }
    [
        sum[0] / Y_INTEGRAL,
        sum[1] / Y_INTEGRAL,
        sum[2] / Y_INTEGRAL,
    ]
}

/// The 1 nm interval of a wavelength within the range, and where in it, 0 to 1.
#[inline]
pub(crate) fn cell(nm: f32) -> (usize, f32) {
    let x = nm - NM_MIN;
    let i = (x as usize).min(KNOTS - 2);
    (i, x - i as f32)
}

const fn trapezoid(table: &[[f64; 3]; KNOTS]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut i = 0;
    while i + 1 < KNOTS {
        let mut c = 0;
        while c < 3 {
            sum[c] += 0.5 * (table[i][c] + table[i + 1][c]);
            c += 1;
        }
        i += 1;
    }
    sum
}

/// The table as single-precision quadruples, which load as one vector each.
pub(crate) static CMF: [[f32; 4]; KNOTS] = {
    let mut out = [[0.0; 4]; KNOTS];
    let mut i = 0;
    while i < KNOTS {
        let [x, y, z] = CIE_1931[i];
        out[i] = [x as f32, y as f32, z as f32, 0.0];
        i += 1;
    }
    out
};

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "entries of the table come back exactly")]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_ybar() {
        assert!((Y_INTEGRAL - 106.857).abs() < 1e-3, "{Y_INTEGRAL}");
    }

    #[test]
    fn ybar_peaks_at_555_nm() {
        assert_eq!(cie_1931(555.0)[1], 1.0);
        assert_eq!(cie_1931(359.9), [0.0; 3]);
        assert_eq!(cie_1931(830.1), [0.0; 3]);
        assert_eq!(cie_1931(f32::NAN), [0.0; 3]);
        assert!(cie_1931(830.0)[0] > 0.0);
    }

    #[test]
    fn a_spectrum_of_one_has_y_one() {
        let [x, y, z] = integrate_xyz(|_| 1.0);
        assert!((y - 1.0).abs() < 1e-12);
        assert!((x / (x + y + z) - 1.0 / 3.0).abs() < 1e-4);
        assert!((y / (x + y + z) - 1.0 / 3.0).abs() < 1e-4);
    }
}
