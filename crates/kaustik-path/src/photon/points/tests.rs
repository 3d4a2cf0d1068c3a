//! Points of a list: what is kept of them, and which photons count there.

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
    let rough = |alpha| Bsdf::conductor(Spectrum::splat(1.5), Spectrum::splat(3.0), alpha, false);
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
