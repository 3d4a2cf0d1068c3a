//! The scale of a chain's picture: within the error that it states, whatever the seed.

use kaustik::{Control, Direct, Method, RenderSettings, render};

use crate::support::{scene, settings};

const SEEDS: u64 = 16;
/// 0.001 and 0.999 quantiles of chi-square with 15 degrees of freedom.
const BOUNDS: std::ops::Range<f64> = 3.48..37.7;

/// Estimates of the normalisation with their standard errors.
fn normalisations(settings: &RenderSettings) -> Vec<[f64; 2]> {
    let scene = scene("cornell", settings.width);
    let of_seed = |seed| {
        let settings = RenderSettings {
            seed,
            ..settings.clone()
        };
        let done = render(&scene, &settings, &mut Control::default()).expect("a render");
        let chain = done.statistics.chain.expect("a chain");
        [chain.normalisation, chain.normalisation_error]
    };
    (0..SEEDS).map(of_seed).collect()
}

/// Sum of the squared distances from the mean, each in its own error times `factor`.
fn chi_square(found: &[[f64; 2]], factor: f64) -> f64 {
    let mean = found.iter().map(|[b, _]| b).sum::<f64>() / found.len() as f64;
    let off = |[b, error]: &[f64; 2]| ((b - mean) / (error * factor)).powi(2);
    found.iter().map(off).sum()
}

#[test]
fn seeds_differ_by_the_error_that_they_state() {
    for method in [Method::Pssmlt, Method::Mmlt] {
        for direct in [Direct::Together, Direct::Apart] {
            let mut settings = settings(method, 16, 400);
            settings.options.direct = direct;
            let found = normalisations(&settings);
            let right = chi_square(&found, 1.0);
            assert!(BOUNDS.contains(&right), "{method}, {direct:?}: {right}");
            // The test of the test: an error that is not the right one.
            for factor in [0.2, 5.0] {
                let wrong = chi_square(&found, factor);
                assert!(!BOUNDS.contains(&wrong), "{method}, {direct:?}: {wrong}");
            }
        }
    }
}

/// The scale goes on improving: with sixteen times the steps its error is a fraction of what it was.
#[test]
fn the_scale_goes_on_improving() {
    let error = |spp| {
        let mut settings = settings(Method::Mmlt, 16, spp);
        settings.options.pilot = 2_000;
        let found = normalisations(&settings);
        found.iter().map(|[_, error]| error).sum::<f64>() / SEEDS as f64
    };
    let (short, long) = (error(50), error(800));
    let ratio = long / short;
    assert!((0.2..0.35).contains(&ratio), "{short} to {long}: {ratio}");
}
