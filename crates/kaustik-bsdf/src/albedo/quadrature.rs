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

/// Calls `f(wo, h)` for `RINGS x AZIMUTHS` facet normals as evenly as they are seen from cosine
/// `mu`; the mean of `f` is the integral.
///
/// Half the azimuths stand for both, since everything isotropic is even in y. Each azimuth shifts
/// its rings by another fraction, because total reflection makes integrands rough along the rings:
/// no Gaussian rule would help, and equal rings would see it all at the same place.
#[cfg(test)]
pub(crate) fn over_visible(ggx: Ggx, mu: f64, mut f: impl FnMut(DVec3, DVec3)) {
    let wo = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let stretched = ggx.stretch(wo);
    for azimuth in 0..AZIMUTHS {
        let (s, c) = sin_cos_turns((azimuth as f64 + 0.5) / AZIMUTHS as f64 * 0.5);
        let shift = ((azimuth as f64 + 0.5) * 0.618_033_988_749_894_9).fract();
        for ring in 0..RINGS {
            let z = 1.0 - (ring as f64 + shift) / RINGS as f64 * (1.0 + stretched.z);
            let r = (1.0 - z * z).max(0.0).sqrt();
            f(wo, ggx.unstretch(stretched, DVec3::new(r * c, r * s, z)));
        }
    }
}

#[cfg(test)]
const RINGS: usize = 200;
#[cfg(test)]
const AZIMUTHS: usize = 89;
/// What one facet normal of [`over_visible`] stands for.
#[cfg(test)]
pub(crate) const WEIGHT: f64 = 1.0 / (RINGS * AZIMUTHS) as f64;
