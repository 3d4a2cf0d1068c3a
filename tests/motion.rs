//! What moves while the shutter is open: in every method that follows it, against the mean of still pictures.

use glam::{DAffine3, DVec3};
use kaustik::film::Image;
use kaustik::scene::description::{
    AnimationDescription, Carried, Channel, InstanceDescription, Interpolation, Joint,
    LightDescription, LightKind, Load, Rest, Shutter,
};
use kaustik::scene::{Description, Scene, builtin};
use kaustik::{Method, RenderSettings};

use crate::bits::bits;
use crate::state::{last_state, resumed};
use crate::support::{
    Tile, Verdict, agree, compile, means, picture, settings, tiles_of, tiles_of_seeds,
};

const SIDE: u32 = 16;
const SEEDS: std::ops::Range<u64> = 0..8;
const AGAIN: std::ops::Range<u64> = 100..124;
/// Still pictures in place of an interval.
const STILLS: u64 = 32;

/// Methods whose mean is that of path tracing, with samples a pixel that make their tiles certain to some per cent.
const EXACT: [(Method, u64); 11] = [
    (Method::Path, 128),
    (Method::Light, 128),
    (Method::Bdpt, 64),
    (Method::Pssmlt, 256),
    (Method::Mmlt, 512),
    (Method::Relt, 128),
    (Method::ErptPss, 32),
    (Method::Mlt, 512),
    (Method::Erpt, 32),
    (Method::MltMultistage, 512),
    (Method::PssmltMultistage, 256),
];

/// Iterations of photon methods, as many as there are still pictures, and light paths of each: chains need some to
/// forget where the light was.
const ITERATIONS: u64 = STILLS;
const PHOTONS: u64 = 16_000;

/// A node that stands still at this place.
fn joint(at: DVec3) -> Joint {
    Joint {
        name: "joint".to_owned(),
        parent: None,
        to_parent: DAffine3::from_translation(at),
        rest: Rest {
            translation: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            scale: [1.0; 3],
        },
        translation: None,
        rotation: None,
        scale: None,
    }
}

fn channel<const N: usize>(
    interpolation: Interpolation,
    times: &[f32],
    values: &[[f32; N]],
) -> Option<Channel<N>> {
    Some(Channel {
        interpolation,
        times: times.to_vec(),
        values: values.to_vec(),
    })
}

/// The middle of an instance whose transform is the identity.
fn middle(description: &Description, instance: usize) -> DVec3 {
    let bounds = description.meshes[description.instances[instance].mesh].bounds();
    (bounds.min + bounds.max).as_dvec3() * 0.5
}

