//! Shadow rays: what is left of light on its way between two vertices.

use kaustik_geometry::Ray;
use kaustik_scene::{Interior, Scene};
use kaustik_spectrum::{Spectrum, Wavelengths};

/// The way that a connection takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shadow {
    /// Ends short of the other vertex.
    pub(crate) ray: Ray,
    /// The solids around its start.
    pub(crate) interior: Interior,
    /// To the other vertex; 0 where that is at infinity, as a walk that escapes from a solid that is not closed is
    /// not dimmed either.
    pub(crate) distance: f64,
}

impl Shadow {
    /// Dims a value by what is in the way and by the solids there; `false` if nothing gets past.
    #[inline]
    pub(crate) fn dim(
        &self,
        scene: &Scene,
        wavelengths: &Wavelengths,
        value: &mut Spectrum,
    ) -> bool {
        let passed = scene.visibility(&self.ray, &self.interior, wavelengths);
        if passed.is_nothing() {
            return false;
        }
        *value *= passed.share;
        if !self.interior.is_vacuum() {
            *value *= scene.transmittance(&self.interior, wavelengths, self.distance);
        }
        true
    }
}
