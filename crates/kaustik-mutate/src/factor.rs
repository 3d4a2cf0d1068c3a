//! The factors that densities are made of, by name: tests leave out one at a time, and find each.

/// A factor of the density of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Factor {
    /// Raster area per solid angle of a direction from the lens.
    Raster,
    /// Density of a raster point.
    RasterPdf,
    /// Density of a point of the lens.
    LensPdf,
    /// Against the light: cosine where the step arrives.
    CosToLight,
    /// Against the light: square of the distance.
    DistanceToLight,
    /// Against the light: cosine where a run of Dirac scatterings begins.
    CosBeforeRunToLight,
    /// Against the light: what passes on the way, and stops at its end.
    PassedToLight,
    /// Against the light: chance that a pane where the step arrives is met and not passed.
    MeetingToLight,
    /// Against the light: probability of a direction.
    DirectionToLight,
    /// Against the light: probability of a Dirac scattering.
    DiracToLight,
    /// With the light: cosine where the step arrives.
    CosToEye,
    /// With the light: square of the distance.
    DistanceToEye,
    /// With the light: cosine where a run of Dirac scatterings begins.
    CosBeforeRunToEye,
    /// With the light: what passes on the way, and stops at its end.
    PassedToEye,
    /// With the light: chance that a pane where the step arrives is met and not passed.
    MeetingToEye,
    /// With the light: probability of a direction.
    DirectionToEye,
    /// With the light: probability of a Dirac scattering.
    DiracToEye,
    /// With the light: squared ratio of the indices.
    Index,
    /// With the light: shading normals.
    ShadingNormal,
    /// Density of a point of an emitter.
    EmitterPoint,
    /// How much more often an emitter is chosen from where it is joined than by walks with the light.
    EmitterOdds,
    /// Density of a direction of emission.
    Emission,
    /// Weight of the deletion that was made.
    CutWeight,
    /// Sum of the weights of all deletions of the path.
    CutsOfPath,
    /// Probability of the number of edges added.
    Addition,
    /// Number of ways to share the new vertices between the walks.
    Splits,
    /// Ways to make the new vertices that have a walk with the light: that there are any.
    OtherWays,
    /// Is the size of a jitter possible from where it leads?
    Range,
    /// Area of an emitter at another time.
    Growth,
}

/// The factor's value.
#[cfg(not(test))]
#[inline(always)]
pub(crate) fn factor(_: Factor, value: f64) -> f64 {
    value
}

#[cfg(test)]
pub(crate) use planted::factor;

#[cfg(test)]
pub(crate) mod planted {
    use std::cell::{Cell, RefCell};
    use std::collections::BTreeSet;

    use super::Factor;

    thread_local! {
        static LEFT_OUT: Cell<Option<Factor>> = const { Cell::new(None) };
        static MET: RefCell<Option<BTreeSet<Factor>>> = const { RefCell::new(None) };
    }

    /// The factor's value, or 1 where it is left out.
    pub(crate) fn factor(which: Factor, value: f64) -> f64 {
        MET.with_borrow_mut(|met| {
            if let Some(met) = met {
                met.insert(which);
            }
        });
        if LEFT_OUT.get() == Some(which) {
            1.0
        } else {
            value
        }
    }

    /// Runs something with a factor left out.
    pub(crate) fn without<R>(which: Option<Factor>, run: impl FnOnce() -> R) -> R {
        let before = LEFT_OUT.replace(which);
        let found = run();
        LEFT_OUT.set(before);
        found
    }

    /// Runs something and tells which factors it has asked for.
    pub(crate) fn met(run: impl FnOnce()) -> BTreeSet<Factor> {
        MET.set(Some(BTreeSet::new()));
        run();
        MET.take().unwrap_or_default()
    }
}
