#[cfg(test)]
use crate::ggx::Ggx;
use crate::warp::sin_cos_turns;
#[cfg(test)]
use glam::DVec3;

/// Points and weights of Gauss and Legendre on `[0, 1]`.
pub(crate) fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        // Tricomi's guess, then Newton on the Legendre polynomial
        let (_, c) = sin_cos_turns((i as f64 + 0.75) / (N as f64 + 0.5) * 0.5);
        let mut x = c;
        let mut slope = 1.0;
        for _ in 0..8 {
            let (value, derivative) = legendre(N, x);
            x -= value / derivative;
            slope = derivative;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Legendre polynomial of degree `n` and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
        );
    }
    let n = n as f64;
    (value, n * (x * value - before) / (x * x - 1.0))
}

/// Calls `f(wo, h, weight)` for facet normals as seen from cosine `mu`; the weights sum to 1.
///
/// Half the azimuths stand for both, since everything isotropic is even in y. `AZIMUTHS` are evenly
/// spaced (the integrand is periodic), `RINGS` are Gaussian.
#[cfg(test)]
pub(crate) fn over_visible<const RINGS: usize, const AZIMUTHS: usize>(
    ggx: Ggx,
    mu: f64,
    rings: &[(f64, f64); RINGS],
    mut f: impl FnMut(DVec3, DVec3, f64),
) {
    let wo = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let stretched = ggx.stretch(wo);
    for azimuth in 0..AZIMUTHS {
        let (s, c) = sin_cos_turns((azimuth as f64 + 0.5) / AZIMUTHS as f64 * 0.5);
        for &(ring, weight) in rings {
            let z = 1.0 - ring * (1.0 + stretched.z);
            let r = (1.0 - z * z).max(0.0).sqrt();
            let h = ggx.unstretch(stretched, DVec3::new(r * c, r * s, z));
            f(wo, h, weight / AZIMUTHS as f64);
        }
    }
}
