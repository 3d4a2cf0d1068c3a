//! Of a lamp that fills a small part of a pixel each cell shows one of two estimates, and shows it once.

use super::*;
use crate::Method;
use crate::small;

const SIDE: u32 = 16;
const SEEDS: u64 = 8;

/// The brightness of what is seen directly after so many passes and one, `change` made to the lamps before them: mean over
/// several seeds, and its standard error.
fn brightness(words: &str, passes: u64, change: fn(&mut Lamps<'_>)) -> [f64; 2] {
    let scene = small::scene(words, [SIDE; 2]);
    let mut mean = kaustik_mcmc::Mean::new();
    for seed in 0..SEEDS {
        let settings = RenderSettings {
            seed,
            ..small::settings(Method::Relt, [SIDE; 2])
        };
        let lamps = Lamps::new(&scene, &settings).expect("lamps");
        let mut lamps = lamps.expect("of this method");
        change(&mut lamps);
        lamps.film.clear();
        lamps.passes = 0;
        lamps.keep_up(passes * lamps.each * lamps.pixels);
        let (film, scale) = lamps.part();
        let sum: f64 = film.sums().map(|sum| sum as f64).sum();
        mean.push(sum * film.quantum().value() * scale);
    }
    [mean.mean(), mean.standard_error()]
}

#[test]
fn a_small_lamp_is_shown_once() {
    let small = "ring-and-sphere?light=0.1";
    let [mean, error] = brightness(small, 8, |lamps| assert!(lamps.by_light.each() > 0));
    assert!(error < 0.01 * mean, "{error} of {mean}");
    let rays = |lamps: &mut Lamps<'_>| lamps.by_light.take(Vec::new());
    let [by_rays, error] = brightness(small, 1024, rays);
    assert!(error < 0.15 * mean, "{error} of {mean}");
    assert!(
        (by_rays - mean).abs() < 4.0 * error,
        "{by_rays} {mean} +- {error}"
    );
    // the planted fault: cells that show emitters from their own side show what rays meet as well
    let both = |lamps: &mut Lamps<'_>| lamps.others.settings.emitters_seen = true;
    let [twice, _] = brightness(small, 1024, both);
    assert!((twice - mean).abs() > 5.0 * error, "{twice} {mean}");
}

/// What rays meet always they show without noise.
#[test]
fn inside_a_large_lamp_rays_see_to_it() {
    let scene = small::scene("cornell-direct", [64; 2]);
    let settings = small::settings(Method::Relt, [64; 2]);
    let lamps = Lamps::new(&scene, &settings).expect("lamps").expect("some");
    let mut value = Contributions::default();
    let always: Vec<u64> = (0..lamps.cells.count())
        .filter(|&cell| lamps.met(cell, &mut value) == LOOK as usize)
        .collect();
    assert!(always.len() > 4);
    assert!(!always.iter().any(|&cell| lamps.by_light.has(cell)));
}

/// Where all samples around a cell are alike there is nothing to learn: samples go to the outline.
#[test]
fn outlines_have_most_samples() {
    let scene = small::scene("cornell-direct", [128; 2]);
    let settings = small::settings(Method::Relt, [128; 2]);
    let lamps = Lamps::new(&scene, &settings).expect("lamps").expect("some");
    let mut value = Contributions::default();
    let met: Vec<usize> = (0..lamps.cells.count())
        .map(|cell| lamps.met(cell, &mut value))
        .collect();
    let side = lamps.cells.columns() as usize;
    let often = |wanted: &dyn Fn(&[usize; 9]) -> bool| {
        let mut mean = kaustik_mcmc::Mean::new();
        for (x, y) in (1..side - 1).flat_map(|y| (1..side - 1).map(move |x| (x, y))) {
            let cell = y * side + x;
            let around = std::array::from_fn(|i| met[cell + i % 3 + side * (i / 3) - side - 1]);
            if wanted(&around) {
                mean.push(lamps.often[cell] as f64);
            }
        }
        mean.mean()
    };
    let outline = often(&|around| (1..LOOK as usize).contains(&around[4]));
    let inside = often(&|around| around.iter().all(|&met| met == LOOK as usize));
    let outside = often(&|around| around.iter().all(|&met| met == 0));
    assert!(inside >= 1.0 && outside <= 1.0, "{inside} {outside}");
    assert!(outline > 4.0 * inside, "{outline} {inside}");
    // a pass has twice as many samples as there are cells
    let all: u64 = lamps.often.iter().sum();
    let cells = lamps.cells.count();
    assert!((2 * cells).abs_diff(all) < cells / 20, "{all} of {cells}");
}

/// A replay of a sample from an emitter's own side tells the splat that a pass has made of it.
#[test]
fn samples_from_the_light_are_told() {
    let scene = small::scene("ring-and-sphere?light=0.1", [SIDE; 2]);
    let settings = small::settings(Method::Relt, [SIDE; 2]);
    let lamps = Lamps::new(&scene, &settings).expect("lamps").expect("some");
    let mut value = Contributions::default();
    let mut count = 0;
    for number in FROM_LIGHT..FROM_LIGHT + lamps.by_light.each() {
        lamps.by_light.build(&scene, number, &mut value);
        let made: Vec<_> = value.splats().iter().map(|s| (s.raster, s.xyz)).collect();
        let told = lamps.replay(number).into_iter().filter_map(|event| {
            if let Event::Splat { raster, xyz, .. } = event {
                Some((raster, xyz))
            } else {
                None
            }
        });
        assert_eq!(told.collect::<Vec<_>>(), made);
        count += made.len();
    }
    assert!(count > 0);
}
