use glam::{DVec3, Vec3};
use kaustik_mcmc::{Independent, generator};
use kaustik_pss::{Coordinates, Recorded, Recording, Stream};
use kaustik_scene::description::Lens as LensDescription;
use kaustik_scene::description::LightKind;
use kaustik_scene::testing::{
    Stage, ceiling, cuboid, diffuse, double_sided, lamp, punctual, sphere,
};
use kaustik_scene::{
    Description, EmissionPdf, EmissionSample, Reach, Scene, SceneOptions, builtin,
};
use kaustik_spectrum::{WavelengthSampling, Wavelengths};

use super::reference::{Fault, Kind, Lens, Node, Path, Surface};
use crate::bidirectional::vertex::PathVertex;
use crate::bidirectional::witness::{Joint, Seen, Witness};
use crate::bidirectional::workspace::Workspace;
use crate::{Bidirectional, BuilderSettings, Contributions, Form, Heuristic};

/// Keeps what it saw: the weight, the strategy, the path without the end that the other walk drew.
#[derive(Default)]
struct Collected(Vec<Kept>);

struct Kept {
    s: u32,
    weight: f64,
    surfaces: Vec<Node>,
    emitter: Option<Node>,
    /// Of what next event found.
    choice: Option<f64>,
    lens: Option<DVec3>,
}

fn surface_node(vertex: &PathVertex, delta: bool) -> Node {
    Node {
        position: vertex.vertex.position,
        kind: Kind::Surface(Surface {
            normal: vertex.vertex.normal,
            frame: vertex.vertex.frame,
            bsdf: vertex.bsdf,
            onward: vertex.onward,
            delta,
        }),
    }
}

/// A subpath: Dirac events on the way, none at a vertex where it was joined.
fn nodes(path: &[PathVertex], joined: bool) -> Vec<Node> {
    let last = path.len().saturating_sub(1);
    let delta = |i: usize, v: &PathVertex| v.delta && !(joined && i == last);
    path.iter()
        .enumerate()
        .map(|(i, vertex)| surface_node(vertex, delta(i, vertex)))
        .collect()
}

fn emitter(position: DVec3, pdf: EmissionPdf, toward: DVec3) -> Node {
    Node {
        position,
        kind: Kind::Emitter { pdf, toward },
    }
}

impl Witness for Collected {
    fn see(&mut self, seen: &Seen<'_>) {
        let mut surfaces = nodes(seen.light, seen.t > 0);
        let mut eye = nodes(seen.eye, seen.s > 0);
        let (mut found, mut choice, mut lens) = (None, None, None);
        match &seen.joint {
            Joint::Emitter { pdf, direction } => {
                let position = if pdf.infinite {
                    DVec3::ZERO
                } else {
                    eye.pop().expect("the emitter").position
                };
                found = Some(emitter(position, *pdf, -*direction));
            }
            Joint::Direct(sample) => {
                let from = seen.eye[seen.eye.len() - 1].vertex.position;
                let mut pdf = EmissionPdf {
                    position: sample.pdf / sample.odds,
                    direction: sample.emission_pdf,
                    cos: 1.0,
                    infinite: matches!(sample.reach, Reach::Infinity),
                    hittable: !sample.delta,
                    emitter: u32::MAX,
                };
                choice = Some(sample.odds);
                let position = match &sample.reach {
                    Reach::Surface(point, normal) => {
                        let position = point.as_dvec3();
                        pdf.cos = normal.as_dvec3().dot(sample.wi).abs();
                        pdf.position *= pdf.cos / (position - from).length_squared();
                        position
                    }
                    Reach::Point(point) => *point,
                    Reach::Infinity => DVec3::ZERO,
                };
                found = Some(emitter(position, pdf, sample.wi));
            }
            Joint::Lens(sample) => lens = Some(sample.position),
            Joint::LensHit(hit) => lens = Some(hit.position),
            Joint::Surfaces => {}
        }
        surfaces.extend(eye.into_iter().rev());
        self.0.push(Kept {
            s: seen.s,
            weight: seen.weight,
            surfaces,
            emitter: found,
            choice,
            lens,
        });
    }
}

