//! A scene ready for rays.

mod build;
mod content;
mod endpoint;
mod error;
mod motion;
mod segment;
mod tangents;

use std::sync::Arc;

use glam::DVec3;
use kaustik_bsdf::Bsdf;
use kaustik_geometry::{Motion, Ray, World};
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::camera::Camera;
use crate::emitter::{AreaSample, DirectSample, EmissionPdf, EmissionSample, Emitters, Reach};
use crate::matter::Matter;
use crate::{Interior, Passed, Vertex};
pub use build::SceneOptions;
pub use error::SceneError;
pub use segment::Segment;

/// Everything a light path needs to know: geometry, materials, emitters, camera. Immutable;
/// shared by reference between threads.
///
/// A scene stands at an instant. Where something [moves](Scene::moves) while the camera's shutter is open,
/// [`Scene::at`] is the same scene at another instant: a handle upon the same parts. All that a light path asks is
/// answered for that instant, so that whoever makes paths takes the scene at the path's time and needs to know no more.
#[derive(Debug)]
pub struct Scene {
    matter: Matter,
    emitters: Arc<Emitters>,
    camera: Camera,
    camera_interior: Interior,
    camera_motion: Option<Arc<Motion>>,
    moves: bool,
    notices: Arc<[String]>,
    material_names: Arc<[String]>,
    center: DVec3,
    radius: f64,
    typical_length: f64,
    image_size: [u32; 2],
    compensates: bool,
    content: [u8; 32],
}

impl Scene {
    #[cfg(test)]
    pub(crate) fn emitters(&self) -> &Emitters {
        &self.emitters
    }

    /// Does anything move while the camera's shutter is open?
    #[inline]
    pub fn moves(&self) -> bool {
        self.moves
    }

    /// The same scene at a time from 0, when the shutter opens, to 1, when it closes.
    #[must_use]
    pub fn at(&self, time: f64) -> Scene {
        let time = time as f32;
        let matter = self.matter.at(time);
        let camera = self.camera_motion.as_ref();
        let camera = camera.and_then(|motion| self.camera.moved(&motion.at(time)));
        let camera = camera.unwrap_or_else(|| self.camera.clone());
        // What moves may come to stand about the camera, or the camera in it.
        let camera_interior = matter.interior_at(camera.position());
        Scene {
            matter,
            emitters: Arc::clone(&self.emitters),
            camera,
            camera_interior,
            camera_motion: self.camera_motion.clone(),
            moves: self.moves,
            notices: Arc::clone(&self.notices),
            material_names: Arc::clone(&self.material_names),
            ..*self
        }
    }

    /// Is this the instant at which it stands? Of what does not move every one is.
    #[inline]
    pub fn stands_at(&self, time: f64) -> bool {
        !self.moves || self.matter.world.time().to_bits() == (time as f32).to_bits()
    }