/// The room with a block that turns while it goes aside, a lamp that grows and jumps, a point light on a spline and a
/// camera that looks about, all within a second.
fn moving() -> Description {
    let mut description = builtin::load("cornell").expect("a built-in scene");
    let named = |name: &str| {
        let mut instances = description.instances.iter();
        let found = instances.position(|instance| instance.name == name);
        found.expect("an instance of the Cornell box")
    };
    let (lamp, block) = (named("lamp"), named("tall block"));
    let mut animation = AnimationDescription::default();
    let mut carry = |load, joints: Vec<Joint>, offset: DAffine3| {
        for mut joint in joints {
            let index = animation.joints.len();
            joint.parent = (joint.name == "child").then(|| index - 1);
            animation.joints.push(joint);
        }
        let joint = animation.joints.len() - 1;
        animation.carried.push(Carried {
            load,
            joint,
            offset,
        });
    };

    let at = middle(&description, block);
    let mut aside = joint(at);
    aside.translation = channel(
        Interpolation::Linear,
        &[0.0, 1.0],
        &[[-0.8, 0.0, 0.0], [0.8, 0.5, 0.3]],
    );
    let mut turn = joint(DVec3::ZERO);
    turn.name = "child".to_owned();
    turn.rotation = channel(
        Interpolation::Linear,
        &[0.0, 1.0],
        &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.8, 0.0, 0.6]],
    );
    let offset = DAffine3::from_translation(-at);
    carry(Load::Instance(block), vec![aside, turn], offset);

    let at = middle(&description, lamp);
    let mut grows = joint(at);
    grows.scale = channel(
        Interpolation::Linear,
        &[0.0, 1.0],
        &[[0.4, 1.0, 0.4], [1.6, 1.0, 2.0]],
    );
    grows.translation = channel(
        Interpolation::Step,
        &[0.0, 0.4],
        &[[0.0, -0.4, 0.0], [0.6, -0.8, 0.0]],
    );
    let offset = DAffine3::from_translation(-at);
    carry(Load::Instance(lamp), vec![grows], offset);

    let mut spline = joint(at - DVec3::Y * 2.0);
    let (slow, fast) = ([0.0; 3], [4.0, 2.0, 0.0]);
    spline.translation = channel(
        Interpolation::CubicSpline,
        &[0.0, 1.0],
        &[slow, [-1.0, 0.0, 0.0], fast, fast, [1.0, 0.0, 0.0], slow],
    );
    carry(Load::Light(0), vec![spline], DAffine3::IDENTITY);
    description.lights.push(LightDescription {
        name: "point".to_owned(),
        kind: LightKind::Point,
        color: [1.0, 0.6, 0.2],
        intensity: 8.0,
        range: None,
        transform: glam::Affine3A::IDENTITY,
    });

    let camera = &description.cameras[0].transform;
    let camera = DAffine3 {
        matrix3: camera.matrix3.as_dmat3(),
        translation: camera.translation.as_dvec3(),
    };
    let mut looks = joint(DVec3::ZERO);
    looks.to_parent = camera;
    looks.rotation = channel(
        Interpolation::Linear,
        &[0.0, 1.0],
        &[[0.0, 0.06, 0.0, 1.0], [0.03, -0.06, 0.0, 1.0]],
    );
    carry(Load::Camera(0), vec![looks], DAffine3::IDENTITY);
    description.animation = animation;
    description
}

/// The moving room, seen from `open` to `close`.
fn between(open: f32, close: f32) -> Description {
    let mut description = moving();
    description.cameras[0].shutter = Some(Shutter { open, close });
    description
}

/// The mean of still pictures at times that are spread evenly, each seed with times of its own.
fn mean_of_stills(seed: u64) -> Image {
    sum_of_stills(seed, &settings(Method::Path, SIDE, 8))
}

/// The sum of so many, rendered so.
fn sum_of_stills(seed: u64, each: &RenderSettings) -> Image {
    let offset = (seed as f32 * 0.618_034).fract();
    let mut sum: Option<Image> = None;
    for still in 0..STILLS {
        let time = (still as f32 + offset) / STILLS as f32;
        let scene = compile(&between(time, time), SIDE);
        assert!(!scene.moves());
        let settings = RenderSettings {
            seed: seed * STILLS + still + 1_000,
            ..each.clone()
        };
        let image = picture(&scene, &settings);
        match &mut sum {
            None => sum = Some(image),
            Some(sum) => sum.add(&image).expect("images of one size"),
        }
    }
    sum.expect("stills")
}

/// As many times as bright, as the sum of stills is.
fn sums(tiles: Vec<Tile>) -> Vec<Tile> {
    let scaled = |tile: Tile| {
        let scale = |mut runs: crate::support::Runs| {
            runs.mean *= STILLS as f64;
            runs.variance *= (STILLS * STILLS) as f64;
            runs
        };
        Tile {
            channels: tile.channels.map(scale),
            luminance: scale(tile.luminance),
        }
    };
    tiles.into_iter().map(scaled).collect()
}

fn blurred(method: Method, spp: u64, seeds: std::ops::Range<u64>) -> Vec<Tile> {
    let scene = compile(&between(0.0, 1.0), SIDE);
    assert!(scene.moves());
    sums(tiles_of_seeds(&scene, &settings(method, SIDE, spp), seeds))
}

/// The Cornell box with a lamp of this scale for the first half of the interval, and as it is for the second.
fn flashing(scale: [f32; 3]) -> Description {
    let mut description = builtin::load("cornell").expect("a built-in scene");
    let is_lamp = |instance: &InstanceDescription| instance.name == "lamp";
    let lamp = description.instances.iter().position(is_lamp);
    let lamp = lamp.expect("a lamp");
    let at = middle(&description, lamp);
    let mut flashes = joint(at);
    flashes.scale = channel(Interpolation::Step, &[0.0, 0.5], &[scale, [1.0; 3]]);
    description.animation.joints.push(flashes);
    description.animation.carried.push(Carried {
        load: Load::Instance(lamp),
        joint: 0,
        offset: DAffine3::from_translation(-at),
    });
    description.cameras[0].shutter = Some(Shutter {
        open: 0.0,
        close: 1.0,
    });
    description
}

