//! The measurement points of one iteration.

use glam::{DVec2, DVec3, Vec3};
use kaustik_bsdf::{Bsdf, BsdfList, Frame, Lobe, Mode, shading};
use kaustik_scene::Vertex;
use kaustik_spectrum::{Spectrum, Wavelengths, Xyz};

use super::Photon;
use super::Sheet;
use super::lookup::Lookup;
use super::manner::{Manner, Scattering};
use super::outline::Outline;
use super::point::{Disc, MeasurementPoint};
use crate::contributions::colour;

/// The points of one iteration. Memory is reused.
#[derive(Clone, Debug, Default)]
pub struct MeasurementPoints {
    /// Apart from the rest: a lookup goes through many of them for each point that it finds.
    discs: Vec<Disc>,
    points: Vec<MeasurementPoint>,
    listed: Vec<Listed>,
    functions: BsdfList,
    outlined: Vec<Outlined>,
    /// Walks that left no point because of what they carried.
    nonfinite: u64,
}

/// What stands in a disc, and how its point scatters.
#[derive(Clone, Copy, Debug)]
struct Outlined {
    outline: Outline,
    /// [`Scattering::number`].
    scattering: u32,
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
    /// Where it lies.
    pub(super) sheet: Sheet,
    /// What stands within the radius.
    pub(super) outline: Option<Outline>,
}

impl MeasurementPoints {
    /// The largest number of points. Each camera path adds at most one. Point numbers use 28 bits, and the
    /// largest of them is reserved.
    pub const MOST: u64 = Manner::NUMBER as u64;

    /// Forgets everything but the memory.
    pub fn clear(&mut self) {
        self.nonfinite = 0;
        self.discs.clear();
        self.points.clear();
        self.listed.clear();
        self.functions.clear();
        self.outlined.clear();
    }

    /// Makes room for so many points in all, and no more than that.
    pub fn reserve(&mut self, count: usize) {
        let more = count.saturating_sub(self.points.len());
        self.discs.reserve_exact(more);
        self.points.reserve_exact(more);
    }

    /// Camera walks that ended with a throughput that is no finite number: each is a fault, and left no point.
    pub fn nonfinite(&self) -> u64 {
        self.nonfinite
    }

    /// The discs of the points, in the same order.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// For whoever finds that they are too large.
    pub(super) fn discs_mut(&mut self) -> &mut [Disc] {
        &mut self.discs
    }

    /// The points, in the order in which they were made.
    pub fn points(&self) -> &[MeasurementPoint] {
        &self.points
    }

    /// Takes all points of another list, after its own.
    pub fn append(&mut self, other: &Self) {
        let (listed, outlined) = (self.listed.len() as u32, self.outlined.len() as u32);
        let function = self.functions.append(&other.functions);
        self.nonfinite += other.nonfinite;
        self.listed.extend(other.listed.iter().map(|listed| Listed {
            bsdf: function + listed.bsdf,
            ..*listed
        }));
        self.outlined
            .extend(other.outlined.iter().map(|outlined| Outlined {
                scattering: (Scattering::of_number(outlined.scattering).after(listed)).number(),
                ..*outlined
            }));
        self.discs.extend_from_slice(&other.discs);
        self.points.extend(other.points.iter().map(|point| {
            let number = point.manner.number();
            let number = if point.manner.is(Manner::OUTLINED) {
                outlined + number
            } else {
                Scattering::of_number(number).after(listed).number()
            };
            MeasurementPoint {
                manner: point.manner.numbered(number),
                ..*point
            }
        }));
    }

