use kaustik_mcmc::{Independent, Mean, generator};
use kaustik_scene::{Scene, SceneOptions, builtin};
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

fn room() -> Scene {
    let description = builtin::load("furnace?kind=diffuse").expect("a built-in scene");
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    Scene::new(&description, &options).expect("a sound scene")
}

/// X + Y + Z of a white emission of strength 1.
fn white() -> f64 {
    let spectrum = |nm: f64| f64::from(Illuminant::D65.at(nm as f32));
    kaustik_spectrum::integrate_xyz(spectrum).iter().sum()
}

fn off(mean: &Mean, expected: f64) -> f64 {
    (mean.mean() - expected).abs() / mean.standard_error()
}

/// Where emission and reflectance are 1/2, paths of k edges bring 2^-k: whichever strategy makes
/// them.
#[test]
fn every_strategy_alone_brings_the_same() {
    let scene = room();
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
    for _ in 0..60_000 {
        let mut witness = Unweighted::default();
        let first = kaustik_pss::Coordinates::get(&mut u, kaustik_pss::Stream::Wavelength, 0);
        witness.wavelengths = Some(Wavelengths::sample(first, WavelengthSampling::Hero));
        let mut given = First {
            first,
            rest: &mut u,
        };
        Workspace::with(|w| builder.evaluate(&scene, &mut given, &mut out, w, &mut witness));
        for (means, sums) in means.iter_mut().zip(witness.sums) {
            for (mean, sum) in means.iter_mut().zip(sums) {
                mean.push(sum);
            }
        }
        whole.push(witness.whole);
        wrong.push(witness.wrong);
    }
    for edges in 1..=EDGES as usize {
        let expected = white() * 0.5_f64.powi(edges as i32);
        for s in 0..=edges {
            let t = edges + 1 - s;
            let used = edges > 1 || s == 0;
            let mean = &means[s][t];
            if used {
                assert!(
                    off(mean, expected) < 4.5,
                    "({s}, {t}): {mean:?}, {expected}"
                );
                assert!(
                    mean.standard_error() < 0.03 * expected,
                    "({s}, {t}): {mean:?}"
                );
            } else {
                assert!(mean.mean() == 0.0, "({s}, {t}) is no strategy");
            }
        }
    }
    let expected = white() * (1.0 - 0.5_f64.powi(EDGES as i32));
    assert!(off(&whole, expected) < 4.5, "{whole:?}, {expected}");
    // The test of the test.
    assert!(off(&wrong, expected) > 10.0, "{wrong:?}, {expected}");
}

/// Gives a wavelength that is known already, then passes on.
struct First<'a> {
    first: f64,
    rest: &'a mut dyn kaustik_pss::Coordinates,
}

impl kaustik_pss::Coordinates for First<'_> {
    fn get(&mut self, stream: kaustik_pss::Stream, index: u32) -> f64 {
        if stream == kaustik_pss::Stream::Wavelength {
            self.first
        } else {
            self.rest.get(stream, index)
        }
    }
}
