//! Geometry with its materials: what a ray can meet.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use kaustik_bsdf::{Bsdf, Frame};
use kaustik_geometry::{Hit, Ray, Surface, World};
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::material::Material;
use crate::texture::Texture;
use crate::{Interior, Vertex};

mod crossings;
mod passage;
mod sight;

use crossings::Crossings;
pub(crate) use passage::Passage;

/// The world at an instant and what it is made of.
#[derive(Debug)]
pub(crate) struct Matter {
    pub(crate) world: World,
    pub(crate) materials: Arc<[Material]>,
    pub(crate) textures: Arc<[Texture]>,
    /// Material of each instance.
    pub(crate) material_of: Arc<[u32]>,
    /// Can any ray pass any surface because of its alpha?
    pub(crate) has_alpha: bool,
    /// Can any ray pass any surface because that is a smooth pane?
    pub(crate) has_panes: bool,
    /// Does any material bound a solid?
    pub(crate) has_solids: bool,
}

impl Matter {
    /// The same at another time.
    pub(crate) fn at(&self, time: f32) -> Matter {
        Matter {
            world: self.world.at(time),
            materials: Arc::clone(&self.materials),
            textures: Arc::clone(&self.textures),
            material_of: Arc::clone(&self.material_of),
            ..*self
        }
    }

    #[inline]
    pub(crate) fn material(&self, index: u32) -> &Material {
        &self.materials[index as usize]
    }

    /// What a material's surfaces are filled with, if they bound a solid.
    #[inline]
    pub(crate) fn medium(&self, material: u32) -> Option<u32> {
        self.material(material).solid().map(|solid| solid.medium)
    }

    /// The surface that a ray met, with its shading frame.
    #[inline]
    pub(crate) fn vertex(&self, ray: &Ray, hit: &Hit, vertex: &mut Vertex) {
        let surface = &mut vertex.surface;
        let [position, geometric, shading] = self.world.write_surface(ray, hit, surface);
        vertex.material = self.material_of[hit.instance as usize];
        vertex.position = position.as_dvec3();
        vertex.normal = geometric.as_dvec3();
        self.write_frame(hit, [geometric, shading], vertex);
        vertex.instance = hit.instance;
        vertex.primitive = hit.primitive;
    }

    /// The frame about the shading normal, normal texture applied. A normal that points to the
    /// other side than the geometry's is turned (interpolated) or left out (from a texture).
    #[inline(always)]
    fn write_frame(&self, hit: &Hit, [geometric, shading]: [Vec3; 2], vertex: &mut Vertex) {
        let mut normal = shading;
        if normal.dot(geometric) < 0.0 {
            normal = -normal;
        }
        // First, though it may be in vain: a frame from two branches would be copied.
        vertex.frame = Frame::from_z(normal.as_dvec3());
        if self.material(vertex.material).needs_tangent() {
            vertex.frame = self.bent_frame(hit, &vertex.surface, vertex.material, normal);
        }
    }

    #[inline(never)]
    fn bent_frame(&self, hit: &Hit, surface: &Surface, material: u32, normal: Vec3) -> Frame {
        let material = self.material(material);
        let Some(tangent) = (self.world).tangent(hit, normal, &material.unwrapping()) else {
            return Frame::from_z(normal.as_dvec3());
        };
        let frame = Frame::from_z_x(normal.as_dvec3(), tangent.truncate().as_dvec3());
        let bitangent = frame.y * f64::from(tangent.w);
        let along = if material.is_brushed() {
            let [cos, sin] = material.brush_direction(&self.textures, surface);
            frame.x * cos + bitangent * sin
        } else {
            frame.x
        };
        let Some([x, y, z]) = material.tangent_normal(&self.textures, surface) else {
            return Frame::from_z_x(frame.z, along);
        };
        let bent = frame.x * f64::from(x) + bitangent * f64::from(y) + frame.z * f64::from(z);
        match bent.try_normalize() {
            Some(bent) if bent.dot(surface.geometric_normal.as_dvec3()) > 0.0 => {
                Frame::from_z_x(bent, along)
            }
            _ => Frame::from_z_x(frame.z, along),
        }
    }

    /// The scattering function at a vertex reached through `interior`, into the caller's slot.
    #[inline]
    pub(crate) fn write_bsdf(
        &self,
        vertex: &Vertex,
        wavelengths: &Wavelengths,
        interior: &Interior,
        bsdf: &mut Bsdf,
    ) {
        let material = self.material(vertex.material);
        let around = || {
            if interior.is_vacuum() {
                return Spectrum::ONE;
            }
            let around = match self.medium(vertex.material) {
                Some(medium) => interior.without(medium),
                None => *interior,
            };
            self.dominant(&around)
                .map_or(Spectrum::ONE, |solid| self.material(solid).ior(wavelengths))
        };
        if material.has_coat_normal() {
            let normal = self.coat_normal(vertex);
            let surface = &vertex.surface;
            *bsdf = material.varnished(&self.textures, surface, wavelengths, around(), normal);
            return;
        }
        material.write_bsdf(&self.textures, &vertex.surface, wavelengths, around, bsdf);
    }

