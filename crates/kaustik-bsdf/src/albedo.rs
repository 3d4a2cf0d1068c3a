//! How much light single scattering by facets loses: what compensation gives back.
//!
//! Light that meets a second facet is missing from the single-scattering lobes. The tables here
//! hold that loss `1 - E(mu)` and its cosine-weighted mean, by deterministic quadrature over the
//! visible normals. Those of facets come with the crate: interfaces' alone take half a minute to compute, because total
//! reflection makes their integrands rough. Sheen's is computed at the first use. Every
//! user interpolates the same tables, so loss and mean agree with each other and the lobes built
//! from them are reciprocal whatever the tables' error.
//!
//! At small alpha the loss lives at cosines of the order of alpha (a scale-free bump there, order
//! alpha^2 elsewhere). Half of the cosine axis is therefore stretched with alpha, see `axis`.

mod axis;
#[cfg(test)]
mod generate;
mod interface;
mod quadrature;
mod reflector;
mod sheen;

pub(crate) use interface::{InterfaceLoss, interface_loss};
pub(crate) use reflector::{ReflectorLoss, reflector_loss};
pub(crate) use sheen::{sheen_albedo, sheen_peak};

/// Calls `f(t, weight)` for a quadrature of `[0, 1]` that respects the cells between `nodes`
/// nodes: three-point Gauss in each, weights summing to 1.
fn over_cells(nodes: usize, mut f: impl FnMut(f64, f64)) {
    let rule = quadrature::gauss_legendre::<3>();
    let width = 1.0 / (nodes - 1) as f64;
    for cell in 0..nodes - 1 {
        for &(x, weight) in &rule {
            f((cell as f64 + x) * width, weight * width);
        }
    }
}
