//! Sums that are cut at a joint against those over the whole path.

use kaustik_mcmc::generator;
use kaustik_path::PureSpecular;

use super::{PathSpace, Seeds};
use crate::Path;
use crate::tests::space;
use crate::tests::stage::{scaled, scene, stage};

const SCENES: [&str; 16] = [
    "diffuse",
    "glossy",
    "glass",
    "frosted",
    "inlay",
    "point",
    "sun",
    "point-glass",
    "sun-glass",
    "sky",
    "daylight",
    "lens",
    "orthographic",
    "outlook",
    "veil",
    "lamps",
];

/// The weights of all paths of the last sample, each path put together and weighed as a whole; how many there are.
fn weighed_as_wholes(seeds: &mut Seeds<'_>, space: &PathSpace<'_>, escaped: bool) -> (f64, usize) {
    let (most_s, most_t) = (seeds.light_survival.len(), seeds.eye_survival.len());
    let (mut sum, mut count) = (0.0, 0);
    for t in 1..=most_t {
        for s in 0..=most_s {
            if !seeds.may_join(space, [s, t], escaped) || !seeds.join(space, [s, t]) {
                continue;
            }
            seeds.write([s, t], Default::default());
            if !space.evaluate(&mut seeds.joined) {
                continue;
            }
            let path = &seeds.joined;
            let pure = (1..path.edges()).all(|i| path.is_specular(i));
            assert!(space.settings.pure_specular.admits(pure));
            sum += path.density / (space.all_ways(path, 0, s + t) * seeds.survival([s, t]));
            count += 1;
        }
    }
    (sum, count)
}

#[test]
fn a_weight_is_that_of_the_whole_path() {
    let rules = [PureSpecular::Kept, PureSpecular::LeftOut];
    for (pure_specular, name) in rules
        .into_iter()
        .flat_map(|rule| SCENES.map(|name| (rule, name)))
    {
        let scene = scene(name);
        let mut space = space(&scene, 8);
        space.settings.pure_specular = pure_specular;
        let mut seeds = Seeds::new(&space);
        let mut path = Path::default();
        let mut rng = generator(11, 0);
        let mut paths = 0;
        for _ in 0..500 {
            let sum = seeds.sample(&mut path, &mut rng);
            let last = seeds.eye.len() - seeds.eye_survival.len();
            let escaped = seeds.eye.at(last).is_environment();
            let (wanted, count) = weighed_as_wholes(&mut seeds, &space, escaped);
            assert!(
                (sum - wanted).abs() <= 1e-9 * wanted,
                "{name}, {pure_specular:?}: {sum}, {wanted}"
            );
            paths += count;
            // two ends that see each other are as purely specular as a path can be
            let kept = pure_specular == PureSpecular::Kept;
            assert!(kept || !seeds.may_join(&space, [1, 1], escaped), "{name}");
        }
        assert!(paths > 500, "{name}: {paths}");
    }
}

/// The same numbers make the same paths in any unit of length, and these weigh the same.
#[test]
fn weights_do_not_depend_on_the_unit_of_length() {
    const POWER: f32 = 1024.0; // roundings are the same
    for name in SCENES {
        let sums = [1.0, 1.0 / POWER, POWER].map(|unit| {
            let scene = scaled(stage(name), unit).build();
            let space = space(&scene, 8);
            let mut seeds = Seeds::new(&space);
            let mut path = Path::default();
            let mut rng = generator(12, 0);
            let sample = |_| seeds.sample(&mut path, &mut rng);
            (0..500).map(sample).collect::<Vec<f64>>()
        });
        let [plain, small, large] = &sums;
        for (i, &wanted) in plain.iter().enumerate() {
            for found in [small[i], large[i]] {
                assert!(
                    (found - wanted).abs() <= 1e-6 * wanted,
                    "{name}, {i}: {found}, {wanted}"
                );
            }
        }
        assert!(
            plain.iter().filter(|&&sum| sum > 0.0).count() > 100,
            "{name}"
        );
    }
}
