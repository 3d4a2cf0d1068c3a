#[cfg(feature = "serde")]
mod serial;

use glam::DVec2;
use kaustik_spectrum::{Spectrum, Wavelengths, Xyz};

use crate::trace::{Event, note};
use crate::{Class, RayCounts, ScalarTarget};

/// Light that one path, or all paths of one class, bring to one point of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Point of the image: the unit square over the whole image, x to the right, y down.
    pub raster: DVec2,
    /// What a path tracer would return for a pixel there: radiance over density.
    pub xyz: Xyz,
    /// The kind of path.
    pub class: Class,
}

/// All that one point of the primary sample space contributes: `F*` of Kelemen sec. 2.
///
/// What falls on the camera walk's own raster point is one splat for each class; every path that
/// reaches the image elsewhere (`t <= 1`) is a splat of its own. Only finite values are kept; others
/// are counted. The buffers are reused from path to path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contributions {
    splats: Vec<Splat>,
    largest: Largest,
    nonfinite: u32,
    rays: RayCounts,
}

/// The largest scalars of a single `C_{s,t}`: splats hold sums of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Largest {
    xyz: f32,
    luminance: f32,
}

impl Largest {
    #[inline]
    fn see(&mut self, xyz: Xyz) {
        self.xyz = self.xyz.max(ScalarTarget::Xyz.of(xyz) as f32);
        self.luminance = self.luminance.max(ScalarTarget::Luminance.of(xyz) as f32);
    }

    #[inline]
    fn join(&mut self, other: Self) {
        self.xyz = self.xyz.max(other.xyz);
        self.luminance = self.luminance.max(other.luminance);
    }
}

/// What a value is good for.
enum Quality {
    Light,
    Black,
    Fault,
}

#[inline]
fn quality(xyz: Xyz) -> Quality {
    let sum = xyz.sum();
    if sum > 0.0 && sum.is_finite() && xyz.0.iter().all(|&v| v >= 0.0) {
        Quality::Light
    } else if sum != 0.0 {
        Quality::Fault
    } else {
        Quality::Black
    }
}

/// The same, of a splat, and whoever looks is told.
#[inline]
fn told(raster: DVec2, xyz: Xyz, class: Class) -> Quality {
    let quality = quality(xyz);
    note(|| Event::Splat {
        raster,
        xyz,
        class,
        kept: !matches!(quality, Quality::Fault),
    });
    quality
}

impl Contributions {
    /// Forgets everything but the memory.
    #[inline]
    pub fn clear(&mut self) {
        note(|| Event::Begin);
        self.splats.clear();
        self.largest = Largest::default();
        self.nonfinite = 0;
        self.rays = RayCounts::default();
    }

    /// Adds a single weighted `C_{s,t}` as a splat; black ones are left out, values that are not
    /// finite or negative are counted.
    #[inline]
    pub fn push(&mut self, raster: DVec2, xyz: Xyz, class: Class) {
        match told(raster, xyz, class) {
            Quality::Light => {
                self.largest.see(xyz);
                self.splats.push(Splat { raster, xyz, class });
            }
            Quality::Black => {}
            Quality::Fault => self.nonfinite += 1,
        }
    }

    /// Adds what was gathered for one raster point: a splat for each class.
    #[inline]
    pub(crate) fn merge(&mut self, raster: DVec2, gathered: &Gathered<'_>) {
        for class in Class::ALL {
            if gathered.used & (1 << class as u8) == 0 {
                continue;
            }
            let xyz = gathered.sum(class);
            match told(raster, xyz, class) {
                Quality::Light => self.splats.push(Splat { raster, xyz, class }),
                Quality::Black => {}
                Quality::Fault => self.nonfinite += 1,
            }
        }
        if let Some(largest) = gathered.largest {
            self.largest.join(largest);
        }
        self.rays += gathered.rays;
    }

    /// Counts a shadow ray.
    #[inline]
    pub(crate) fn count_shadow(&mut self) {
        self.rays.any += 1;
    }

    /// Counts the rays of a walk that has ended.
    #[inline]
    pub(crate) fn count_walk(&mut self, edges: u32) {
        self.rays.closest += u64::from(edges);
    }

    /// The splats.
    #[inline]
    pub fn splats(&self) -> &[Splat] {
        &self.splats
    }

    /// Sums of the scalar of the splats of each [`Class`], by `class as usize`, each >= 0: `L_0` to `L_5` of RELT eqs. 12 to
    /// 17, of which `L_0` is split into [`Class::L0`] and [`Class::L0Joined`].
    #[inline]
    pub fn by_class(&self, target: ScalarTarget) -> [f64; Class::COUNT] {
        let mut sums = [0.0; Class::COUNT];
        for splat in &self.splats {
            sums[splat.class as usize] += target.of(splat.xyz);
        }
        sums
    }

    /// The largest scalar of a single weighted `C_{s,t}` (Kelemen sec. 2): not of a splat, which may hold
    /// the sum of many. Kept only if [`BuilderSettings::track_largest`](crate::BuilderSettings::track_largest)
    /// asks for it.
    #[inline]
    pub fn largest(&self, target: ScalarTarget) -> f64 {
        f64::from(match target {
            ScalarTarget::Xyz => self.largest.xyz,
            ScalarTarget::Luminance => self.largest.luminance,
        })
    }

