//! A second path tracer, written for clarity over the scene alone, that can be told to be wrong.
//!
//! It shares no line with the integrator that it checks: no roulette, no strata, the balance
//! heuristic in place of the power heuristic, its own sums. `path` and `bdpt` must agree with it; with a
//! fault planted in it, the very same comparison must say so.

use kaustik::bsdf::{Lobe, Mode, shading};
use kaustik::film::Image;
use kaustik::geometry::Ray;
use kaustik::mcmc::{Draws, sample_generator};
use kaustik::scene::{DirectSample, Scene, Vertex};
use kaustik::spectrum::{Rgb, Spectrum, WavelengthSampling, Wavelengths, Xyz};
use kaustik::{Method, RenderSettings};

use crate::support::{Verdict, agree, scene, settings, side_by_side, tiles_of, tiles_of_seeds};

const SIDE: u32 = 32;
const EDGES: u32 = 12;

/// What is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    None,
    /// Light that a walk runs into is not weighed against next event.
    EmissionUnweighted,
    /// Light of next event is not weighed against running into it.
    NextEventUnweighted,
    /// The rival density lacks the cosine at the emitter.
    DensityPerArea,
    /// Each scattering carries 2 % too much.
    ScatteringTooStrong,
    /// The cosine at the surface is forgotten in next event.
    NoCosine,
}

/// Balance heuristic for a sample of density `p` that might have come with density `q`.
fn balance(p: f64, q: f64) -> f32 {
    (p / (p + q)) as f32
}

/// One sample of a pixel: XYZ.
fn sample(scene: &Scene, raster: [f64; 2], u: &mut impl Draws, fault: Fault) -> [f32; 3] {
    let wavelengths = Wavelengths::sample(u.uniform(), WavelengthSampling::Hero);
    let camera = scene.camera().sample_ray(raster.into(), [0.5; 2]);
    let mut ray = Ray::new(camera.origin.as_vec3(), camera.direction.as_vec3());
    let mut direction = camera.direction;
    let mut interior = scene.camera_interior();
    let (mut throughput, mut light) = (Spectrum::ONE, Spectrum::ZERO);
    let (mut last, mut vertex) = (None, Vertex::default());
    for edge in 1..=EDGES {
        let passing = u.uniform();
        let through = || passing;
        let segment = scene.advance(&ray, &mut interior, &wavelengths, through, &mut vertex);
        throughput *= segment.factor();
        if segment.escapes() {
            break;
        }
        let weight = match last {
            Some((position, pdf)) if fault != Fault::EmissionUnweighted => {
                let mut rival = scene.direct_pdf(position, &vertex);
                if fault == Fault::DensityPerArea {
                    rival *= vertex.normal.dot(direction).abs();
                }
                balance(pdf, rival)
            }
            _ => 1.0,
        };
        light += throughput * scene.emitted(&vertex, -direction, &wavelengths) * weight;
        if edge == EDGES {
            break;
        }
        let bsdf = scene.bsdf(&vertex, &wavelengths, &interior);
        let (wo, ng) = (vertex.frame.to_local(-direction), vertex.local_normal());

        let numbers = [u.uniform(), u.uniform(), u.uniform()];
        let found = scene.sample_direct(vertex.position, &wavelengths, |i| numbers[i as usize]);
        if let Some(found) = found.filter(|_| bsdf.is_connectable()) {
            let wi = vertex.frame.to_local(found.wi);
            let cosine = if fault == Fault::NoCosine {
                1.0
            } else {
                wi.z.abs()
            };
            let mut weight = (cosine / found.pdf) as f32;
            if !found.delta && fault != Fault::NextEventUnweighted {
                weight *= balance(found.pdf, bsdf.pdf(wo, wi, Mode::Radiance));
            }
            if shading::sides_agree(wo, wi, ng) {
                let f = bsdf.eval(wo, wi, Mode::Radiance);
                let passed = passed(scene, &vertex, &found, &wavelengths);
                light += throughput * f * found.radiance * passed * weight;
            }
        }

        let directions = [u.uniform(), u.uniform()];
        let Some(next) = bsdf.sample(wo, u.uniform(), directions, Mode::Radiance) else {
            break;
        };
        throughput *= next.weight;
        if fault == Fault::ScatteringTooStrong {
            throughput *= 1.02;
        }
        last = (!next.delta).then_some((vertex.position, next.pdf));
        direction = vertex.frame.to_world(next.wi);
        if next.transmitted {
            scene.cross(&vertex, direction, &mut interior);
        }
        ray = Ray::spawn(&vertex.surface, direction.as_vec3());
    }
    wavelengths.to_xyz(light).0
}

