//! Results without renders, for tests of claims.

use kaustik::film::Image;
use kaustik::film::metrics::{Errors, Measured, Nsd};

use crate::results::{Cell, Group, ReferenceResult, SceneResults, Shown};
use crate::{Results, Study};

/// Of a study whose renders have these errors by method, budget and seed, of which there are five; NSD is the first seed's RMSE, known to a
/// percent. Pictures are grey.
pub(super) fn results(mut study: Study, errors: impl Fn(usize, usize, usize) -> Errors) -> Results {
    study.seeds = (0..5).collect();
    let cell = |method, budget, seed: usize| {
        let measured = Measured {
            raw: errors(method, budget, seed),
            ..Measured::default()
        };
        Cell {
            seed: study.seeds[seed],
            seconds: study.budgets.amounts[budget],
            per_pixel: 1.0,
            measured,
            matched: measured,
            quarters: [errors(method, budget, seed).relative_mse; 2],
            colours: vec![[0.5; 3]],
            statistics: serde_json::Value::Null,
        }
    };
    let group = |method, budget| Group {
        method,
        budget,
        cells: (0..study.seeds.len())
            .map(|seed| cell(method, budget, seed))
            .collect(),
        nsd: Some(nsd(errors(method, budget, 0).rmse_xyz)),
        nsd_error: 0.01,
    };
    let budgets = study.budgets.amounts.len();
    let all = (0..study.methods.len()).flat_map(|m| (0..budgets).map(move |b| (m, b)));
    let groups: Vec<Group> = all.map(|(method, budget)| group(method, budget)).collect();
    let scene = SceneResults {
        reference: reference(&study),
        groups,
        shown: (0..study.methods.len()).map(|m| shown(&study, m)).collect(),
    };
    Results {
        scenes: vec![scene; study.scenes.len()],
        study,
    }
}

fn grey(study: &Study) -> Image {
    let plane = || vec![0.5; (study.width * study.height) as usize];
    Image::from_rgb(study.width, study.height, [plane(), plane(), plane()]).unwrap()
}

fn nsd(mean: f64) -> Nsd {
    Nsd {
        mean,
        quantile_5: mean,
        median: mean,
        quantile_95: mean,
        pooled: mean,
        pixels: 1,
        images: 2,
    }
}

fn reference(study: &Study) -> ReferenceResult {
    ReferenceResult {
        image: grey(study),
        halves: [grey(study), grey(study)],
        error: 0.01,
        wanted: 0.01,
        renders: 2,
        seconds: 1.0,
    }
}

fn shown(study: &Study, method: usize) -> Shown {
    let image = grey(study);
    Shown {
        method,
        seed: study.seeds[0],
        factor: 1.0,
        difference: vec![0.0; image.pixels()],
        nsd: None,
        error: vec![0.0; image.pixels()],
        image,
    }
}
