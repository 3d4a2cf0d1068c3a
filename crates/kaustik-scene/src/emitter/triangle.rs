//! One emissive triangle.

use glam::{DVec3, Vec3};
use kaustik_geometry::{Surface, World};
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::matter::Matter;

#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleEmitter {
    pub(super) instance: u32,
    pub(super) primitive: u32,
    pub(super) material: u32,
    /// One over the area in the world; negative where it moves, and the area with it.
    still_inverse_area: f64,
    /// What a look-up needs when the emission does not vary: no attributes are interpolated. Only of what stands still.
    pub(super) plain: Option<Plane>,
}

/// A triangle in the world: a corner, the edges from it, the unit front normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: Vec3,
}

impl Plane {
    pub(super) fn of(matter: &Matter, instance: u32, primitive: u32) -> Self {
        let [a, b, c] = matter
            .world
            .triangle(instance, primitive)
            .map(Vec3::as_dvec3);
        let middle = matter.world.surface_at(instance, primitive, 0.3, 0.3);
        Self {
            corner: a,
            edges: [b - a, c - a],
            normal: middle.geometric_normal,
        }
    }
}

impl Plane {
    #[inline]
    fn point(&self, [a, b]: [f64; 2]) -> Vec3 {
        (self.corner + self.edges[0] * a + self.edges[1] * b).as_vec3()
    }
}

impl TriangleEmitter {
    /// A triangle of an instance with this material.
    pub(super) fn new(matter: &Matter, [instance, primitive]: [u32; 2], material: u32) -> Self {
        let moving = matter.world.is_moving(instance);
        let of = matter.material(material);
        let plain = of.emits_evenly() && !of.has_alpha() && !moving;
        Self {
            instance,
            primitive,
            material,
            still_inverse_area: if moving {
                -1.0
            } else {
                inverse_area(&matter.world, instance, primitive)
            },
            plain: plain.then(|| Plane::of(matter, instance, primitive)),
        }
    }

    /// One over the area in the world as it stands now; 0 of a triangle without area and of an instance that is flat just then,
    /// which no ray finds.
    #[inline]
    pub(super) fn inverse_area(&self, matter: &Matter) -> f64 {
        if self.still_inverse_area >= 0.0 {
            self.still_inverse_area
        } else if matter.world.is_flat(self.instance) {
            0.0
        } else {
            inverse_area(&matter.world, self.instance, self.primitive)
        }
    }

    /// The surface at barycentric weights of the second and third corner.
    pub(super) fn surface(&self, matter: &Matter, weights: [f64; 2]) -> Surface {
        match &self.plain {
            Some(plane) => Surface::bare(plane.point(weights), plane.normal),
            None => self.whole_surface(matter, weights),
        }
    }

    fn whole_surface(&self, matter: &Matter, [a, b]: [f64; 2]) -> Surface {
        let world = &matter.world;
        world.surface_at(self.instance, self.primitive, a as f32, b as f32)
    }

    /// The point and the unit front normal there, and the whole surface where the emission asks for it.
    #[inline]
    pub(super) fn point(
        &self,
        matter: &Matter,
        weights: [f64; 2],
    ) -> (Vec3, Vec3, Option<Surface>) {
        match &self.plain {
            Some(plane) => (plane.point(weights), plane.normal, None),
            None => {
                let surface = self.whole_surface(matter, weights);
                (surface.position, surface.geometric_normal, Some(surface))
            }
        }
    }

    /// What it sends out there; the side is the caller's matter.
    #[inline]
    pub(super) fn radiance(
        &self,
        matter: &Matter,
        surface: Option<&Surface>,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        match surface {
            Some(surface) => matter.covered_emission(self.material, surface, wavelengths),
            None => matter.material(self.material).even_emission(wavelengths),
        }
    }
}

fn inverse_area(world: &World, instance: u32, primitive: u32) -> f64 {
    let area = world.triangle_area(instance, primitive);
    if area > 0.0 { 1.0 / area } else { 0.0 }
}

/// The area, of what moves in the mean over a few times: for the choice among emitters, which any positive numbers
/// serve.
pub(super) fn typical_area(world: &World, instance: u32, primitive: u32) -> f64 {
    if !world.is_moving(instance) {
        return world.triangle_area(instance, primitive);
    }
    const TIMES: u32 = 5;
    let at = |k| world.at((k as f32 + 0.5) / TIMES as f32);
    let areas = (0..TIMES).map(|k| at(k).triangle_area(instance, primitive));
    areas.sum::<f64>() / f64::from(TIMES)
}