    /// How many contributions were not finite (a fault: they are left out).
    #[inline]
    pub fn nonfinite(&self) -> u32 {
        self.nonfinite
    }

    /// The rays that the evaluation took.
    #[inline]
    pub fn rays(&self) -> RayCounts {
        self.rays
    }
}

/// The colour of light that a path carries; of a path with a dispersive refraction the hero counts
/// alone.
#[inline]
pub(crate) fn colour(value: Spectrum, dispersive: bool, wavelengths: &Wavelengths) -> Xyz {
    if dispersive {
        wavelengths.hero_to_xyz(value)
    } else {
        wavelengths.to_xyz(value)
    }
}

/// What a walk has gathered for one point of the image, by class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gathered<'w> {
    wavelengths: &'w Wavelengths,
    /// From paths that count with all their wavelengths.
    all: [Spectrum; Class::COUNT],
    /// From paths with a dispersive refraction: their hero counts alone.
    hero: [Spectrum; Class::COUNT],
    /// Classes that something was added to, a bit each.
    used: u8,
    /// `None` where nobody asks for it.
    largest: Option<Largest>,
    rays: RayCounts,
}

impl<'w> Gathered<'w> {
    #[inline]
    pub(crate) fn new(wavelengths: &'w Wavelengths, largest: bool) -> Self {
        Self {
            wavelengths,
            all: [Spectrum::ZERO; Class::COUNT],
            hero: [Spectrum::ZERO; Class::COUNT],
            used: 0,
            largest: largest.then(Largest::default),
            rays: RayCounts::default(),
        }
    }

    /// Counts a shadow ray.
    #[inline]
    pub(crate) fn count_shadow(&mut self) {
        self.rays.any += 1;
    }

    /// Counts the rays of a walk that has ended.
    #[inline]
    pub(crate) fn count_walk(&mut self, edges: u32) {
        self.rays.closest += u64::from(edges);
    }

    /// Adds a single weighted `C_{s,t}`.
    #[inline]
    pub(crate) fn add(&mut self, class: Class, value: Spectrum, dispersive: bool) {
        if let Some(largest) = &mut self.largest {
            let xyz = colour(value, dispersive, self.wavelengths);
            if let Quality::Light = quality(xyz) {
                largest.see(xyz);
            }
        }
        note(|| Event::Light { class, value });
        self.used |= 1 << class as u8;
        if dispersive {
            self.hero[class as usize] += value;
        } else {
            self.all[class as usize] += value;
        }
    }

    /// The colour of a class. Sums become colours once: most paths bring light by one class or two.
    #[inline]
    fn sum(&self, class: Class) -> Xyz {
        let (all, hero) = (self.all[class as usize], self.hero[class as usize]);
        let mut xyz = Xyz::ZERO;
        if !all.is_zero() {
            xyz += self.wavelengths.to_xyz(all);
        }
        if hero.hero() != 0.0 {
            xyz += self.wavelengths.hero_to_xyz(hero);
        }
        xyz
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kaustik_spectrum::WavelengthSampling;

    fn grey(value: f32) -> Xyz {
        Xyz([value; 3])
    }

    #[test]
    fn merged_splats_do_not_hide_the_largest() {
        let wavelengths = Wavelengths::sample(0.3, WavelengthSampling::Hero);
        let mut gathered = Gathered::new(&wavelengths, true);
        for (class, value) in [(Class::L5, 2.0), (Class::L5, 3.0), (Class::L2, 1.0)] {
            gathered.add(class, Spectrum::splat(value), false);
        }
        let unit = wavelengths.to_xyz(Spectrum::ONE);
        let mut out = Contributions::default();
        out.push(DVec2::splat(0.1), unit * 2.5, Class::L4);
        out.merge(DVec2::splat(0.5), &gathered);
        assert_eq!(out.splats().len(), 3);
        for target in [ScalarTarget::Xyz, ScalarTarget::Luminance] {
            let one = target.of(unit);
            let near = |found: f64, wanted: f64| (found / one - wanted).abs() < 1e-5;
            assert!(near(out.largest(target), 3.0));
            let sums = out.by_class(target);
            assert!(near(sums[5], 5.0) && near(sums[2], 1.0) && near(sums[4], 2.5));
            assert!(near(sums.iter().sum(), 8.5));
        }
        out.clear();
        assert_eq!(out, Contributions::default());
    }

    #[test]
    fn faults_are_counted_and_left_out() {
        let wavelengths = Wavelengths::sample(0.3, WavelengthSampling::Hero);
        let mut gathered = Gathered::new(&wavelengths, true);
        gathered.add(Class::L1, Spectrum::splat(f32::NAN), false);
        gathered.add(Class::L5, Spectrum::ONE, true);
        let mut out = Contributions::default();
        out.push(DVec2::ZERO, grey(f32::INFINITY), Class::L4);
        out.push(DVec2::ZERO, grey(-1.0), Class::L4);
        out.push(DVec2::ZERO, grey(0.0), Class::L4);
        out.merge(DVec2::ZERO, &gathered);
        assert_eq!((out.nonfinite(), out.splats().len()), (3, 1));
    }
}