    /// The varnish's own normal in the frame of a vertex, or rather in that frame with its z towards the side
    /// that is seen, as varnish is on both. Without a texture it is the mesh's normal, whatever is bent
    /// below. `None` where it faces away from the surface, as with other normal maps.
    #[inline(never)]
    fn coat_normal(&self, vertex: &Vertex) -> Option<DVec3> {
        let material = self.material(vertex.material);
        let surface = &vertex.surface;
        let [x, y, z] = material
            .coat_normal(&self.textures, surface)?
            .map(f64::from);
        let mut normal = surface.shading_normal;
        if normal.dot(surface.geometric_normal) < 0.0 {
            normal = -normal;
        }
        let bent = if x.abs().max(y.abs()) <= 0.0 {
            // Nothing is bent, and there may be no tangent.
            normal.as_dvec3()
        } else {
            let unwrapping = material.coat_unwrapping();
            let tangent = (self.world).tangent(&self.hit_of(vertex), normal, &unwrapping)?;
            let frame = Frame::from_z_x(normal.as_dvec3(), tangent.truncate().as_dvec3());
            let bitangent = frame.y * f64::from(tangent.w);
            (frame.x * x + bitangent * y + frame.z * z).try_normalize()?
        };
        let local = vertex.frame.to_local(bent);
        (bent.dot(vertex.normal) > 0.0 && local.z > 1e-3).then_some(local)
    }

    /// The hit that a vertex was, by where it lies in its triangle.
    fn hit_of(&self, vertex: &Vertex) -> Hit {
        let corners = self.world.triangle(vertex.instance, vertex.primitive);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (s, t, p) = (b - a, c - a, vertex.position - a);
        let normal = s.cross(t);
        let squared = normal.length_squared();
        let weight = |along: DVec3| {
            let weight = along.dot(normal) / squared;
            if weight.is_finite() {
                weight.clamp(0.0, 1.0) as f32
            } else {
                0.0
            }
        };
        Hit {
            t: 0.0,
            u: weight(p.cross(t)),
            v: weight(s.cross(p)),
            instance: vertex.instance,
            primitive: vertex.primitive,
        }
    }

    /// Emitted radiance of a material at a surface point; the side is the caller's matter.
    #[inline]
    pub(crate) fn emission(
        &self,
        material: u32,
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        self.material(material)
            .emission(&self.textures, surface, wavelengths)
    }

    /// What an emitter sends out at a point that was chosen and not met: a ray would meet a partly
    /// transparent one by chance only, so here the chance is a factor.
    #[inline]
    pub(crate) fn covered_emission(
        &self,
        material: u32,
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        self.emission(material, surface, wavelengths) * self.coverage(material, surface)
    }

    /// The share of a surface that is there, at a point of a surface that was chosen and not met.
    pub(crate) fn coverage(&self, material: u32, surface: &Surface) -> f32 {
        let material = self.material(material);
        if !material.has_alpha() {
            return 1.0;
        }
        let uv = |set: u8| surface.uv[usize::from(set)];
        material.opacity(&self.textures, uv, surface.color[3])
    }

    /// The solid that fills a point within these.
    #[inline]
    pub(crate) fn dominant(&self, interior: &Interior) -> Option<u32> {
        interior.dominant(|solid| {
            self.material(solid)
                .solid()
                .map_or(i32::MIN, |s| s.priority)
        })
    }

    /// Is the interface of this material hidden from a ray that meets its front or its back? It is visible where its own
    /// solid fills the inner side (none there has a higher priority, and none of the same was entered later) and not the outer side (where
    /// another object of the same material would).
    pub(crate) fn is_overruled(&self, material: u32, front: bool, interior: &Interior) -> bool {
        let Some(medium) = self.medium(material) else {
            return false;
        };
        let outside = match front {
            true => *interior,
            false => interior.without(medium),
        };
        // A back may be met though no front was, as in a mesh with a hole.
        let inside = match front || outside == *interior {
            true => outside.with(medium),
            false => *interior,
        };
        outside.times(medium) > 0 || self.dominant(&inside) != Some(medium)
    }

    /// Share of light left after a segment through what fills `interior`.
    #[inline]
    pub(crate) fn transmittance(
        &self,
        interior: &Interior,
        wavelengths: &Wavelengths,
        distance: f64,
    ) -> Spectrum {
        if interior.is_vacuum() {
            return Spectrum::ONE;
        }
        match self
            .dominant(interior)
            .and_then(|solid| self.material(solid).solid())
        {
            Some(solid) if solid.absorbs() => solid.transmittance(wavelengths, distance),
            _ => Spectrum::ONE,
        }
    }

    /// The solids around a point: those of which a ray from there meets more back sides than
    /// front sides. A few directions vote, because a ray may graze an edge.
    pub(crate) fn interior_at(&self, point: DVec3) -> Interior {
        if !self.has_solids {
            return Interior::VACUUM;
        }
        const DIRECTIONS: [DVec3; 3] = [
            DVec3::new(0.267_261, 0.534_522, 0.801_784),
            DVec3::new(-0.666_667, 0.333_333, -0.666_666),
            DVec3::new(0.408_248, -0.816_497, 0.408_249),
        ];
        let [first, second, third] = DIRECTIONS;
        let vote = self.interior_along(point, second);
        if vote == self.interior_along(point, third) {
            vote
        } else {
            self.interior_along(point, first)
        }
    }

    fn interior_along(&self, point: DVec3, direction: DVec3) -> Interior {
        let ray = Ray::new(point.as_vec3(), direction.as_vec3());
        let mut crossings = Crossings::default();
        // One walk, in whatever order, that nothing ends: from hit to hit, each would begin anew.
        self.world.occluded_filtered(&ray, |hit| {
            let material = self.material_of[hit.instance as usize];
            if let Some(medium) = self.medium(material) {
                let leaves = !self.world.surface(&ray, hit).front;
                crossings.add(medium, leaves, hit);
            }
            false
        });
        crossings.interior()
    }
}
