//! From the lights to wherever light lands.

use glam::{DVec3, Vec3};
use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::Sheet;
use crate::walk::Walk;

/// Light that arrives at a point.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// World position.
    pub position: Vec3,
    /// Unit geometric normal of the surface's front.
    pub normal: Vec3,
    /// Unit direction to where it came from (world).
    pub wi: DVec3,
    /// Flux divided by the sampling density, at the wavelengths of the iteration. Averaged over uniform
    /// coordinates, the sum over the photons of a path is the flux that arrives, including the part that
    /// passes through partly transparent surfaces.
    pub power: Spectrum,
    /// Edges from the light.
    pub edges: u32,
    /// Has refracted where the index depends on the wavelength: the hero counts alone.
    pub dispersive: bool,
    /// Where it lies.
    pub sheet: Sheet,
}

impl Photon {
    /// A flux belongs to the area where it lands, scattering to the shading normal of where it counts: the quotient of
    /// that cosine and the photon's own.
    #[inline]
    pub(super) fn per_cosine(&self, shading: f64) -> f32 {
        (shading / self.normal.as_dvec3().dot(self.wi)).abs() as f32
    }

    /// The geometric normal on the side that it met.
    #[inline]
    pub(super) fn met_normal(&self) -> Vec3 {
        match self.normal.as_dvec3().dot(self.wi) < 0.0 {
            true => -self.normal,
            false => self.normal,
        }
    }
}

/// The photons of one light path. The buffer is reused from path to path.
#[derive(Clone, Debug, Default)]
pub struct PhotonPath {
    photons: Vec<Photon>,
    nonfinite: u32,
}

impl PhotonPath {
    /// The photons, in the order of the walk.
    #[inline]
    pub fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// How many photons were left out because their power was not finite or negative (a fault).
    #[inline]
    pub fn nonfinite(&self) -> u32 {
        self.nonfinite
    }
}

/// Walks from the emitters that leave photons where they scatter.
///
/// Roulette goes by the albedo, averaged over the wavelengths: what survives carries what it began with, so that
/// fluxes stay near constant, as G Eq. 5 assumes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonTracing {
    /// Longest whole path in edges, the camera's included.
    pub max_edges: u32,
}

impl PhotonTracing {
    /// Follows the light path of `u` (stream [`Light`](Stream::Light) and
    /// [`Transparency`](Stream::Transparency)) into `out`, which is cleared first.
    pub fn build(
        &self,
        scene: &Scene,
        wavelengths: &Wavelengths,
        u: &mut dyn Coordinates,
        out: &mut PhotonPath,
    ) {
        out.photons.clear();
        out.nonfinite = 0;
        let emission = scene.sample_photon(wavelengths, |i| u.get(Stream::Light, i));
        let Some(emission) = emission else { return };
        let mut walk = Walk::from_emitter(&emission, emission.weight, wavelengths);
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.edges + 1 < self.max_edges && !walk.throughput.is_zero() {
            let Some(distance) = walk.advance(scene, u, &mut vertex) else {
                return;
            };
            if walk.edges == 1 {
                walk.throughput *= scene.fading(&emission, distance);
            }
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            if !walk.throughput.is_finite() || walk.throughput.min() < 0.0 {
                out.nonfinite += 1;
                return;
            }
            if !scatter.bsdf.is_delta() {
                out.photons.push(Photon {
                    position: vertex.surface.position,
                    normal: vertex.normal.as_vec3(),
                    wi: -walk.direction,
                    // The camera's walk has met the surface by the same chance, and what arrives scatters, not what stays.
                    power: walk.throughput / scene.opacity(&vertex),
                    edges: walk.edges,
                    dispersive: walk.dispersive,
                    sheet: Sheet::new(scene, &vertex, scatter.bsdf),
                });
            }
            if walk.bounce(scene, &scatter, u).is_none() || !walk.survives_by_albedo(u) {
                return;
            }
        }
    }
}
