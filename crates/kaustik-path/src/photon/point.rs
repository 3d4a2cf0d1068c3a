//! Where photons are counted.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};
use kaustik_bsdf::{Bsdf, BsdfList, Frame, Lobe, Mode, shading};
use kaustik_scene::Vertex;
use kaustik_spectrum::{Spectrum, Wavelengths, Xyz};

use super::Photon;
use crate::contributions::colour;

/// Normals that differ by more (about 84 degrees) belong to different surfaces.
const LEAST_AGREEMENT: f32 = 0.1;

/// Where photons count: around a point that the camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// World position of the point.
    pub center: Vec3,
    /// In scene units, > 0.
    pub radius: f32,
}

/// A point that the camera sees, but for its [`Disc`].
///
/// There is one a pixel: it takes 64 bytes, and a look at it one line of a cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct MeasurementPoint {
    /// Point of the image: the unit square over the whole image.
    pub raster: DVec2,
    /// What the camera walk carries; times the scattering function where that is constant.
    throughput: Spectrum,
    /// Unit geometric normal of the surface's front.
    pub normal: Vec3,
    /// The shading normal.
    shading: Vec3,
    /// Edges of the walk from the camera.
    pub edges: u32,
    manner: Manner,
}

/// How light leaves toward the eye, and whether the camera walk has refracted where the index depends on the
/// wavelength (the highest bit).
#[derive(Clone, Copy, Debug)]
struct Manner(u32);

/// How light leaves toward the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scattering {
    /// Evenly, from the front or from the back: the value is in the throughput.
    Diffuse { front: bool },
    /// As the entry of a list says; it is not as long as to reach the numbers that stand for the others.
    Listed(u32),
}

impl Manner {
    const DISPERSIVE: u32 = 1 << 31;
    const FRONT: u32 = Self::DISPERSIVE - 1;
    const BACK: u32 = Self::FRONT - 1;

    fn new(scattering: Scattering, dispersive: bool) -> Self {
        let low = match scattering {
            Scattering::Diffuse { front: true } => Self::FRONT,
            Scattering::Diffuse { front: false } => Self::BACK,
            Scattering::Listed(index) => index,
        };
        Self(low | (u32::from(dispersive) << 31))
    }

    #[inline]
    fn scattering(self) -> Scattering {
        match self.0 & !Self::DISPERSIVE {
            Self::FRONT => Scattering::Diffuse { front: true },
            Self::BACK => Scattering::Diffuse { front: false },
            index => Scattering::Listed(index),
        }
    }

    #[inline]
    fn is_dispersive(self) -> bool {
        self.0 & Self::DISPERSIVE != 0
    }
}

/// A scattering function and the direction that it is seen from.
#[derive(Clone, Copy, Debug)]
struct Listed {
    /// Number of the function. It is large, and without a texture the same at all points of a material; with one
    /// most of it is.
    bsdf: u32,
    /// Tangent, bitangent and shading normal. Single precision, as of the point's normals: there may be one a pixel.
    frame: [Vec3; 3],
    /// Local direction toward the eye.
    wo: Vec3,
}

/// What a walk knows of the vertex that it ends in.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) vertex: &'a Vertex,
    /// The wide part of it.
    pub(super) bsdf: Bsdf,
    pub(super) wo: DVec3,
    pub(super) throughput: Spectrum,
    pub(super) dispersive: bool,
    pub(super) edges: u32,
    pub(super) raster: DVec2,
    pub(super) radius: f64,
}

/// The points of one iteration. Memory is reused.
#[derive(Clone, Debug, Default)]
pub struct MeasurementPoints {
    /// Apart from the rest: a lookup goes through many of them for each point that it finds.
    discs: Vec<Disc>,
    points: Vec<MeasurementPoint>,
    listed: Vec<Listed>,
    functions: BsdfList,
}

impl MeasurementPoints {
    /// Forgets everything but the memory.
    pub fn clear(&mut self) {
        self.discs.clear();
        self.points.clear();
        self.listed.clear();
        self.functions.clear();
    }

