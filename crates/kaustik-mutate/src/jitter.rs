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

#[cfg(test)]
mod tests {
    use kaustik_mcmc::{Uniforms, generator};

    use super::*;

    const RADII: Radii = Radii {
        least: 0.01,
        most: 2.0,
    };

    /// What these two random numbers make.
    fn with<T>(u: DVec2, make: impl FnOnce(&mut dyn Draws) -> T) -> T {
        let mut rest = u.to_array().into_iter();
        make(&mut Uniforms(move || rest.next().expect("two numbers")))
    }

    /// Area that a map makes of that of its two numbers, by central differences.
    fn stretch(map: impl Fn(DVec2) -> DVec3, u: DVec2) -> f64 {
        const STEP: f64 = 1e-6;
        let along = |axis: DVec2| (map(u + axis * STEP) - map(u - axis * STEP)) / (2.0 * STEP);
        along(DVec2::X).cross(along(DVec2::Y)).length()
    }

    /// The densities that the perturbations' ratios are made of: `1 / (2 pi r^2 ln(r2/r1))` in the plane,
    /// `1 / (2 pi theta sin(theta) ln(t2/t1))` per solid angle.
    #[test]
    fn densities_are_those_of_the_maps() {
        let logarithm = libm::log(RADII.most / RADII.least);
        let mut rng = generator(3, 0);
        for _ in 0..1000 {
            let u = DVec2::new(rng.uniform(), rng.uniform())
                .clamp(DVec2::splat(0.01), DVec2::splat(0.99));
            let size = with(u, |draws| RADII.step(draws).1);
            let plane = stretch(|u| with(u, |draws| RADII.step(draws).0).extend(0.0), u);
            let density = 1.0 / (TAU * size * size * logarithm);
            assert!(
                (density * plane - 1.0).abs() < 1e-5,
                "{u}: {density} {plane}"
            );
            let z = DVec3::new(
                rng.uniform() - 0.5,
                rng.uniform() - 0.5,
                rng.uniform() - 0.5,
            )
            .normalize();
            let turn = |u| with(u, |draws| RADII.turn(z, draws)).expect("less than half a turn");
            let (direction, angle) = turn(u);
            assert!((direction.dot(z).acos() - angle).abs() < 1e-6 && RADII.holds(angle));
            let sphere = stretch(|u| turn(u).0, u);
            let density = 1.0 / (TAU * angle * libm::sin(angle) * logarithm);
            assert!(
                (density * sphere - 1.0).abs() < 1e-5,
                "{u}: {density} {sphere}"
            );
        }
    }

    #[test]
    fn more_than_half_a_turn_is_none() {
        let wide = Radii {
            least: 0.1,
            most: 10.0,
        };
        let beyond = with(DVec2::new(0.0, 0.3), |draws| wide.turn(DVec3::Z, draws));
        assert!(beyond.is_none());
    }
}
