use std::sync::Arc;

use glam::Vec3;
use kaustik_geometry::Mesh;
use kaustik_mcmc::{Independent, Mean, generator};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::description::Lens;
use kaustik_scene::{Description, Scene, SceneOptions, builtin};
use kaustik_spectrum::{Illuminant, WavelengthSampling, Wavelengths};

use crate::bidirectional::witness::{Seen, Witness};
use crate::bidirectional::workspace::Workspace;
use crate::{Bidirectional, BuilderSettings, Contributions, Form, Heuristic};

const EDGES: u32 = 5;

/// X + Y + Z of what each strategy brings, weight taken out, `[s][t]`; in a convex room all is
/// visible.
#[derive(Default)]
struct Unweighted {
    wavelengths: Option<Wavelengths>,
    sums: [[f64; 8]; 8],
    /// With its weight, and with another.
    whole: f64,
    wrong: f64,
}

impl Witness for Unweighted {
    fn see(&mut self, seen: &Seen<'_>) {
        let wavelengths = self.wavelengths.as_ref().expect("set before");
        let value = f64::from(wavelengths.to_xyz(seen.value).sum());
        self.sums[seen.s as usize][seen.t as usize] += value / seen.weight;
        self.whole += value;
        // Of the power heuristic's strategies (s, t) with s > 1 one forgets the rivals.
        self.wrong += if seen.s == 2 {
            value / seen.weight
        } else {
            value
        };
    }
}

fn compile(description: &Description) -> Scene {
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    Scene::new(description, &options).expect("a sound scene")
}

fn furnace() -> Description {
    builtin::load("furnace?kind=diffuse").expect("a built-in scene")
}

/// Some rings of a coarse ball seen from within, whose interpolated normals are far from those of its
/// facets.
fn bent_ball(radius: f32, rings: std::ops::Range<u32>) -> Mesh {
    const RINGS: u32 = 4;
    const SPOKES: u32 = 5;
    let at = |ring: u32, spoke: u32| {
        let theta = std::f32::consts::PI * ring as f32 / RINGS as f32;
        let phi = std::f32::consts::TAU * (spoke % SPOKES) as f32 / SPOKES as f32;
        let (y, across) = (theta.cos(), theta.sin());
        Vec3::new(across * phi.cos(), y, across * phi.sin())
    };
    let mut mesh = Mesh::default();
    for ring in rings {
        for spoke in 0..SPOKES {
            let corners = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(r, s)| at(ring + r, spoke + s));
            let first = mesh.positions.len() as u32;
            mesh.normals.extend(corners.map(|corner| -corner));
            mesh.positions.extend(corners.map(|corner| corner * radius));
            if ring + 1 < RINGS {
                mesh.indices.push([first, first + 3, first + 2]);
            }
            if ring > 0 {
                mesh.indices.push([first, first + 2, first + 1]);
            }
        }
    }
    mesh
}

/// X + Y + Z of a white emission of strength 1.
fn white() -> f64 {
    let spectrum = |nm: f64| f64::from(Illuminant::D65.at(nm as f32));
    kaustik_spectrum::integrate_xyz(spectrum).iter().sum()
}

fn off(mean: &Mean, expected: f64) -> f64 {
    (mean.mean() - expected).abs() / mean.standard_error()
}

/// What each strategy brings, `[s][t]`; the whole; the whole with a fault.
type Means = ([[Mean; 8]; 8], Mean, Mean);

fn means(scene: &Scene, samples: u32) -> Means {
    let builder = Bidirectional {
        settings: BuilderSettings {
            max_edges: EDGES,
            ..BuilderSettings::default()
        },
        form: Form::Full,
        heuristic: Heuristic::Power,
    };
    let mut means = [[Mean::new(); 8]; 8];
    let (mut whole, mut wrong) = (Mean::new(), Mean::new());
    let mut out = Contributions::default();
    let mut u = Independent::new(generator(4, 0));
    for _ in 0..samples {
        let mut witness = Unweighted::default();
        let first = u.get(Stream::Wavelength, 0);
        witness.wavelengths = Some(Wavelengths::sample(first, WavelengthSampling::Hero));
        let mut given = First {
            first,
            rest: &mut u,
        };
        Workspace::with(|w| builder.evaluate(scene, &mut given, &mut out, w, &mut witness));
        for (means, sums) in means.iter_mut().zip(witness.sums) {
            for (mean, sum) in means.iter_mut().zip(sums) {
                mean.push(sum);
            }
        }
        whole.push(witness.whole);
        wrong.push(witness.wrong);
    }
    (means, whole, wrong)
}

