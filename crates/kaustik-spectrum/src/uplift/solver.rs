//! Finds the reflectance of a colour: damped Gauss-Newton (Levenberg-Marquardt) in CIELab.

use crate::cmf::{KNOTS, integrate};
use crate::illuminant::D65_KNOTS;
use crate::rgb::{RGB_TO_XYZ, WHITE_XYZ};

/// What the solver found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    /// Of t^2, t and 1.
    pub(super) coefficients: [f64; 3],
    /// Distance of the colour reached from the colour wanted, in CIELab.
    #[cfg(test)]
    pub(super) error: f64,
}

/// Pull towards small coefficients, in CIELab per unit. It moves no colour visibly (1000 units cost
/// 0.001) but makes the answer unique where the wanted colour is a limit.
const PULL: f64 = 1e-6;

/// From a starting point, coefficients of t^2, t and 1.
pub(super) fn solve(rgb: [f64; 3], start: [f64; 3]) -> Solution {
    let wanted = lab(mul(&RGB_TO_XYZ, rgb));
    let mut c = centred(start);
    let mut state = residual(c, wanted);
    let mut damping = 1e-3;
    for _ in 0..500 {
        let Some(step) = step(&state, c, damping) else {
            break;
        };
        let trial = [c[0] + step[0], c[1] + step[1], c[2] + step[2]];
        let next = residual(trial, wanted);
        if next.cost < state.cost {
            let gain = state.cost - next.cost;
            (c, state) = (trial, next);
            damping = (damping * 0.2).max(1e-15);
            if gain < 1e-14 * state.cost || state.cost < 1e-24 {
                break;
            }
        } else {
            damping *= 4.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    Solution {
        coefficients: in_t(c),
        #[cfg(test)]
        error: norm(state.lab),
    }
}

/// CIELab distance between a reflectance (coefficients of t^2, t, 1) and a colour.
#[cfg(test)]
pub(super) fn lab_error(coefficients: [f64; 3], rgb: [f64; 3]) -> f64 {
    norm(residual(centred(coefficients), lab(mul(&RGB_TO_XYZ, rgb))).lab)
}

struct Residual {
    lab: [f64; 3],
    jacobian: [[f64; 3]; 3],
    cost: f64,
}

/// Colour of the reflectance minus the colour wanted, with derivatives by the centred
/// coefficients.
fn residual(c: [f64; 3], wanted: [f64; 3]) -> Residual {
    let mut xyz = [0.0; 3];
    let mut by = [[0.0; 3]; 3];
    for (k, weight) in WEIGHTS.iter().enumerate() {
        let u = k as f64 * (2.0 / (KNOTS - 1) as f64) - 1.0;
        let x = (c[0] * u + c[1]) * u + c[2];
        let q = 1.0 / (1.0 + x * x);
        let r = q.sqrt();
        let s = if x < 0.0 {
            0.5 * q / (1.0 - x * r)
        } else {
            0.5 + 0.5 * x * r
        };
        let slope = 0.5 * q * r;
        for i in 0..3 {
            xyz[i] += weight[i] * s;
            let d = weight[i] * slope;
            by[i][2] += d;
            by[i][1] += d * u;
            by[i][0] += d * u * u;
        }
    }
    let f: [f64; 3] = std::array::from_fn(|i| curve(xyz[i] / WHITE_XYZ[i]));
    let df: [f64; 3] = std::array::from_fn(|i| curve_slope(xyz[i] / WHITE_XYZ[i]) / WHITE_XYZ[i]);
    let jf: [[f64; 3]; 3] = std::array::from_fn(|i| by[i].map(|d| d * df[i]));
    let found = [
        116.0 * f[1] - 16.0,
        500.0 * (f[0] - f[1]),
        200.0 * (f[1] - f[2]),
    ];
    let lab: [f64; 3] = std::array::from_fn(|i| found[i] - wanted[i]);
    let jacobian = [
        jf[1].map(|d| 116.0 * d),
        std::array::from_fn(|i| 500.0 * (jf[0][i] - jf[1][i])),
        std::array::from_fn(|i| 200.0 * (jf[1][i] - jf[2][i])),
    ];
    let cost = dot(lab, lab) + PULL * PULL * dot(c, c);
    Residual {
        lab,
        jacobian,
        cost,
    }
}

/// Solves (J'J + pull^2 + damping diag) step = -gradient.
fn step(state: &Residual, c: [f64; 3], damping: f64) -> Option<[f64; 3]> {
    let j = &state.jacobian;
    let mut a = [[0.0; 3]; 3];
    let mut g = [0.0; 3];
    for row in 0..3 {
        for col in 0..3 {
            a[row][col] = (0..3).map(|k| j[k][row] * j[k][col]).sum();
        }
        a[row][row] += PULL * PULL;
        a[row][row] *= 1.0 + damping;
        g[row] = -(0..3).map(|k| j[k][row] * state.lab[k]).sum::<f64>() - PULL * PULL * c[row];
    }
    cholesky(a, g)
}

fn cholesky(mut a: [[f64; 3]; 3], mut b: [f64; 3]) -> Option<[f64; 3]> {
    for i in 0..3 {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            if i != j {
                a[i][j] = sum / a[j][j];
            } else if sum > 0.0 {
                a[i][i] = sum.sqrt();
            } else {
                return None;
            }
        }
        b[i] = (b[i] - (0..i).map(|k| a[i][k] * b[k]).sum::<f64>()) / a[i][i];
    }
    for i in (0..3).rev() {
        b[i] = (b[i] - (i + 1..3).map(|k| a[k][i] * b[k]).sum::<f64>()) / a[i][i];
    }
    Some(b)
}

/// CIELab against D65.
fn lab(xyz: [f64; 3]) -> [f64; 3] {
    let f: [f64; 3] = std::array::from_fn(|i| curve(xyz[i] / WHITE_XYZ[i]));
    [
        116.0 * f[1] - 16.0,
        500.0 * (f[0] - f[1]),
        200.0 * (f[1] - f[2]),
    ]
}

const KNEE: f64 = 6.0 / 29.0;

fn curve(t: f64) -> f64 {
    if t > KNEE * KNEE * KNEE {
        libm::cbrt(t)
    } else {
        t / (3.0 * KNEE * KNEE) + 4.0 / 29.0
    }
}

fn curve_slope(t: f64) -> f64 {
    if t > KNEE * KNEE * KNEE {
        let f = libm::cbrt(t);
        1.0 / (3.0 * f * f)
    } else {
        1.0 / (3.0 * KNEE * KNEE)
    }
}

/// D65 x matching functions at the knots, for the exact integral against a piecewise linear
/// function; sums to [`WHITE_XYZ`].
static WEIGHTS: [[f64; 3]; KNOTS] = weights();

const fn weights() -> [[f64; 3]; KNOTS] {
    use crate::cmf::Y_INTEGRAL;
    use crate::data::cie_1931::CIE_1931;
    let mut out = [[0.0; 3]; KNOTS];
    let mut sum = [0.0; 3];
    let mut i = 0;
    while i < KNOTS {
        let end = if i == 0 || i + 1 == KNOTS { 0.5 } else { 1.0 };
        let mut c = 0;
        while c < 3 {
            out[i][c] = end * D65_KNOTS[i] * CIE_1931[i][c] / Y_INTEGRAL;
            sum[c] += out[i][c];
            c += 1;
        }
        i += 1;
    }
    let white = integrate(&D65_KNOTS);
    let mut i = 0;
    while i < KNOTS {
        let mut c = 0;
        while c < 3 {
            out[i][c] *= white[c] / sum[c];
            c += 1;
        }
        i += 1;
    }
    out
}

/// Coefficients of t^2, t, 1 as coefficients of u^2, u, 1 with u = 2 t - 1: better conditioned.
fn centred([a, b, c]: [f64; 3]) -> [f64; 3] {
    [0.25 * a, 0.5 * (a + b), 0.25 * a + 0.5 * b + c]
}

fn in_t([a, b, c]: [f64; 3]) -> [f64; 3] {
    [4.0 * a, 2.0 * b - 4.0 * a, a - b + c]
}

fn mul(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|r| dot(m[r], v))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