    /// The name of the material of this index, as a [`Vertex`] has it; `None` where it has none.
    pub fn material_name(&self, index: u32) -> Option<&str> {
        let name = self.material_names.get(index as usize)?;
        (!name.is_empty()).then_some(name)
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Columns and rows of the image that the camera was built for.
    pub fn image_size(&self) -> [u32; 2] {
        self.image_size
    }

    /// Do rough surfaces give back what scatters between their facets ([`SceneOptions::compensation`])?
    pub fn compensates(&self) -> bool {
        self.compensates
    }

    /// A hash (BLAKE3) of all that the scene was compiled from: geometry, images, materials, lights, cameras,
    /// environment, and which camera was chosen; not of the names of scene, instances and images, nor of the size of the image and of
    /// [`compensates`](Self::compensates), which are settings of a render. Two scenes of one hash are else the same scene.
    pub fn content(&self) -> [u8; 32] {
        self.content
    }

    /// The geometry.
    pub fn world(&self) -> &World {
        &self.matter.world
    }

    /// Remarks for the user: what was assumed because the file did not say.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Centre and radius of a sphere around all geometry, wherever it moves.
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// How long the edges of paths are, roughly: the geometric mean of the distances to what the camera sees, when its
    /// shutter opens; the radius of [`bounding_sphere`](Self::bounding_sphere) if that is nothing. Positive and finite.
    #[inline]
    pub fn typical_length(&self) -> f64 {
        self.typical_length
    }

    /// Can anything emit light? Without, every picture is black.
    pub fn has_light(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// Are there lights without extent or at a single direction, which no walk from the camera can run into?
    pub fn has_punctual_lights(&self) -> bool {
        self.emitters.any_punctual()
    }

    /// Are there emissive surfaces, or an environment?
    pub fn has_extended_lights(&self) -> bool {
        self.emitters.any_extended()
    }

    /// The solids around the camera.
    pub fn camera_interior(&self) -> Interior {
        self.camera_interior
    }

    /// Updates `interior` for a walk that passes the surface along `direction` (world).
    #[inline]
    pub fn cross(&self, vertex: &Vertex, direction: DVec3, interior: &mut Interior) {
        if let Some(medium) = self.matter.medium(vertex.material) {
            interior.pass(medium, !vertex.in_front(direction));
        }
    }

    /// The solids beyond a vertex toward `direction`, for a walk that came from `wo` (both world).
    #[inline]
    pub fn interior_toward(
        &self,
        vertex: &Vertex,
        interior: &Interior,
        wo: DVec3,
        direction: DVec3,
    ) -> Interior {
        let mut beyond = *interior;
        if self.matter.material(vertex.material).solid().is_some()
            && vertex.in_front(wo) != vertex.in_front(direction)
        {
            self.cross(vertex, direction, &mut beyond);
        }
        beyond
    }

    /// The scattering function at a vertex that was reached through `interior`, in the frame
    /// of the vertex.
    #[inline]
    pub fn bsdf(&self, vertex: &Vertex, wavelengths: &Wavelengths, interior: &Interior) -> Bsdf {
        let mut bsdf = Bsdf::black();
        self.write_bsdf(vertex, wavelengths, interior, &mut bsdf);
        bsdf
    }

    /// [`Self::bsdf`] into the caller's slot, as [`Self::advance`] writes the vertex.
    #[inline]
    pub fn write_bsdf(
        &self,
        vertex: &Vertex,
        wavelengths: &Wavelengths,
        interior: &Interior,
        bsdf: &mut Bsdf,
    ) {
        self.matter.write_bsdf(vertex, wavelengths, interior, bsdf);
    }

    /// Radiance that the surface itself sends toward `direction` (unit, world).
    #[inline]
    pub fn emitted(
        &self,
        vertex: &Vertex,
        direction: DVec3,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let material = self.matter.material(vertex.material);
        if material.emits_toward(vertex.normal.dot(direction)) {
            self.matter
                .emission(vertex.material, &vertex.surface, wavelengths)
        } else {
            Spectrum::ZERO
        }
    }

    /// Radiance that arrives from infinitely far away, from `direction` (unit, world).
    #[inline]
    pub fn environment(&self, direction: DVec3, wavelengths: &Wavelengths) -> Spectrum {
        match self.emitters.environment() {
            Some(environment) => environment.radiance(direction, wavelengths),
            None => Spectrum::ZERO,
        }
    }

    /// Next-event estimation at `position`: a direction in which an emitter lies, chosen by what it may bring there. `u(i)` gives
    /// coordinate `i` of three (choice, two of the position); what is not needed is not asked for.
    #[inline]
    pub fn sample_direct(
        &self,
        position: DVec3,
        wavelengths: &Wavelengths,
        u: impl FnMut(u32) -> f64,
    ) -> Option<DirectSample> {
        let mut sample = DirectSample::nothing();
        self.write_direct(position, wavelengths, u, &mut sample)
            .then_some(sample)
    }

    /// [`Self::sample_direct`] into the caller's slot; `false` where nothing arrives.
    #[inline]
    pub fn write_direct(
        &self,
        position: DVec3,
        wavelengths: &Wavelengths,
        u: impl FnMut(u32) -> f64,
        sample: &mut DirectSample,
    ) -> bool {
        self.emitters
            .write_direct(&self.matter, position, wavelengths, u, sample)
    }

    /// Density per solid angle at `from` with which [`Self::sample_direct`] finds `vertex`.
    #[inline]
    pub fn direct_pdf(&self, from: DVec3, vertex: &Vertex) -> f64 {
        let to = vertex.position - from;
        let squared = to.length_squared();
        // In the emitter itself, by rounding: squared distance over cosine goes to 0 there.
        if squared <= 0.0 {
            return 0.0;
        }
        let cos = to.dot(vertex.normal) / squared.sqrt();
        (self.emitters).direct_pdf(&self.matter, from, vertex, [squared, cos])
    }

    /// How much more often [`Self::sample_direct`] at `from` chooses the emitter that such an emission starts from than
    /// [`Self::sample_emission`] does: the ratio of its densities to those of [`EmissionPdf`], otherwise the same. 1 where few
    /// emitters stand anywhere, and of what is infinitely far away; where none of its light can come to that point, only the small share
    /// that goes by power alone.
    #[inline]
    pub fn next_event_odds(&self, pdf: &EmissionPdf, from: DVec3) -> f64 {
        self.emitters.odds(pdf.emitter, from)
    }

    /// Density per solid angle with which [`Self::sample_direct`] finds the environment in `direction`.
    #[inline]
    pub fn environment_pdf(&self, direction: DVec3) -> f64 {
        self.emitters.environment_pdf(direction)
    }

    /// The start of a light walk. `u(i)` gives coordinate `i` of five (choice, two of the
    /// position, two of the direction).
    pub fn sample_emission(
        &self,
        wavelengths: &Wavelengths,
        u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        self.emitters.sample_emission(&self.matter, wavelengths, u)
    }

    /// The start of a photon's walk, by the same coordinates. Emitters are chosen nearly in proportion to
    /// their power, so that photons carry nearly the same flux; [`Self::emission_pdf`] knows nothing of it.
    pub fn sample_photon(
        &self,
        wavelengths: &Wavelengths,
        u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        self.emitters.sample_photon(&self.matter, wavelengths, u)
    }

    /// Densities with which [`Self::sample_emission`] would start at a vertex toward `direction` (unit, world);
    /// zero where nothing is emitted there.
    #[inline]
    pub fn emission_pdf(&self, vertex: &Vertex, direction: DVec3) -> EmissionPdf {
        self.emitters.surface_pdf(&self.matter, vertex, direction)
    }

    /// The same for light of the environment that arrives from `toward` (unit).
    #[inline]
    pub fn environment_emission_pdf(&self, toward: DVec3) -> EmissionPdf {
        self.emitters.infinity_pdf(toward)
    }

    /// What is left of an emission after the first `distance` (only lights with a `range` fade).
    pub fn fading(&self, emission: &EmissionSample, distance: f64) -> f32 {
        self.emitters.fading(emission, distance)
    }

    /// Radiance from a point on an emitter toward `direction` (unit, world).
    pub fn area_radiance(
        &self,
        area: &AreaSample,
        direction: DVec3,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let cos = area.surface.geometric_normal.as_dvec3().dot(direction);
        if cos > 0.0 || (area.both_sides && cos < 0.0) {
            self.matter
                .covered_emission(area.material, &area.surface, wavelengths)
        } else {
            Spectrum::ZERO
        }
    }

    /// The solids around a point on an emitter, on the side of `direction` (world).
    pub fn area_interior(&self, area: &AreaSample, direction: DVec3) -> Interior {
        self.emitters.area_interior(&self.matter, area, direction)
    }

    /// What of the light on a segment gets past the surfaces between its ends (all or nothing without alpha and smooth
    /// panes), for a ray whose ends are excluded.
    #[inline]
    pub fn visibility(&self, ray: &Ray, interior: &Interior, wavelengths: &Wavelengths) -> Passed {
        self.matter.visibility(ray, interior, wavelengths)
    }

    /// Share of light left by what fills `interior` after `distance`.
    #[inline]
    pub fn transmittance(
        &self,
        interior: &Interior,
        wavelengths: &Wavelengths,
        distance: f64,
    ) -> Spectrum {
        self.matter.transmittance(interior, wavelengths, distance)
    }

    /// The shadow ray from a vertex to what [`Self::sample_direct`] found.
    #[inline]
    pub fn shadow_ray(&self, vertex: &Vertex, sample: &DirectSample) -> Ray {
        match &sample.reach {
            Reach::Surface(point, normal) => Ray::reaching(&vertex.surface, *point, *normal),
            Reach::Point(point) => Ray::towards(&vertex.surface, point.as_vec3()),
            Reach::Infinity => Ray::spawn(&vertex.surface, sample.wi.as_vec3()),
        }
    }
}

#[cfg(test)]
mod tests;