/// The whole path of what was seen; `started` is where the light's walk began, `lens` the point from
/// which the eye's did.
fn whole(
    kept: Kept,
    scene: &Scene,
    form: Form,
    started: Option<&EmissionSample>,
    lens: DVec3,
) -> Path {
    let camera = scene.camera();
    let first = kept.surfaces.first().map(|node| node.position);
    let emitter = kept.emitter.unwrap_or_else(|| {
        let sample = started.expect("a light walk");
        let position = match &sample.area {
            Some(area) => area.surface.position.as_dvec3(),
            None => sample.ray.origin.as_dvec3(),
        };
        let toward = match first {
            Some(first) if !sample.pdf.infinite => (position - first).normalize(),
            _ => -sample.ray.direction.as_dvec3().normalize(),
        };
        emitter(position, sample.pdf, toward)
    });
    let lens = kept.lens.unwrap_or(lens);
    let last = kept.surfaces.last().unwrap_or(&emitter).position;
    let direction = (last - lens).normalize();
    let parallel = camera.is_dirac_direction();
    let end = Node {
        position: lens,
        kind: Kind::Lens(Lens {
            pdf: camera.has_aperture().then(|| camera.pdf_lens()),
            direction: if parallel {
                camera.raster_density(lens, last)
            } else {
                camera.pdf_direction(direction)
            },
            cos: camera.forward().dot(direction),
            parallel,
        }),
    };
    let choice = (kept.choice).unwrap_or_else(|| match (&emitter.kind, first) {
        (Kind::Emitter { pdf, .. }, Some(first)) => scene.next_event_odds(pdf, first),
        _ => 1.0,
    });
    let mut nodes = vec![emitter];
    nodes.extend(kept.surfaces);
    nodes.push(end);
    Path {
        nodes,
        choice,
        at_emitter: form.at_emitter(),
        at_lens: form.at_lens(),
    }
}

/// Differences between the weights of the renderer's paths and their definition, sorted.
fn differences(scene: &Scene, form: Form, heuristic: Heuristic, fault: Fault) -> Vec<f64> {
    let builder = Bidirectional {
        settings: BuilderSettings {
            max_edges: 8,
            ..BuilderSettings::default()
        },
        form,
        heuristic,
    };
    let mut out = Contributions::default();
    let mut source = Independent::new(generator(5, 1));
    let mut differences = Vec::new();
    for _ in 0..POINTS {
        let mut recording = Recording::new(&mut source);
        let mut collected = Collected::default();
        Workspace::with(|w| {
            builder.evaluate(scene, &mut recording, &mut out, w, &mut collected);
        });
        assert_eq!(out.nonfinite(), 0);
        let mut point = recording.finish();
        let started = start_of(scene, &mut point, &collected);
        let lens = lens_of(scene, &mut point, &collected);
        for kept in collected.0 {
            let (s, weight) = (kept.s as usize, kept.weight);
            let path = whole(kept, scene, form, started.as_ref(), lens);
            let densities = path.densities(fault);
            let wanted = densities.weight(heuristic, s, fault);
            differences.push((weight - wanted).abs());
            if fault == Fault::None {
                let n = path.len();
                let sum: f64 = (0..=n)
                    .map(|s| densities.weight(heuristic, s, Fault::None))
                    .sum();
                let sound = (densities.forward.iter())
                    .chain(&densities.reverse)
                    .all(|p| *p > 0.0 && p.is_finite());
                assert!(!sound || (sum - 1.0).abs() < 1e-9, "{sum}");
            }
        }
    }
    differences.sort_by(f64::total_cmp);
    differences
}

const POINTS: u32 = 1_500;
/// Of fewer paths a scene would tell nothing.
const LEAST: usize = 100;

/// The start of the light's walk, by its coordinates, if any path needs it.
fn start_of(scene: &Scene, point: &mut Recorded, collected: &Collected) -> Option<EmissionSample> {
    let needed = |kept: &Kept| kept.emitter.is_none();
    if !collected.0.iter().any(needed) {
        return None;
    }
    let wavelengths =
        Wavelengths::sample(point.get(Stream::Wavelength, 0), WavelengthSampling::Hero);
    scene.sample_emission(&wavelengths, |i| point.get(Stream::Light, i))
}

