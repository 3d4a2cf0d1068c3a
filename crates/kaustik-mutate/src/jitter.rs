use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use kaustik_bsdf::Frame;
use kaustik_mcmc::Draws;

/// Sizes of a jitter: its logarithm is uniform between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// The smallest, > 0.
    pub least: f64,
    /// The largest, above the smallest.
    pub most: f64,
}

impl Radii {
    /// In pixels: a tenth, and the radius of a twentieth of the image (Veach 1997).
    pub fn raster(pixels: DVec2) -> Self {
        let most = (0.05 * pixels.element_product() / std::f64::consts::PI).sqrt();
        Self {
            least: 0.1,
            most: most.max(1.0),
        }
    }

    /// In radians, for directions within a path: our choice, any will do.
    pub const fn angles() -> Self {
        Self {
            least: 1e-4,
            most: 0.1,
        }
    }

    /// Both times a factor.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            least: self.least * factor,
            most: self.most * factor,
        }
    }

    pub(crate) fn holds(self, size: f64) -> bool {
        (self.least..=self.most).contains(&size)
    }

    /// `r = r2 exp(-ln(r2/r1) xi)`.
    pub(crate) fn draw<D: Draws + ?Sized>(self, draws: &mut D) -> f64 {
        self.most * libm::exp(-libm::log(self.most / self.least) * draws.uniform())
    }

    /// A step in the plane.
    pub(crate) fn step<D: Draws + ?Sized>(self, draws: &mut D) -> (DVec2, f64) {
        let size = self.draw(draws);
        let phi = TAU * draws.uniform();
        (DVec2::new(libm::cos(phi), libm::sin(phi)) * size, size)
    }

    /// `direction` (unit) turned by an angle, with the angle; density per solid angle
    /// `1 / (2 pi theta sin(theta) ln(t2/t1))`. `None` beyond half a turn.
    pub(crate) fn turn<D: Draws + ?Sized>(
        self,
        direction: DVec3,
        draws: &mut D,
    ) -> Option<(DVec3, f64)> {
        let (across, angle) = self.step(draws);
        if angle >= std::f64::consts::PI {
            return None;
        }
        let across = across * (libm::sin(angle) / angle);
        let local = DVec3::new(across.x, across.y, libm::cos(angle));
        Some((Frame::from_z(direction).to_world(local).normalize(), angle))
    }
}
