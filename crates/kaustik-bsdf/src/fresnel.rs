//! Fresnel's equations, exact, and Schlick's shorthand.

use kaustik_spectrum::Spectrum;

/// Reflectance of a dielectric interface for unpolarised light and the cosine on the other side.
///
/// `cosine` in `[0, 1]` is on the incident side; `eta` is the index beyond over the index here.
/// Total reflection: `(1, 0)`.
#[inline]
pub fn dielectric(cosine: f64, eta: f64) -> (f64, f64) {
    let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    if squared <= 0.0 {
        return (1.0, 0.0);
    }
    let beyond = squared.sqrt();
    let s = (cosine - eta * beyond) / (cosine + eta * beyond);
    let p = (eta * cosine - beyond) / (eta * cosine + beyond);
    ((0.5 * (s * s + p * p)).min(1.0), beyond)
}

/// [`dielectric`]'s reflectance in every lane.
#[inline]
pub fn dielectric_lanes(cosine: f64, eta: Spectrum) -> Spectrum {
    eta.map(|eta| dielectric(cosine, f64::from(eta)).0 as f32)
}

/// Reflectance of a conductor for unpolarised light, each lane with its index `eta - i k`.
///
/// `cosine` in `[0, 1]`. From |r|^2 of both polarisations written out over the reals.
#[inline]
pub fn conductor(cosine: f64, eta: Spectrum, k: Spectrum) -> Spectrum {
    eta.zip(k, |eta, k| {
        conductor_one(cosine, f64::from(eta), f64::from(k)) as f32
    })
}

#[inline]
fn conductor_one(cosine: f64, eta: f64, k: f64) -> f64 {
    let c2 = cosine * cosine;
    let s2 = 1.0 - c2;
    let difference = eta * eta - k * k - s2;
    // a^2 + b^2 with a + ib the root of (eta - ik)^2 - sin^2
    let sum = (difference * difference + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (sum + difference)).max(0.0).sqrt();
    let across = 2.0 * a * cosine;
    let rs = (sum + c2 - across) / (sum + c2 + across);
    let rest = c2 * sum + s2 * s2;
    let rp = rs * (rest - across * s2) / (rest + across * s2);
    let reflectance = 0.5 * (rs + rp);
    // 0/0 at grazing on an index of exactly 0
    if reflectance.is_finite() {
        reflectance.clamp(0.0, 1.0)
    } else {
        1.0
    }
}

/// `(1 - cosine)^5`, Schlick's weight of F90.
#[inline]
pub fn schlick_weight(cosine: f64) -> f64 {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    let x2 = x * x;
    x2 * x2 * x
}

/// Reflectance at normal incidence of an interface of the given relative index.
#[inline]
pub fn normal_incidence(eta: f64) -> f64 {
    let r = (eta - 1.0) / (eta + 1.0);
    r * r
}

/// Cosine-weighted mean of [`dielectric`] over the hemisphere seen from the thinner side, for an
/// index ratio `n` >= 1 (closed form of the integral 2 F(mu) mu dmu).
///
/// Seen from the denser side the mean is `1 - (1 - this) / n^2`.
pub fn mean_dielectric(n: f64) -> f64 {
    // The closed form cancels badly near 1, where the mean goes to 0 like (n-1)
    if n < 1.02 {
        return mean_by_quadrature(n);
    }
    let n2 = n * n;
    let n4 = n2 * n2;
    let (less, more) = (n2 - 1.0, n2 + 1.0);
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * less * less / (more * more * more) * libm::log((n - 1.0) / (n + 1.0))
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / (more * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / (more * (n4 - 1.0) * (n4 - 1.0)) * libm::log(n)
}

fn mean_by_quadrature(n: f64) -> f64 {
    // mu = x^3 puts the points where F lives: near grazing
    const STEPS: usize = 64;
    let sum: f64 = (0..STEPS)
        .map(|i| {
            let x = (i as f64 + 0.5) / STEPS as f64;
            let mu = x * x * x;
            dielectric(mu, n).0 * mu * 3.0 * x * x
        })
        .sum();
    2.0 * sum / STEPS as f64
}