fn lens_of(scene: &Scene, point: &mut Recorded, collected: &Collected) -> DVec3 {
    let needed = |kept: &Kept| kept.lens.is_none();
    if !collected.0.iter().any(needed) {
        return DVec3::ZERO;
    }
    let mut get = |i| point.get(Stream::Camera, i);
    let raster = [get(0), get(1)].into();
    let lens = if scene.camera().has_aperture() {
        [get(2), get(3)]
    } else {
        [0.5; 2]
    };
    let origin = scene.camera().sample_ray(raster, lens).origin;
    origin.as_vec3().as_dvec3()
}

pub(super) fn compile(description: &Description) -> Scene {
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    Scene::new(description, &options).expect("a sound scene")
}

/// All built-in scenes, the furnaces of all kinds, and one with a lens at the end.
pub(super) fn scenes() -> Vec<(String, Scene)> {
    let kinds = ["glass", "rough", "plate"].map(|kind| format!("furnace?kind={kind}"));
    let names = builtin::list().iter().map(|scene| scene.name.to_owned());
    let mut scenes: Vec<_> = (names.chain(kinds))
        .map(|words| {
            let description = builtin::load(&words).expect("a built-in scene");
            (words, compile(&description))
        })
        .collect();
    let mut description = builtin::load("ring-and-sphere").expect("a built-in scene");
    description.cameras[0].lens = Some(LensDescription {
        aperture: 1.5,
        focus: 8.0,
        blades: None,
    });
    scenes.push(("thin lens".to_owned(), compile(&description)));
    scenes.push(("many lamps".to_owned(), many_lamps()));
    scenes
}

/// A hall with a row of small lamps of several kinds, in which next event chooses by place.
fn many_lamps() -> Scene {
    let mut stage = Stage::new()
        .look_at(Vec3::new(0.0, 1.5, 9.0), Vec3::new(0.0, 1.0, 0.0), 0.9)
        .add(
            double_sided(diffuse([0.7; 3])),
            cuboid(Vec3::new(-2.0, 0.0, -10.0), Vec3::new(2.0, 3.0, 10.0)),
        );
    for i in 0..9 {
        let place = Vec3::new(0.7 * (i % 3) as f32 - 0.7, 2.6, 2.0 * i as f32 - 8.0);
        stage = stage.add(lamp(4.0), ceiling(place, 0.1));
        if i % 4 == 1 {
            stage = stage.add(lamp(1.0), sphere(place - Vec3::Y * 2.0, 0.2));
            stage = stage.light(punctual(
                LightKind::Point,
                0.5,
                place - Vec3::Y,
                Vec3::NEG_Y,
            ));
        }
    }
    stage
        .light(punctual(
            LightKind::Directional,
            1.0,
            Vec3::ZERO,
            Vec3::NEG_Y,
        ))
        .build()
}

/// Of the value below which so many in a thousand lie.
fn percentile(sorted: &[f64], per_mille: usize) -> f64 {
    sorted[(sorted.len() * per_mille / 1000).min(sorted.len() - 1)]
}

#[test]
fn weights_of_traced_paths_are_the_walk() {
    for (name, scene) in scenes() {
        for form in [Form::Full, Form::Simple] {
            for heuristic in [Heuristic::Balance, Heuristic::Power, Heuristic::Maximum] {
                let off = differences(&scene, form, heuristic, Fault::None);
                let paths = off.len();
                assert!(paths > LEAST, "{name}, {form:?}: {paths} paths");
                let high = percentile(&off, 999);
                assert!(
                    high < 1e-3,
                    "{name}, {form:?}, {heuristic:?}: {high} of {paths} paths"
                );
            }
        }
    }
}

/// The test of the test: by the same measure.
#[test]
fn a_missing_term_is_noticed() {
    // a room in which no strategy is rare
    let description = builtin::load("furnace?kind=diffuse").expect("a built-in scene");
    let scene = compile(&description);
    for fault in [Fault::Without(0), Fault::Without(3), Fault::NoCosine] {
        let off = differences(&scene, Form::Full, Heuristic::Power, fault);
        let high = percentile(&off, 999);
        assert!(high > 1e-2, "{fault:?}: {high}");
    }
    let fault = Fault::EvenChoice;
    let off = differences(&many_lamps(), Form::Full, Heuristic::Power, fault);
    let high = percentile(&off, 999);
    assert!(high > 1e-2, "{fault:?}: {high}");
}
