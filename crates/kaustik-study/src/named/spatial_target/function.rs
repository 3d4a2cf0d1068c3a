//! The target function itself: what it looks like, and what it does over time.

use super::{FOUR, HALL, entry, spatial, sppm, study};
use crate::chart::number;
use crate::named::checks::{method, scene};
use crate::named::over_time::{everywhere, falls};
use crate::named::rivals::lower_always;
use crate::named::{FigureScale, PaperFigure};
use crate::{Claim, Curve, Figure, Finding, Results};
use kaustik::Method;

/// With what the chains follow, and how often they come, as layers.
const MAPS: [&str; 1] = ["maps=on"];

pub(super) fn three(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 3: the target and its two factors",
        "The parts of the picture are the target at the points of the last iteration, the inverse photon density of each point's \
         region, the inverse size of its disc, and the regions. The first three each go by their own largest value.",
        &[HALL],
        60.0,
    );
    study.layers = true;
    study.methods = vec![spatial(scale, "spatial", &MAPS)];
    PaperFigure {
        number: 3,
        study,
        claims: &[
            Claim {
                text: "Eq. 11: either factor lies between 0.0001 / 1.0001 and 1",
                check: |r| within_range(r, HALL, "spatial"),
            },
            Claim {
                text: "Sec. 4.4: the target's range is high; our measure: the 95th percentile of pixels is at least ten times the 5th",
                check: |r| ranges_over(r, HALL, "spatial", 10.0),
            },
        ],
    }
}

pub(super) fn eight(scale: FigureScale) -> PaperFigure {
    let mut study = study(
        scale,
        "Figure 8: the target, and errors over time",
        "The scenes and times of Figure 7. The curves are the errors over time; the parts of the spatial target's picture are the \
         target with its factors and regions at the end.",
        &FOUR,
        60.0,
    );
    study.layers = true;
    study.methods = vec![
        sppm(scale),
        entry(scale, "visibility", Method::PhotonVisibility, &MAPS),
        spatial(scale, "spatial", &MAPS),
    ];
    PaperFigure {
        number: 8,
        study,
        claims: &[
            Claim {
                text: "Fig. 8: less noise at all times than by independent photons and the visibility target, in all scenes",
                check: |r| always_lower(r, Curve::Nsd),
            },
            Claim {
                text: "Fig. 8: a lower RMSE at all times, in all scenes",
                check: |r| always_lower(r, Figure::RmseXyz.into()),
            },
            Claim {
                text: "Sec. 4.4: errors go on falling, in all scenes",
                check: |r| everywhere(&FOUR, |place| falls(r, place, Figure::RmseXyz, "spatial")),
            },
        ],
    }
}

fn always_lower(results: &Results, curve: Curve) -> Finding {
    everywhere(&FOUR, |place| {
        lower_always(results, place, curve, "spatial", &["sppm", "visibility"])
    })
}

/// A channel of the layer `target` where there is a point, smallest first.
fn values(results: &Results, place: &str, name: &str, channel: &str) -> Option<Vec<f32>> {
    let mut shown = scene(results, place)?.shown.iter();
    let shown = shown.find(|s| Some(s.method) == method(results, name))?;
    let values = shown.image.layer("target")?.channel(channel)?;
    let mut values: Vec<f32> = values.iter().copied().filter(|v| *v > 0.0).collect();
    values.sort_by(f32::total_cmp);
    (!values.is_empty()).then_some(values)
}

/// Both factors of the target keep to the range of Eq. 11.
fn within_range(results: &Results, place: &str, name: &str) -> Finding {
    const LEAST: f32 = 1e-4 / 1.000_1;
    let factors = ["density", "kernel"].map(|channel| values(results, place, name, channel));
    let [Some(density), Some(kernel)] = factors else {
        return Finding::open("not rendered, or no target in the picture");
    };
    let ends = |values: &[f32]| [values[0], values[values.len() - 1]];
    // single precision, and a quotient of two means
    let keeps = |[low, high]: [f32; 2]| low >= 0.999 * LEAST && high <= 1.001;
    let [density, kernel] = [ends(&density), ends(&kernel)];
    let words = |ends: [f32; 2]| ends.map(|v| number(f64::from(v))).join(" to ");
    Finding::new(
        format!(
            "{place}, inverse density {}, inverse kernel size {}",
            words(density),
            words(kernel)
        ),
        keeps(density) && keeps(kernel),
    )
}

/// The 95th percentile of the target over pixels is at least so many times the 5th.
fn ranges_over(results: &Results, place: &str, name: &str, least: f32) -> Finding {
    let Some(target) = values(results, place, name, "full") else {
        return Finding::open("not rendered, or no target in the picture");
    };
    let at = |q: f64| target[(q * target.len() as f64) as usize];
    let [low, high] = [at(0.05), at(0.95)];
    Finding::new(
        format!(
            "{place}, target: 5th percentile {}, 95th {} (ratio {:.1})",
            number(f64::from(low)),
            number(f64::from(high)),
            high / low
        ),
        high >= least * low,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Verdict;
    use crate::named::fixture::results;
    use kaustik::film::Layer;
    use kaustik::film::metrics::Errors;

    /// Figure 3 with this inverse density, the same at all pixels but the first row's.
    fn of(first: f32, others: f32) -> Results {
        let study = three(FigureScale::Quick).study;
        let (width, pixels) = (study.width as usize, (study.width * study.height) as usize);
        let mut results = results(study, |_, _, _| Errors::default());
        let density = |pixel| if pixel < width { first } else { others };
        let density: Vec<f32> = (0..pixels).map(density).collect();
        let target = vec![
            ("full", density.clone()),
            ("kernel", vec![1.0; pixels]),
            ("density", density),
            ("region", vec![0.0; pixels]),
        ];
        let image = &mut results.scenes[0].shown[0].image;
        image.push_layer(Layer::new("target", target)).unwrap();
        results
    }

    #[test]
    fn factors_out_of_range_are_found() {
        let verdict = |first, others| within_range(&of(first, others), HALL, "spatial").verdict;
        assert_eq!(verdict(1e-4, 1.0), Verdict::Holds);
        assert_eq!(verdict(5e-5, 1.0), Verdict::Fails);
        assert_eq!(verdict(1e-4, 1.5), Verdict::Fails);
        let bare = results(three(FigureScale::Quick).study, |_, _, _| Errors::default());
        assert_eq!(within_range(&bare, HALL, "spatial").verdict, Verdict::Open);
    }

    #[test]
    fn an_even_target_has_no_range() {
        let verdict =
            |first, others| ranges_over(&of(first, others), HALL, "spatial", 10.0).verdict;
        assert_eq!(verdict(0.1, 0.1), Verdict::Fails);
        // one of 18 rows lies above the 5th percentile, and below it
        assert_eq!(verdict(0.01, 0.5), Verdict::Holds);
        assert_eq!(verdict(0.06, 0.5), Verdict::Fails);
    }
}