    /// Makes room for so many points in all, and no more than that.
    pub fn reserve(&mut self, count: usize) {
        let more = count.saturating_sub(self.points.len());
        self.discs.reserve_exact(more);
        self.points.reserve_exact(more);
    }

    /// The discs of the points, in the same order.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// The points, in the order in which they were made.
    pub fn points(&self) -> &[MeasurementPoint] {
        &self.points
    }

    /// Takes all points of another list, after its own.
    pub fn append(&mut self, other: &Self) {
        let first = self.listed.len() as u32;
        let function = self.functions.append(&other.functions);
        self.listed.extend(other.listed.iter().map(|listed| Listed {
            bsdf: function + listed.bsdf,
            ..*listed
        }));
        self.discs.extend_from_slice(&other.discs);
        self.points.extend(other.points.iter().map(|point| {
            let mut point = *point;
            if let Scattering::Listed(index) = point.manner.scattering() {
                let dispersive = point.manner.is_dispersive();
                point.manner = Manner::new(Scattering::Listed(first + index), dispersive);
            }
            point
        }));
    }

    /// Adds a point; one where nothing can be measured (no radius, no light to carry) is left out.
    pub(super) fn push(&mut self, seen: Seen<'_>) {
        let Seen { vertex, wo, .. } = seen;
        let ng = vertex.local_normal();
        let radius = seen.radius as f32;
        let usable = radius.is_normal()
            && radius > 0.0
            && seen.throughput.is_finite()
            && wo.z * wo.dot(ng) > 0.0;
        if !usable {
            return;
        }
        let mut throughput = seen.throughput;
        let scattering = if let Bsdf::Lambertian(_) = seen.bsdf {
            // The same in all directions on this side: the value along the normal will do.
            let up = DVec3::new(0.0, 0.0, wo.z.signum());
            throughput *= seen.bsdf.eval(wo, up, Mode::Radiance);
            Scattering::Diffuse { front: wo.z > 0.0 }
        } else {
            let bsdf = self.functions.number(&seen.bsdf);
            self.listed.push(Listed {
                bsdf,
                frame: [vertex.frame.x, vertex.frame.y, vertex.frame.z].map(|axis| axis.as_vec3()),
                wo: wo.as_vec3(),
            });
            Scattering::Listed(self.listed.len() as u32 - 1)
        };
        self.discs.push(Disc {
            center: vertex.surface.position,
            radius,
        });
        self.points.push(MeasurementPoint {
            raster: seen.raster,
            throughput,
            normal: vertex.normal.as_vec3(),
            shading: vertex.frame.z.as_vec3(),
            edges: seen.edges,
            manner: Manner::new(scattering, seen.dispersive),
        });
    }

    /// What a photon brings to a point, if it is within its disc (G Eq. 2): flux times scattering function times what
    /// the camera walk carries, over the disc's area, for a photon path that is drawn with density 1. Negative or not
    /// finite is a fault for the caller to count.
    #[inline]
    pub fn contribution(&self, index: usize, photon: &Photon, wavelengths: &Wavelengths) -> Xyz {
        let point = &self.points[index];
        let kernel = 1.0 / self.discs[index].area();
        let (f, dispersive) = self.scattered(point, photon);
        let value = point.throughput * photon.power * f * (kernel as f32);
        colour(
            value,
            dispersive || point.manner.is_dispersive() || photon.dispersive,
            wavelengths,
        )
    }

    /// How strongly a photon counts at a point, apart from the size of its disc and what the camera walk
    /// carries: flux times scattering function, a mean over wavelengths. A number that is negative or not
    /// finite is a fault, and counts as 0.
    #[inline]
    pub fn response(&self, index: usize, photon: &Photon) -> f64 {
        let (f, _) = self.scattered(&self.points[index], photon);
        let mean = f64::from((photon.power * f).mean());
        if mean.is_finite() { mean.max(0.0) } else { 0.0 }
    }

    /// The scattering function toward the eye; has it told wavelengths apart?
    #[inline]
    fn scattered(&self, point: &MeasurementPoint, photon: &Photon) -> (Spectrum, bool) {
        match point.manner.scattering() {
            Scattering::Diffuse { front } => (point.diffuse(photon, front), false),
            Scattering::Listed(listed) => {
                let listed = &self.listed[listed as usize];
                listed.scatter(&self.functions.get(listed.bsdf), point, photon)
            }
        }
    }
}