/// A lamp without size, or so flat that no ray meets it, lights nothing for as long as it is so.
#[test]
fn lamps_that_are_not_there_light_nothing() {
    let still = compile(&builtin::load("cornell").expect("a built-in scene"), SIDE);
    let green = |scene: &Scene, method, spp| {
        let seeds = 0..4;
        let seen = seeds.map(|seed| {
            let settings = RenderSettings {
                seed,
                ..settings(method, SIDE, spp)
            };
            means(&picture(scene, &settings))[1]
        });
        seen.sum::<f64>() / 4.0
    };
    let half = 0.5 * green(&still, Method::Path, 256);
    for scale in [[0.0; 3], [1.0, 0.0, 1.0]] {
        let scene = compile(&flashing(scale), SIDE);
        for (method, spp) in [
            (Method::Path, 256),
            (Method::Light, 512),
            (Method::Bdpt, 128),
            (Method::Pssmlt, 512),
            (Method::Mlt, 1024),
            (Method::Erpt, 64),
        ] {
            let found = green(&scene, method, spp);
            let share = found / half - 1.0;
            assert!(share.abs() < 0.06, "{method}, {scale:?}: {share:+.3}");
        }
    }
}

fn verdict(a: &[Tile], b: &[Tile]) -> Verdict {
    agree(a, b, |_| true, 0.1)
}

/// Samples, paths from both sides, replicas, mutations of paths.
#[test]
fn methods_show_the_mean_of_still_pictures() {
    show_the_mean(&[EXACT[0], EXACT[2], EXACT[5], EXACT[7]]);
}

#[test]
#[ignore = "long"]
fn every_method_shows_the_mean_of_still_pictures() {
    show_the_mean(&EXACT);
}

fn show_the_mean(methods: &[(Method, u64)]) {
    let stills = tiles_of(SEEDS.map(mean_of_stills));
    let mut more = None;
    for &(method, spp) in methods {
        let found = verdict(&stills, &blurred(method, spp, SEEDS));
        if found.rejected.is_empty() {
            assert!(found.uncertain.is_empty(), "{method}: {found:?}");
            continue;
        }
        // One comparison in a hundred is rejected by chance: others, and more, decide.
        let more = more.get_or_insert_with(|| tiles_of(AGAIN.map(mean_of_stills)));
        let found = verdict(more, &blurred(method, spp, AGAIN));
        assert!(found.rejected.is_empty(), "{method}: {found:?}");
    }
    // The test of the test: half of the interval is another picture.
    let half = compile(&between(0.0, 0.5), SIDE);
    let half = tiles_of_seeds(&half, &settings(Method::Path, SIDE, 128), SEEDS);
    let found = verdict(&stills, &sums(half));
    assert!(!found.rejected.is_empty(), "{found:?}");
}

/// Of these the picture is blurred by the photons' discs as well: that of a moving scene is the mean of pictures that
/// `sppm` makes of still ones.
fn photons(method: Method, iterations: u64, photons: u64) -> RenderSettings {
    let mut settings = settings(method, SIDE, iterations);
    settings.options.photon.photons = Some(photons);
    settings.options.photon.burn_in = Some(64);
    // A picture of one iteration has large discs.
    settings.options.photon.reduction = None;
    settings
}

#[test]
fn photons_show_the_mean_of_still_pictures() {
    photons_show_the_mean(&[Method::Sppm, Method::PhotonSpatial]);
}

#[test]
#[ignore = "long"]
fn photon_methods_show_the_mean_of_still_pictures() {
    photons_show_the_mean(&[
        Method::PhotonVisibility,
        Method::PhotonDensity,
        Method::PhotonImage,
    ]);
}

