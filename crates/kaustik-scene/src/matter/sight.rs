//! What a ray sees: past holes, smooth panes and hidden interfaces.

use kaustik_bsdf::{Bsdf, Passing};
use kaustik_geometry::{Hit, Ray};
use kaustik_spectrum::Wavelengths;

use super::Matter;
use super::passage::{Opening, Passage};
use crate::{Interior, Passed, Vertex};

/// So many transparent surfaces one behind the other, or in one place, let light through; then it is blocked. A bound
/// for senseless scenes: of surfaces in one place each is met by looking at all.
const MOST_LAYERS: usize = 1000;

impl Matter {
    /// Share of the surface that is there at this point, in [0, 1].
    fn opacity(&self, hit: &Hit) -> f32 {
        let material = self.material(self.material_of[hit.instance as usize]);
        if !material.has_alpha() {
            return 1.0;
        }
        let uv = |set: u8| self.world.uv(hit, usize::from(set));
        material.opacity(&self.textures, uv, self.world.color(hit)[3])
    }

    /// What lets light past the surface that a ray within these solids meets.
    fn opening(
        &self,
        ray: &Ray,
        hit: &Hit,
        interior: &Interior,
        wavelengths: &Wavelengths,
    ) -> Opening {
        let opacity = self.opacity(hit);
        let material = self.material(self.material_of[hit.instance as usize]);
        Opening {
            opacity,
            pane: (material.is_pane() && opacity > 0.0)
                .then(|| self.passing(ray, hit, interior, wavelengths)),
        }
    }

    /// What passes a pane.
    #[inline(never)]
    fn passing(
        &self,
        ray: &Ray,
        hit: &Hit,
        interior: &Interior,
        wavelengths: &Wavelengths,
    ) -> Passing {
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        self.vertex(ray, hit, &mut vertex);
        self.write_bsdf(&vertex, wavelengths, interior, &mut bsdf);
        let back = -ray.direction.as_dvec3().normalize();
        bsdf.passing(vertex.frame.to_local(back))
    }

    /// Is nothing there for light? The interface of a solid is there for what keeps count of solids, however clear.
    fn is_cut_out(&self, hit: &Hit) -> bool {
        let material = self.material(self.material_of[hit.instance as usize]);
        material.has_alpha() && material.solid().is_none() && self.opacity(hit) <= 0.0
    }

    /// May light get past any surface without being scattered?
    #[inline]
    pub(crate) fn has_openings(&self) -> bool {
        self.has_alpha || self.has_panes
    }

    /// The first surface that stops the ray, or that `interior` hides. Partly transparent ones and panes
    /// stop it by chance, see [`Passage`].
    #[inline]
    pub(crate) fn intersect(
        &self,
        ray: &Ray,
        interior: &Interior,
        passage: &mut Passage<'_, impl FnOnce() -> f64>,
    ) -> Option<Hit> {
        let hit = self.world.intersect(ray)?;
        if self.has_openings() {
            self.pass(ray, hit, interior, passage)
        } else {
            Some(hit)
        }
    }

    /// The next one on the same ray.
    pub(crate) fn intersect_after(
        &self,
        ray: &Ray,
        hit: &Hit,
        interior: &Interior,
        passage: &mut Passage<'_, impl FnOnce() -> f64>,
    ) -> Option<Hit> {
        let hit = self.world.intersect_after(ray, hit, |_| true)?;
        self.pass(ray, hit, interior, passage)
    }

    #[cold]
    fn pass(
        &self,
        ray: &Ray,
        mut hit: Hit,
        interior: &Interior,
        passage: &mut Passage<'_, impl FnOnce() -> f64>,
    ) -> Option<Hit> {
        for _ in 0..MOST_LAYERS {
            // What is not there has no alpha; the walk must still notice that it crosses it.
            let hidden = self.hidden_side(ray, &hit, interior).is_some();
            if hidden {
                return Some(hit);
            }
            let opening = self.opening(ray, &hit, interior, passage.wavelengths);
            if passage.is_stopped_by(&opening) {
                return Some(hit);
            }
            // One more walk for all cut-outs of a leaf, not one for each.
            hit = (self.world).intersect_after(ray, &hit, |next| !self.is_cut_out(next))?;
        }
        Some(hit)
    }

    /// What passes a segment. Interfaces that are hidden there are none.
    #[inline]
    pub(crate) fn visibility(
        &self,
        ray: &Ray,
        interior: &Interior,
        wavelengths: &Wavelengths,
    ) -> Passed {
        if !interior.is_vacuum() {
            return self.visibility_within(ray, *interior, wavelengths);
        }
        if self.has_openings() {
            return self.filtered_visibility(ray, wavelengths);
        }
        match self.world.occluded(ray) {
            true => Passed::NOTHING,
            false => Passed::ALL,
        }
    }

    /// Outside of all solids nothing is hidden, and surfaces may come in any order.
    fn filtered_visibility(&self, ray: &Ray, wavelengths: &Wavelengths) -> Passed {
        let (mut passed, mut layers) = (Passed::ALL, 0);
        let blocked = self.world.occluded_filtered(ray, |hit| {
            let opening = self.opening(ray, hit, &Interior::VACUUM, wavelengths);
            passed = opening.dim(passed);
            layers += 1;
            passed.is_nothing() || layers > MOST_LAYERS
        });
        if blocked { Passed::NOTHING } else { passed }
    }

    /// Within solids surface comes after surface: which of them end a solid depends on all before.
    fn visibility_within(
        &self,
        ray: &Ray,
        mut interior: Interior,
        wavelengths: &Wavelengths,
    ) -> Passed {
        let mut passed = Passed::ALL;
        let mut next = self.world.intersect(ray);
        for _ in 0..MOST_LAYERS {
            let Some(hit) = next else {
                return passed;
            };
            match self.hidden_side(ray, &hit, &interior) {
                Some((medium, front)) => interior.pass(medium, front),
                None => {
                    let opening = self.opening(ray, &hit, &interior, wavelengths);
                    passed = opening.dim(passed);
                    if passed.is_nothing() {
                        return Passed::NOTHING;
                    }
                }
            }
            next = (self.world).intersect_after(ray, &hit, |next| !self.is_cut_out(next));
        }
        if next.is_none() {
            passed
        } else {
            Passed::NOTHING
        }
    }

    /// Where the interface that a ray meets is hidden: of what it is, and whether the ray meets its front.
    fn hidden_side(&self, ray: &Ray, hit: &Hit, interior: &Interior) -> Option<(u32, bool)> {
        // Nearly always there is nothing to ask.
        if interior.is_vacuum() {
            return None;
        }
        let material = self.material_of[hit.instance as usize];
        let medium = self.medium(material)?;
        let front = self.world.surface(ray, hit).front;
        let hidden = self.is_overruled(material, front, interior);
        hidden.then_some((medium, front))
    }
}