impl Disc {
    /// `s_k`.
    #[inline]
    pub fn area(&self) -> f64 {
        PI * f64::from(self.radius) * f64::from(self.radius)
    }
}

impl MeasurementPoint {
    /// May a photon that lies within the radius count here: does its surface look the same way, and is the whole path
    /// of at most `max_edges` edges?
    #[inline]
    pub fn accepts(&self, photon: &Photon, max_edges: u32) -> bool {
        self.normal.dot(photon.normal) >= LEAST_AGREEMENT && self.edges + photon.edges <= max_edges
    }

    /// The value but for the colour: 0 for light that lands on the other side.
    #[inline]
    fn diffuse(&self, photon: &Photon, front: bool) -> Spectrum {
        let shading = self.shading.as_dvec3().dot(photon.wi);
        let side = if front { 1.0 } else { -1.0 };
        if side * shading <= 0.0 || side * self.normal.as_dvec3().dot(photon.wi) <= 0.0 {
            return Spectrum::ZERO;
        }
        Spectrum::splat(photon.per_cosine(shading))
    }
}

impl Listed {
    #[inline]
    fn scatter(&self, bsdf: &Bsdf, point: &MeasurementPoint, photon: &Photon) -> (Spectrum, bool) {
        let [x, y, z] = self.frame.map(|axis| axis.as_dvec3());
        let (frame, wo) = (Frame { x, y, z }, self.wo.as_dvec3());
        let wi = frame.to_local(photon.wi);
        let ng = frame.to_local(point.normal.as_dvec3());
        if !shading::sides_agree(wo, wi, ng) {
            return (Spectrum::ZERO, false);
        }
        let f = bsdf.eval(wo, wi, Mode::Radiance);
        (f * photon.per_cosine(wi.z), bsdf.dispersive_between(wo, wi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One a pixel of a large picture.
    #[test]
    fn a_point_is_small() {
        assert_eq!(size_of::<MeasurementPoint>(), 64);
        assert_eq!(size_of::<Disc>(), 16);
        assert_eq!(size_of::<Listed>(), 52);
    }

    /// Two materials by turns, put together from two lists: every point has its own function, and there are few.
    #[test]
    fn points_share_scattering_functions() {
        let rough =
            |alpha| Bsdf::conductor(Spectrum::splat(1.5), Spectrum::splat(3.0), alpha, false);
        let (kinds, mut all) = ([rough(0.4), rough(0.7)], MeasurementPoints::default());
        for part in 0..2 {
            let mut points = MeasurementPoints::default();
            for at in 0..10 {
                points.push(Seen {
                    vertex: &Vertex::default(),
                    bsdf: kinds[at % 2],
                    wo: DVec3::new(0.6, 0.0, 0.8),
                    throughput: Spectrum::splat(1.0),
                    dispersive: at % 3 == part,
                    edges: at as u32,
                    raster: DVec2::splat(0.5),
                    radius: 1.0,
                });
            }
            all.append(&points);
        }
        assert_eq!((all.points.len(), all.functions.len()), (20, 4));
        for (at, point) in all.points.iter().enumerate() {
            let Scattering::Listed(listed) = point.manner.scattering() else {
                panic!("point {at} has no function");
            };
            let function = all.listed[listed as usize].bsdf;
            assert_eq!(all.functions.get(function), kinds[at % 2], "{at}");
            assert_eq!(point.manner.is_dispersive(), at % 10 % 3 == at / 10);
        }
    }

    #[test]
    fn a_manner_has_what_it_was_made_of() {
        let listed = [0, 1, 77, Manner::BACK - 1].map(Scattering::Listed);
        let diffuse = [true, false].map(|front| Scattering::Diffuse { front });
        for scattering in listed.into_iter().chain(diffuse) {
            for dispersive in [false, true] {
                let manner = Manner::new(scattering, dispersive);
                assert_eq!(manner.scattering(), scattering);
                assert_eq!(manner.is_dispersive(), dispersive);
            }
        }
    }
}