/// This tracer knows solids only by what `Scene` says of them: it is used in empty space.
fn passed(
    scene: &Scene,
    vertex: &Vertex,
    found: &DirectSample,
    wavelengths: &Wavelengths,
) -> Spectrum {
    let around = scene.camera_interior();
    let ray = scene.shadow_ray(vertex, found);
    scene.visibility(&ray, &around, wavelengths).share
}

/// A picture of independent samples.
fn picture(scene: &Scene, seed: u64, spp: u64, fault: Fault) -> Image {
    let mut planes = [0, 1, 2].map(|_| Vec::with_capacity((SIDE * SIDE) as usize));
    for pixel in 0..u64::from(SIDE * SIDE) {
        let (x, y) = (pixel % u64::from(SIDE), pixel / u64::from(SIDE));
        let mut sum = [0.0f64; 3];
        for index in 0..spp {
            let mut u = sample_generator(seed, 77, pixel * spp + index);
            let raster = [x, y].map(|i| (i as f64 + u.uniform()) / f64::from(SIDE));
            let xyz = sample(scene, raster, &mut u, fault);
            for (sum, value) in sum.iter_mut().zip(xyz) {
                *sum += f64::from(value) / spp as f64;
            }
        }
        let rgb = Rgb::from(Xyz(sum.map(|v| v as f32))).0;
        for (plane, value) in planes.iter_mut().zip(rgb) {
            plane.push(value);
        }
    }
    Image::from_rgb(SIDE, SIDE, planes).expect("a picture")
}

/// Compares a method with this tracer under each fault.
fn against(
    method: Method,
    words: &str,
    faults: &[Fault],
    (seeds, spp, of_book): (u64, u64, u64),
) -> Vec<Verdict> {
    let scene = scene(words, SIDE);
    let settings = RenderSettings {
        max_depth: EDGES,
        ..settings(method, SIDE, spp)
    };
    let right = tiles_of_seeds(&scene, &settings, 100..100 + seeds);
    let verdict = |&fault: &Fault| {
        let book = side_by_side(0..seeds, |seed| picture(&scene, seed, of_book, fault));
        let book = tiles_of(book.into_iter());
        agree(&right, &book, |_| true, 0.02)
    };
    faults.iter().map(verdict).collect()
}

#[test]
fn path_agrees_with_the_book_and_not_with_faults() {
    path_against(&[
        Fault::None,
        Fault::EmissionUnweighted,
        Fault::ScatteringTooStrong,
    ]);
}

#[test]
#[ignore = "long"]
fn path_agrees_with_no_other_fault() {
    path_against(&[
        Fault::NextEventUnweighted,
        Fault::DensityPerArea,
        Fault::NoCosine,
    ]);
}

fn path_against(faults: &[Fault]) {
    let verdicts = against(Method::Path, "cornell", faults, (8, 96, 96));
    for (fault, verdict) in faults.iter().zip(verdicts) {
        let right = *fault == Fault::None;
        assert_eq!(verdict.rejected.is_empty(), right, "{fault:?}: {verdict:?}");
    }
}

#[test]
fn bdpt_agrees_with_the_book_and_not_with_faults() {
    let faults = [
        Fault::None,
        Fault::NextEventUnweighted,
        Fault::ScatteringTooStrong,
    ];
    let verdicts = against(Method::Bdpt, "cornell", &faults, (8, 64, 64));
    for (fault, verdict) in faults.iter().zip(verdicts) {
        let right = *fault == Fault::None;
        assert_eq!(verdict.rejected.is_empty(), right, "{fault:?}: {verdict:?}");
    }
}

#[test]
#[ignore = "long"]
fn both_agree_with_the_book_to_half_a_percent() {
    // Light that comes round a corner a path tracer by the book is longest at.
    for (words, of_path, of_bdpt, share) in [
        ("cornell", 1_024, 256, 0.005),
        ("cornell-direct", 1_024, 256, 0.005),
        ("cornell-indirect", 2_048, 256, 0.02),
    ] {
        for (method, spp) in [(Method::Path, of_path), (Method::Bdpt, of_bdpt)] {
            let verdict = &against(method, words, &[Fault::None], (32, spp, of_path))[0];
            println!("{words}, {method}: {verdict:?}");
            assert!(
                verdict.rejected.is_empty(),
                "{words}, {method}: {verdict:?}"
            );
            assert!(
                verdict.worst_error < share,
                "{words}, {method}: {verdict:?}"
            );
        }
    }
}
