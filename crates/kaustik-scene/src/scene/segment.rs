use kaustik_geometry::{Hit, Ray};
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::Scene;
use crate::matter::Passage;
use crate::{Interior, Vertex};

/// The way to the next vertex of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Share of light that what fills the space has left over; all of it where the ray leaves the scene.
    pub transmittance: Spectrum,
    /// One over the chance to pass each smooth pane on the way, times the share of light that passes; and one over the
    /// chance to meet the surface, if that is one. 1 without panes: holes stop the same share of rays as of light.
    pub weight: Spectrum,
    /// Length in scene units; infinite where the ray leaves the scene.
    pub distance: f64,
    /// Did it go through a smooth pane?
    pub through_pane: bool,
    /// Did it go through a surface that not all rays and not all light pass: a pane, or one of partial alpha? Where it did
    /// not, [`Scene::visibility`](crate::Scene::visibility) between its ends is 1.
    pub by_chance: bool,
}

impl Segment {
    fn escaping<U: FnOnce() -> f64>(passage: &Passage<'_, U>) -> Self {
        Self {
            transmittance: Spectrum::ONE,
            weight: passage.weight,
            distance: f64::INFINITY,
            through_pane: passage.through_pane,
            by_chance: passage.by_chance,
        }
    }

    /// Does the ray leave the scene?
    #[inline]
    pub fn escapes(&self) -> bool {
        self.distance.is_infinite()
    }

    /// What a walk's throughput is multiplied by.
    #[inline]
    pub fn factor(&self) -> Spectrum {
        self.transmittance * self.weight
    }
}

impl Scene {
    /// Follows a ray to the next surface that counts, through what alpha or priority hides and through smooth panes, and
    /// writes it into `vertex`; `vertex` is not written where the ray leaves the scene ([`Segment::escapes`]). `interior`
    /// is updated where hidden interfaces of solids are crossed. `transparency` gives one number in [0, 1), asked
    /// for at most once.
    ///
    /// The vertex goes into the caller's slot because it is large, and this is the innermost loop.
    #[inline]
    pub fn advance(
        &self,
        ray: &Ray,
        interior: &mut Interior,
        wavelengths: &Wavelengths,
        transparency: impl FnOnce() -> f64,
        vertex: &mut Vertex,
    ) -> Segment {
        let mut passage = Passage::new(wavelengths, transparency);
        let Some(hit) = self.matter.intersect(ray, interior, &mut passage) else {
            return Segment::escaping(&passage);
        };
        self.matter.vertex(ray, &hit, vertex);
        let mut segment = Segment {
            transmittance: Spectrum::ONE,
            weight: passage.weight,
            distance: f64::from(hit.t) * ray.direction.as_dvec3().length(),
            through_pane: passage.through_pane,
            by_chance: passage.by_chance,
        };
        if interior.is_vacuum() {
            return segment;
        }
        segment.transmittance =
            (self.matter).transmittance(interior, wavelengths, segment.distance);
        if !self.is_overruled(ray, vertex, interior) {
            return segment;
        }
        let walk = (vertex, interior);
        self.pass_overruled(ray, hit, segment, walk, &mut passage, wavelengths)
    }

    /// Goes on through interfaces that are hidden by a solid of higher priority, or another object of the
    /// same material. The ray stays the same, so that surfaces which coincide with a hidden one are met.
    #[cold]
    fn pass_overruled(
        &self,
        ray: &Ray,
        mut hit: Hit,
        mut segment: Segment,
        (vertex, interior): (&mut Vertex, &mut Interior),
        passage: &mut Passage<'_, impl FnOnce() -> f64>,
        wavelengths: &Wavelengths,
    ) -> Segment {
        /// A bound for senseless scenes.
        const MOST: usize = 1000;
        let unit = ray.direction.as_dvec3().length();
        for _ in 0..MOST {
            self.cross(vertex, ray.direction.as_dvec3(), interior);
            let Some(next) = (self.matter).intersect_after(ray, &hit, interior, passage) else {
                return Segment::escaping(passage);
            };
            hit = next;
            self.matter.vertex(ray, &hit, vertex);
            let distance = f64::from(hit.t) * unit;
            let further = distance - segment.distance;
            segment.transmittance *= self.matter.transmittance(interior, wavelengths, further);
            segment.distance = distance;
            segment.weight = passage.weight;
            segment.through_pane = passage.through_pane;
            segment.by_chance = passage.by_chance;
            if !self.is_overruled(ray, vertex, interior) {
                return segment;
            }
        }
        Segment::escaping(passage)
    }

    /// Is the interface that a ray met as `vertex` hidden within these solids?
    #[inline]
    fn is_overruled(&self, ray: &Ray, vertex: &Vertex, interior: &Interior) -> bool {
        let front = vertex.in_front(-ray.direction.as_dvec3());
        self.matter.is_overruled(vertex.material, front, interior)
    }
}