fn photons_show_the_mean(methods: &[Method]) {
    let few = PHOTONS / 2;
    let still = |seed| sum_of_stills(seed, &photons(Method::Sppm, 1, few));
    let stills = tiles_of(SEEDS.map(still));
    let mut more = None;
    let blurred = |scene: &_, method, seeds| {
        sums(tiles_of_seeds(
            scene,
            &photons(method, ITERATIONS, few),
            seeds,
        ))
    };
    let scene = compile(&between(0.0, 1.0), SIDE);
    for &method in methods {
        let found = verdict(&stills, &blurred(&scene, method, SEEDS));
        if found.rejected.is_empty() {
            assert!(found.uncertain.is_empty(), "{method}: {found:?}");
            continue;
        }
        let more = more.get_or_insert_with(|| tiles_of(AGAIN.map(still)));
        let found = verdict(more, &blurred(&scene, method, AGAIN));
        assert!(found.rejected.is_empty(), "{method}: {found:?}");
    }
    let half = compile(&between(0.0, 0.5), SIDE);
    let found = verdict(&stills, &blurred(&half, Method::Sppm, SEEDS));
    assert!(!found.rejected.is_empty(), "{found:?}");
}

/// The room whose lamp is there for a part of the time, and then above the ceiling, where nobody sees its light.
fn switched() -> Description {
    let mut description = builtin::load("cornell").expect("a built-in scene");
    let mut instances = description.instances.iter();
    let lamp = instances.position(|instance| instance.name == "lamp");
    let lamp = lamp.expect("the lamp of the Cornell box");
    let mut jumps = joint(DVec3::ZERO);
    let places = [[0.0; 3], [0.0, 9.0, 0.0]];
    jumps.translation = channel(Interpolation::Step, &[0.0, 0.3], &places);
    description.animation.joints.push(jumps);
    description.animation.carried.push(Carried {
        load: Load::Instance(lamp),
        joint: 0,
        offset: DAffine3::IDENTITY,
    });
    let (open, close) = (0.0, 1.0);
    description.cameras[0].shutter = Some(Shutter { open, close });
    description
}

/// Chains of photons are scaled by what of the light is visible, in each iteration by that of its own instant; those that
/// were left in the dark find the light again.
#[test]
fn light_that_comes_and_goes_is_as_bright_by_chains() {
    let scene = compile(&switched(), SIDE);
    let of = |method| {
        let image = picture(&scene, &photons(method, 20, PHOTONS));
        means(&image).iter().sum::<f64>()
    };
    // Of the same seed all have the same instants.
    let independent = of(Method::Sppm);
    for method in [
        Method::PhotonVisibility,
        Method::PhotonDensity,
        Method::PhotonSpatial,
    ] {
        let ratio = of(method) / independent;
        assert!((ratio - 1.0).abs() < 0.04, "{method}: {ratio}");
    }
}

/// The same bits for any number of threads, motion or not.
#[test]
fn threads_do_not_show_in_what_moves() {
    let scene = compile(&between(0.0, 1.0), SIDE);
    let of = |method, threads| {
        let settings = RenderSettings {
            threads,
            ..settings(method, SIDE, 8)
        };
        picture(&scene, &settings)
    };
    for method in [
        Method::Path,
        Method::Pssmlt,
        Method::Relt,
        Method::Mlt,
        Method::Erpt,
        Method::Sppm,
        Method::PhotonSpatial,
        Method::MltMultistage,
        Method::PssmltMultistage,
    ] {
        let (one, four) = (of(method, 1), of(method, 4));
        assert_eq!(bits(&one), bits(&four), "{method}");
    }
}

/// A state has the time of every path: a render that was broken off goes on to the same bits.
#[test]
fn states_keep_the_time() {
    let scene = compile(&between(0.0, 1.0), SIDE);
    for method in [
        Method::Mlt,
        Method::Erpt,
        Method::Sppm,
        Method::PhotonVisibility,
        Method::MltMultistage,
    ] {
        let [half, whole] = [4, 8].map(|spp| settings(method, SIDE, spp));
        let resumed = resumed(&scene, &whole, &last_state(&scene, &half)).expect("a render");
        assert_eq!(
            bits(&resumed.image),
            bits(&picture(&scene, &whole)),
            "{method}"
        );
    }
}
