//! What a camera walk does at a vertex: stop at what scatters widely, or follow what does not.

use kaustik_bsdf::{Bsdf, Lobe, Parts};
use kaustik_pss::{Coordinates, Stream};

use crate::layout;
use crate::walk::{Scatter, Walk};

/// Where a surface has both parts, neither is taken less often: its albedo is an estimate.
const LEAST: f64 = 0.1;

/// The part that was taken.
pub(super) enum Part {
    /// The walk ends.
    Wide(Bsdf),
    /// The walk goes on, by this part alone.
    Narrow(Bsdf),
}

/// Takes one of the two parts of a surface, by their albedos, and gives the walk what the other would have had.
#[inline]
pub(super) fn take(
    walk: &mut Walk<'_>,
    scatter: &Scatter<'_>,
    threshold: f64,
    u: &mut dyn Coordinates,
) -> Part {
    // The most frequent of all needs no look at its parts.
    if let Bsdf::Lambertian(_) = scatter.bsdf {
        return Part::Wide(*scatter.bsdf);
    }
    match scatter.bsdf.parts(threshold) {
        Parts {
            wide: Some(wide),
            narrow: Some(narrow),
        } => {
            let albedo = |bsdf: &Bsdf| f64::from(bsdf.albedo(scatter.wo).mean()).max(1e-9);
            let (a, b) = (albedo(&wide), albedo(&narrow));
            let share = (a / (a + b)).clamp(LEAST, 1.0 - LEAST);
            if u.get(Stream::Technique, layout::part(walk.edges)) < share {
                walk.throughput /= share as f32;
                Part::Wide(wide)
            } else {
                walk.throughput /= (1.0 - share) as f32;
                Part::Narrow(narrow)
            }
        }
        Parts {
            narrow: Some(narrow),
            ..
        } => Part::Narrow(narrow),
        Parts { wide, .. } => Part::Wide(wide.unwrap_or(*scatter.bsdf)),
    }
}