/// Strategies that make paths of so many edges.
fn strategies(edges: usize, lens: bool) -> impl Iterator<Item = (usize, usize)> {
    (0..=edges + 1)
        .map(move |s| (s, edges + 1 - s))
        .filter(move |&(s, t)| (edges > 1 || s == 0) && (t > 0 || lens))
}

/// Where emission and reflectance are 1/2, paths of k edges bring 2^-k: whichever strategy makes
/// them. `uncertainty` is the relative error within which each must be known.
fn assert_equal_strategies(lens: Option<Lens>, samples: u32, uncertainty: f64) {
    let mut description = furnace();
    description.cameras[0].lens = lens;
    let (means, whole, wrong) = means(&compile(&description), samples);
    let mut used = 0;
    for edges in 1..=EDGES as usize {
        let expected = white() * 0.5_f64.powi(edges as i32);
        for (s, t) in strategies(edges, lens.is_some()) {
            let mean = &means[s][t];
            assert!(
                off(mean, expected) < 4.5,
                "({s}, {t}): {mean:?}, {expected}"
            );
            assert!(
                mean.standard_error() < uncertainty * expected,
                "({s}, {t}): {mean:?}"
            );
            used += 1;
        }
    }
    let lit = means.iter().flatten().filter(|mean| mean.mean() != 0.0);
    assert_eq!(lit.count(), used, "others are no strategies");
    let expected = white() * (1.0 - 0.5_f64.powi(EDGES as i32));
    assert!(off(&whole, expected) < 4.5, "{whole:?}, {expected}");
    // The test of the test.
    assert!(off(&wrong, expected) > 10.0, "{wrong:?}, {expected}");
}

/// With shading normals that are not the facets' the light is not known, but the same for all
/// strategies.
#[test]
fn every_strategy_alone_brings_the_same_under_bent_normals() {
    let mut description = furnace();
    let radius = description.meshes[0].positions[0].length();
    // Light from above alone: in even light what bent normals do would cancel.
    description.meshes[0] = Arc::new(bent_ball(radius, 0..1));
    description.meshes.push(Arc::new(bent_ball(radius, 1..4)));
    let mut dark = description.materials[0].clone();
    dark.emissive = [0.0; 3];
    description.materials.push(dark);
    let mut walls = description.instances[0].clone();
    walls.mesh = 1;
    walls.material = Some(1);
    description.instances.push(walls);
    let (means, ..) = means(&compile(&description), 200_000);
    for edges in 2..=4 {
        let wanted = &means[1][edges];
        for (s, t) in strategies(edges, false) {
            let mean = &means[s][t];
            let error = mean.standard_error().hypot(wanted.standard_error());
            let off = (mean.mean() - wanted.mean()).abs() / error;
            assert!(off < 4.5, "({s}, {t}): {mean:?}, {wanted:?}");
            assert!(error < 0.05 * wanted.mean(), "({s}, {t}): {mean:?}");
        }
    }
}

#[test]
fn every_strategy_alone_brings_the_same() {
    assert_equal_strategies(None, 60_000, 0.03);
}

/// With a lens that light runs into (t = 0).
#[test]
fn every_strategy_alone_brings_the_same_through_a_lens() {
    let lens = Lens {
        aperture: 0.5,
        focus: 1.5,
        blades: None,
    };
    assert_equal_strategies(Some(lens), 120_000, 0.06);
}

/// Gives a wavelength that is known already, then passes on.
struct First<'a> {
    first: f64,
    rest: &'a mut dyn Coordinates,
}

impl Coordinates for First<'_> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        if stream == Stream::Wavelength {
            self.first
        } else {
            self.rest.get(stream, index)
        }
    }
}
