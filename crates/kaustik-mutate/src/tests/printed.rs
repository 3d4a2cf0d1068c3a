//! Rule 5 alone lacks the cosine where the light departs, and nothing else. (That it must not lack it is found by
//! `faults`, where that cosine is one of the factors, and by `rules`.)

use kaustik_mcmc::{Kernel, generator};

use super::space;
use super::stage::scene;
use crate::caustic::pivot;
use crate::{CausticPerturbation, Path, Radii, RuleFive, Seeds};

#[test]
fn rule_five_lacks_a_cosine() {
    let scene = scene("gallery");
    let space = space(&scene, 5);
    let radii = Radii {
        least: 0.2,
        most: 6.0,
    };
    let exact = CausticPerturbation {
        space: &space,
        radii,
    };
    let mut seeds = Seeds::new(&space);
    let (mut x, mut rng) = (Path::default(), generator(3, 0));
    let mut z = [Path::default(), Path::default()];
    let (mut compared, mut largest) = (0, 0.0_f64);
    while compared < 500 {
        if seeds.sample(&mut x, &mut rng) <= 0.0 || !exact.suits(&x) {
            continue;
        }
        let [y, same] = &mut z;
        let ratio = exact.propose(&mut (), &x, y, &mut rng.clone()).ratio;
        let printed = RuleFive(exact).propose(&mut (), &x, same, &mut rng);
        if ratio > 0.0 {
            let pivot = pivot(&x).expect("a suited path");
            let cosines = x.at(pivot).cos_eye / y.at(pivot).cos_eye;
            assert!((printed.ratio / (ratio * cosines) - 1.0).abs() < 1e-12);
            largest = largest.max((cosines - 1.0).abs());
            compared += 1;
        } else {
            assert!(printed.ratio <= 0.0);
        }
    }
    assert!(largest > 0.05, "{largest}");
}
