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
impl MeasurementPoints {
    /// Discs alone.
    pub(super) fn of_discs(discs: Vec<Disc>) -> Self {
        Self {
            discs,
            ..Self::default()
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// One a pixel of a large picture.
    #[test]
    fn a_point_is_small() {
        assert_eq!(size_of::<MeasurementPoint>(), 64);
        assert_eq!(size_of::<Disc>(), 16);
        assert_eq!(size_of::<Listed>(), 52);
        assert_eq!(size_of::<Outlined>(), 16);
    }

    /// Each is a fault of the scene or of ours: it is counted, through lists that are put together, and leaves nothing.
    #[test]
    fn walks_that_carry_no_finite_number_are_counted() {
        let (vertex, grey) = (Vertex::default(), Bsdf::lambertian(Spectrum::splat(0.5)));
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let mut all = MeasurementPoints::default();
        for carried in [f32::NAN, 1.0, f32::INFINITY] {
            let mut points = MeasurementPoints::default();
            points.push(Seen {
                throughput: Spectrum::splat(carried),
                ..seen(&vertex, grey, wo)
            });
            all.append(&points);
        }
        assert_eq!((all.points.len(), all.nonfinite()), (1, 2));
        all.clear();
        assert_eq!(all.nonfinite(), 0);
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
                let wo = DVec3::new(0.6, 0.0, 0.8);
                points.push(Seen {
                    dispersive: at % 3 == part,
                    edges: at as u32,
                    ..seen(&Vertex::default(), kinds[at % 2], wo)
                });
            }
            all.append(&points);
        }
        assert_eq!((all.points.len(), all.functions.len()), (20, 4));
        for (at, point) in all.points.iter().enumerate() {
            let Scattering::Listed(listed) = Scattering::of_number(point.manner.number()) else {
                panic!("point {at} has no function");
            };
            let function = all.listed[listed as usize].bsdf;
            assert_eq!(all.functions.get(function), kinds[at % 2], "{at}");
            assert_eq!(point.manner.is(Manner::DISPERSIVE), at % 10 % 3 == at / 10);
        }
    }

    /// Where something stands in a disc, photons behind it do not count and those before it count for more, whatever scatters
    /// there and whichever list the point comes from.
    #[test]
    fn what_stands_in_a_disc_parts_it() {
        let metal = Bsdf::conductor(Spectrum::splat(1.5), Spectrum::splat(3.0), 0.5, false);
        let kinds = [Bsdf::lambertian(Spectrum::splat(0.5)), metal];
        let wavelengths = Wavelengths::sample(0.3, Default::default());
        let (vertex, wo) = (Vertex::default(), DVec3::new(0.6, 0.0, 0.8));
        let (outline, mut all) = (Outline::mostly_blocked(), MeasurementPoints::default());
        for _ in 0..2 {
            let mut points = MeasurementPoints::default();
            for (bsdf, outline) in [
                (kinds[1], None),
                (kinds[0], Some(outline)),
                (kinds[1], Some(outline)),
                (kinds[0], None),
            ] {
                points.push(Seen {
                    outline,
                    ..seen(&vertex, bsdf, wo)
                });
            }
            all.append(&points);
        }
        let [x, y] = {
            let (x, y) = vertex.normal.as_vec3().any_orthonormal_pair();
            [x, y].map(|axis| axis * 0.5)
        };
        let photon = |position| Photon {
            position: vertex.surface.position + position,
            normal: vertex.normal.as_vec3(),
            wi: DVec3::new(0.3, 0.2, 0.8).normalize(),
            power: Spectrum::splat(1.0),
            edges: 1,
            dispersive: false,
            sheet: Sheet::default(),
        };
        let brought = |index, photon| all.contribution(index, photon, &wavelengths).sum();
        let part = (PI / outline.area(1.0)) as f32;
        assert!(part > 2.0 && part < 3.0, "{part}");
        let (before, behind) = (photon(-x - y), photon(x + y));
        for list in [0, 4] {
            for (parted, whole) in [(1, 3), (2, 0)] {
                let ([parted, whole], [near, far]) =
                    ([list + parted, list + whole], [&before, &behind]);
                assert!(all.accepts(parted, near, 8) && !all.accepts(parted, far, 8));
                assert!(all.accepts(whole, near, 8) && all.accepts(whole, far, 8));
                let ratio = brought(parted, near) / (brought(whole, near) * part);
                assert!((ratio - 1.0).abs() < 1e-5, "{parted}: {ratio}");
                let responses = [parted, whole].map(|index| all.response(index, near).to_bits());
                assert_eq!(responses[0], responses[1]);
            }
        }
    }

    pub(in super::super) fn seen(vertex: &Vertex, bsdf: Bsdf, wo: DVec3) -> Seen<'_> {
        Seen {
            vertex,
            bsdf,
            wo,
            throughput: Spectrum::splat(1.0),
            dispersive: false,
            edges: 1,
            raster: DVec2::splat(0.5),
            radius: 1.0,
            sheet: Sheet::default(),
            outline: None,
        }
    }

    pub(in super::super) fn glass() -> Bsdf {
        let rough = kaustik_bsdf::PrincipledParameters {
            metallic: 0.0,
            roughness: 0.7,
            transmission: 1.0,
            ..Default::default()
        };
        Bsdf::Principled(kaustik_bsdf::Principled::new(&rough))
    }

    /// Of an opaque surface a photon is accepted exactly if it brings light, from either side, with a shading normal
    /// of its own; what shines through counts from both sides.
    #[test]
    fn light_from_behind_meets_what_it_shines_through_alone() {
        let metal = Bsdf::conductor(Spectrum::splat(1.5), Spectrum::splat(3.0), 0.5, false);
        let grey = Bsdf::lambertian(Spectrum::splat(0.5));
        let vertex = Vertex {
            frame: Frame::from_z(DVec3::new(0.3, 0.0, 1.0).normalize()),
            ..Vertex::default()
        };
        let wavelengths = Wavelengths::sample(0.3, Default::default());
        for (bsdf, opaque) in [(grey, true), (metal, true), (glass(), false)] {
            for above in [1.0, -1.0] {
                let mut points = MeasurementPoints::default();
                points.push(seen(
                    &vertex,
                    bsdf,
                    DVec3::new(0.1, 0.2, 0.9 * above).normalize(),
                ));
                assert_eq!(points.points.len(), 1);
                let mut met = [0, 0];
                for number in 0..400 {
                    let turn = f64::from(number) * 2.4;
                    let height = f64::from(number) / 200.0 - 0.9975;
                    let across = (1.0 - height * height).sqrt();
                    let photon = Photon {
                        position: Vec3::ZERO,
                        normal: vertex.normal.as_vec3(),
                        wi: DVec3::new(across * turn.cos(), across * turn.sin(), height),
                        power: Spectrum::splat(1.0),
                        edges: 1,
                        dispersive: false,
                        sheet: Sheet::default(),
                    };
                    let accepted = points.accepts(0, &photon, 8);
                    let lit = points.contribution(0, &photon, &wavelengths).sum() > 0.0;
                    assert!(accepted || !lit, "{bsdf:?} {}", photon.wi);
                    assert!(!opaque || lit == accepted, "{bsdf:?} {}", photon.wi);
                    met[usize::from(height * above > 0.0)] += u32::from(accepted);
                }
                let [behind, before] = met;
                assert!(before > 150, "{before}");
                assert_eq!(behind > 0, !opaque, "{behind}");
            }
        }
    }
}
