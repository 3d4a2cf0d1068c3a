use glam::DVec2;
use kaustik_spectrum::{Spectrum, Wavelengths, Xyz};

/// Light that one path, or one bundle of paths, brings to one point of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Point of the image: the unit square over the whole image, x to the right, y down.
    pub raster: DVec2,
    /// What a path tracer would return for a pixel there: radiance over density.
    pub xyz: Xyz,
}

/// All that one point of the primary sample space contributes: `F*` of Kelemen sec. 2.
///
/// Only finite values are kept; others are counted. The buffers are reused from path to path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contributions {
    splats: Vec<Splat>,
    nonfinite: u32,
}

impl Contributions {
    /// Forgets everything but the memory.
    #[inline]
    pub fn clear(&mut self) {
        self.splats.clear();
        self.nonfinite = 0;
    }

    /// Adds a splat; black ones are left out, values that are not finite or negative are counted.
    #[inline]
    pub fn push(&mut self, raster: DVec2, xyz: Xyz) {
        let sum = xyz.sum();
        if sum > 0.0 && sum.is_finite() && xyz.0.iter().all(|&v| v >= 0.0) {
            self.splats.push(Splat { raster, xyz });
        } else if sum != 0.0 {
            self.nonfinite += 1;
        }
    }

    /// The splats.
    #[inline]
    pub fn splats(&self) -> &[Splat] {
        &self.splats
    }

    /// How many contributions were not finite (a fault: they are left out).
    #[inline]
    pub fn nonfinite(&self) -> u32 {
        self.nonfinite
    }
}

/// What a walk has gathered for one point of the image, before it becomes a colour.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gathered {
    /// From paths that count with all their wavelengths.
    all: Spectrum,
    /// From paths with a dispersive refraction: their hero counts alone.
    hero: Spectrum,
}

impl Gathered {
    #[inline]
    pub(crate) fn add(&mut self, value: Spectrum, dispersive: bool) {
        if dispersive {
            self.hero += value;
        } else {
            self.all += value;
        }
    }

    #[inline]
    pub(crate) fn to_xyz(self, wavelengths: &Wavelengths) -> Xyz {
        let all = wavelengths.to_xyz(self.all);
        if self.hero.hero() == 0.0 {
            return all;
        }
        all + wavelengths.hero_to_xyz(self.hero)
    }
}
