use std::collections::BTreeMap;

use kaustik_mcmc::{Independent, generator};
use kaustik_pss::{Coordinates, Recorded, Recording, Stream};
use kaustik_scene::description::Lens;
use kaustik_scene::{Scene, builtin};
use kaustik_spectrum::{WavelengthSampling, Wavelengths, Xyz};

use super::traced::{compile, scenes};
use crate::bidirectional::witness::{Seen, Witness};
use crate::bidirectional::workspace::Workspace;
use crate::bidirectional::{Job, Technique};
use crate::{
    Bidirectional, BuilderSettings, Class, Contributions, Form, Heuristic, Multiplexed,
    ScalarTarget, Techniques,
};

const EDGES: u32 = 6;
const POINTS: u32 = 150;

fn paths(heuristic: Heuristic) -> Bidirectional {
    Bidirectional {
        settings: BuilderSettings {
            max_edges: EDGES,
            ..BuilderSettings::default()
        },
        form: Form::Full,
        heuristic,
    }
}

/// All strategies at once, by walks without roulette, as those of one strategy have none.
fn whole(paths: &Bidirectional, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
    out.clear();
    let first = u.get(Stream::Wavelength, 0);
    let job = Job {
        builder: paths,
        scene,
        wavelengths: &Wavelengths::sample(first, WavelengthSampling::Hero),
        raster_pdf: paths.settings.raster_pdf(),
        roulette: false,
    };
    Workspace::with(|workspace| job.full(u, out, workspace, &mut ()));
}

/// Of each class: light, and light times a function of the place that it falls on.
type Sums = [[f64; 2]; Class::COUNT];

fn add(sums: &mut Sums, out: &Contributions, factor: f64) {
    for splat in out.splats() {
        let light = ScalarTarget::Xyz.of(splat.xyz) * factor;
        let place = 1.0 + splat.raster.x + 3.0 * splat.raster.y;
        let sum = &mut sums[splat.class as usize];
        sum[0] += light;
        sum[1] += light * place;
    }
}

/// The largest difference between the whole and its parts, as a share of the whole, over all points of which the
/// techniques are known that brought light.
fn worst(
    scene: &Scene,
    builder: &Multiplexed,
    paths: &Bidirectional,
    counts: impl Fn(&Technique) -> bool,
) -> (f64, u32) {
    let mut source = Independent::new(generator(31, 0));
    let mut out = Contributions::default();
    let (mut worst, mut lit) = (0.0_f64, 0);
    for _ in 0..POINTS {
        let mut recording = Recording::new(&mut source);
        whole(paths, scene, &mut recording, &mut out);
        let mut point: Recorded = recording.finish();
        let (mut together, mut apart) = (Sums::default(), Sums::default());
        add(&mut together, &out, 1.0);
        for technique in builder.techniques().all().filter(&counts) {
            builder.build_one(scene, technique, &mut point, &mut out);
            assert_eq!(out.nonfinite(), 0);
            assert!(out.splats().len() <= 1, "{technique:?}");
            add(&mut apart, &out, technique.probability);
        }
        assert_eq!(point.missing(), None);
        let scale: f64 = together.iter().map(|sum| sum[1]).sum();
        lit += u32::from(scale > 0.0);
        for (a, b) in together.iter().flatten().zip(apart.iter().flatten()) {
            worst = worst.max((a - b).abs() / scale.max(1e-30));
        }
    }
    (worst, lit)
}

/// Point by point, not in the mean: with the same coordinates the strategies one at a time, each times its
/// probability, are together what the full form makes of them.
#[test]
fn one_strategy_at_a_time_is_the_whole() {
    let mut lit = 0;
    for (name, scene) in scenes() {
        for heuristic in [Heuristic::Power, Heuristic::Balance, Heuristic::Maximum] {
            let paths = paths(heuristic);
            let lens = scene.camera().has_aperture();
            let builder = Multiplexed::new(paths, Techniques::even(1, EDGES, lens));
            let (worst, found) = worst(&scene, &builder, &paths, |_| true);
            assert!(worst < 1e-4, "{name}, {heuristic:?}: {worst}");
            lit += found;
        }
    }
    assert!(lit > 4_000, "most of it must not be black: {lit}");
}