    /// Adds a point; one where nothing can be measured (no radius within [`Lookup::RADII`], nothing finite to carry, which is
    /// counted, or the surface seen from behind its normal) is left out.
    pub(super) fn push(&mut self, seen: Seen<'_>) {
        let Seen { vertex, wo, .. } = seen;
        let ng = vertex.local_normal();
        let radius = seen.radius as f32;
        let finite = seen.throughput.is_finite();
        self.nonfinite += u64::from(!finite);
        let usable = finite && Lookup::RADII.contains(&radius) && wo.z * wo.dot(ng) > 0.0;
        if !usable {
            return;
        }
        let mut throughput = seen.throughput;
        let scattering = if let Bsdf::Lambertian(_) = seen.bsdf {
            // The same in all directions on this side: the value along the normal will do.
            let up = DVec3::new(0.0, 0.0, wo.z.signum());
            throughput *= seen.bsdf.eval(wo, up, Mode::Radiance);
            Scattering::Diffuse
        } else {
            let bsdf = self.functions.number(&seen.bsdf);
            self.listed.push(Listed {
                bsdf,
                frame: [vertex.frame.x, vertex.frame.y, vertex.frame.z].map(|axis| axis.as_vec3()),
                wo: wo.as_vec3(),
            });
            debug_assert!(self.listed.len() as u64 <= Self::MOST);
            Scattering::Listed(self.listed.len() as u32 - 1)
        };
        let mut manner = Manner::of(&seen, scattering);
        if let Some(outline) = seen.outline {
            manner = manner.outlined(self.outlined.len() as u32);
            self.outlined.push(Outlined {
                outline,
                scattering: scattering.number(),
            });
        }
        self.discs.push(Disc {
            center: vertex.surface.position,
            radius,
        });
        self.points.push(MeasurementPoint {
            raster: seen.raster,
            throughput,
            normal: vertex.normal.as_vec3(),
            shading: vertex.frame.z.as_vec3(),
            edges: seen.edges.min(u32::from(u16::MAX)) as u16,
            sheet: seen.sheet,
            manner,
        });
    }

    /// Whether a photon within the radius of a point counts there: no outline separates them, the surface
    /// is met on a side that faces the same way, the whole path has at most `max_edges` edges and, on an opaque surface, the
    /// light arrives on the side that is seen. Photons that land on the back must not make a path visible:
    /// under a terrain there may be more of them than on top.
    #[inline]
    pub fn accepts(&self, index: usize, photon: &Photon, max_edges: u32) -> bool {
        let point = &self.points[index];
        point.accepts(photon, max_edges)
            && self.outline(point).is_none_or(|outline| {
                let disc = &self.discs[index];
                outline.holds(point.normal, disc.radius, photon.position - disc.center)
            })
    }

    /// Of what stands in the disc of a point.
    #[inline]
    fn outline(&self, point: &MeasurementPoint) -> Option<&Outline> {
        let outlined = point.manner.is(Manner::OUTLINED);
        outlined.then(|| &self.outlined[point.manner.number() as usize].outline)
    }

    /// `s_k` of G: the part of a point's disc in which photons count, in square scene units.
    #[inline]
    pub fn area(&self, index: usize) -> f64 {
        let disc = &self.discs[index];
        let outline = self.outline(&self.points[index]);
        outline.map_or_else(|| disc.whole_area(), |outline| outline.area(disc.radius))
    }

    /// XYZ that a photon contributes to a point, provided that it lies within the disc and was accepted (G
    /// Eq. 2): power times scattering function times camera throughput, divided by the [area](Self::area).
    /// The weight of the light path is not included. A negative or non-finite result is a defect that the
    /// caller must count.
    #[inline]
    pub fn contribution(&self, index: usize, photon: &Photon, wavelengths: &Wavelengths) -> Xyz {
        let point = &self.points[index];
        let kernel = 1.0 / self.area(index);
        let (f, dispersive) = self.scattered(point, photon);
        let value = point.throughput * photon.power * f * (kernel as f32);
        colour(
            value,
            dispersive || point.manner.is(Manner::DISPERSIVE) || photon.dispersive,
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
        let mut number = point.manner.number();
        if point.manner.is(Manner::OUTLINED) {
            number = self.outlined[number as usize].scattering;
        }
        match Scattering::of_number(number) {
            Scattering::Diffuse => (point.diffuse(photon), false),
            Scattering::Listed(listed) => {
                let listed = &self.listed[listed as usize];
                listed.scatter(&self.functions.get(listed.bsdf), point, photon)
            }
        }
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
pub(super) mod tests;

#[cfg(test)]
impl MeasurementPoints {
    /// Discs alone.
    pub(super) fn of_discs(discs: Vec<Disc>) -> Self {
        Self {
            discs,
            ..Self::default()
        }
    }
}
