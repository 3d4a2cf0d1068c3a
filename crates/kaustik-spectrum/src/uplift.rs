//! Reflectance spectra of RGB colours (Jakob and Hanika 2019).

mod solver;

use crate::Sigmoid;

/// A smooth reflectance whose colour under D65 is a linear Rec.709 colour in [0, 1]^3 (clamped;
/// not a number counts as 0). Greys are constant spectra, 0 and 1 exactly.
pub fn uplift_reflectance(rgb: [f32; 3]) -> Sigmoid {
    solve_reflectance(rgb)
}

/// The same, solved for this very colour rather than looked up.
pub fn solve_reflectance(rgb: [f32; 3]) -> Sigmoid {
    let [r, g, b] = rgb.map(|c| c.max(0.0).min(1.0));
    #[expect(clippy::float_cmp, reason = "exact greys have a closed form")]
    if r == g && g == b {
        return Sigmoid::constant(r);
    }
    let solution = solver::solve([r, g, b].map(f64::from), [0.0; 3]);
    Sigmoid::new(solution.coefficients.map(|c| c as f32))
}