/// Of each strategy, the light that a witness is told of, and with which probability roulette left it.
#[derive(Default)]
struct Lit(BTreeMap<(u32, u32), (f64, f64)>);

impl Witness for Lit {
    fn see(&mut self, _: &Seen<'_>) {}

    fn lit(&mut self, strategy: (u32, u32), survived: f32, light: impl FnOnce() -> Xyz) {
        let told = (ScalarTarget::Xyz.of(light()), f64::from(survived));
        assert_eq!(self.0.insert(strategy, told), None, "told of once");
    }
}

/// A witness is told of all light, as of the strategy that brings it. Light times the probability with which roulette left
/// it is what the strategy alone brings, whose walks play none.
#[test]
fn all_light_is_told_of() {
    let (mut told, mut left) = (0, 0);
    for (name, scene) in scenes() {
        let paths = paths(Heuristic::Power);
        let lens = scene.camera().has_aperture();
        let builder = Multiplexed::new(paths, Techniques::even(1, EDGES, lens));
        let mut source = Independent::new(generator(32, 0));
        let mut out = Contributions::default();
        for _ in 0..POINTS {
            let mut recording = Recording::new(&mut source);
            let mut whole = Lit::default();
            Workspace::with(|workspace| {
                paths.evaluate(&scene, &mut recording, &mut out, workspace, &mut whole);
            });
            let mut point: Recorded = recording.finish();
            let splats = out.splats().iter();
            let all: f64 = splats.map(|splat| ScalarTarget::Xyz.of(splat.xyz)).sum();
            let seen: f64 = whole.0.values().map(|(light, _)| light).sum();
            assert!((all - seen).abs() <= 1e-4 * all, "{name}: {seen} of {all}");
            for technique in builder.techniques().all() {
                let strategy = (technique.s, technique.t);
                let Some((light, survived)) = whole.0.remove(&strategy) else {
                    continue;
                };
                let mut alone = Lit::default();
                Workspace::with(|workspace| {
                    builder.one(
                        &scene, technique, &mut point, &mut out, workspace, &mut alone,
                    );
                });
                let expected = light * survived / technique.probability;
                let (light, one) = alone.0.remove(&strategy).expect("the same light");
                // a strategy alone plays no roulette: all of its light survives
                assert_eq!(one.to_bits(), 1.0_f64.to_bits(), "{name}, {technique:?}");
                assert!(alone.0.is_empty(), "{name}, {technique:?}");
                // below that f32 has few digits left
                assert!(
                    (light - expected).abs() <= 1e-4 * expected + 1e-34,
                    "{name}, {technique:?}: {light}, not {expected}"
                );
                told += 1;
                left += u32::from(survived < 1.0);
            }
            assert!(whole.0.is_empty(), "{name}: {:?}", whole.0.keys());
        }
    }
    assert!(told > 4_000, "most of it must not be black: {told}");
    assert!(left > 400, "roulette must have been played: {left}");
}

/// The test of the test: without any one of the strategies of three edges it is not the whole.
#[test]
fn a_missing_strategy_is_noticed() {
    let mut description = builtin::load("furnace?kind=diffuse").expect("a built-in scene");
    description.cameras[0].lens = Some(Lens {
        aperture: 0.5,
        focus: 1.5,
        blades: None,
    });
    let scene = compile(&description);
    let paths = paths(Heuristic::Power);
    let builder = Multiplexed::new(paths, Techniques::even(1, EDGES, true));
    for left_out in 0..=4 {
        let counts = |technique: &Technique| technique.s != left_out || technique.t != 4 - left_out;
        let (worst, _) = worst(&scene, &builder, &paths, counts);
        assert!(worst > 1e-3, "without s = {left_out}: {worst}");
    }
}
