//! What is claimed of all times and all scenes.

use super::checks::{method, scene};
use crate::chart::number;
use crate::{Figure, Finding, Results, Verdict};

/// Holds if the claim does in each of the scenes, and fails if it fails in one.
pub(super) fn everywhere(places: &[&str], check: impl Fn(&str) -> Finding) -> Finding {
    let findings: Vec<Finding> = places.iter().map(|place| check(place)).collect();
    let any = |verdict| findings.iter().any(|found| found.verdict == verdict);
    let verdict = match (any(Verdict::Fails), any(Verdict::Open)) {
        (true, _) => Verdict::Fails,
        (false, true) => Verdict::Open,
        (false, false) => Verdict::Holds,
    };
    let measured: Vec<String> = findings.into_iter().map(|found| found.measured).collect();
    Finding::new(measured.join("; "), verdict)
}

/// The median of a method's figure is lower at each budget than at the one before.
pub(super) fn falls(results: &Results, place: &str, figure: Figure, name: &str) -> Finding {
    let found = scene(results, place).zip(method(results, name));
    let values: Option<Vec<f64>> = found.and_then(|(scene, method)| {
        let budgets = 0..results.study.budgets.amounts.len();
        let median = |budget| Some(scene.group(method, budget)?.quartiles(figure).median);
        budgets.map(median).collect()
    });
    let Some(values) = values else {
        return Finding::open("not rendered");
    };
    let words: Vec<String> = values.iter().copied().map(number).collect();
    let measured = format!("{place}, {}: {name} {}", figure.name(), words.join(", "));
    if values.iter().any(|value| *value <= 0.0) {
        return Finding::open(&(measured + "; too small for this reference"));
    }
    Finding::new(measured, values.windows(2).all(|pair| pair[1] < pair[0]))
}

#[cfg(test)]
mod tests {
    use super::super::FigureScale;
    use super::super::fixture::results;
    use super::super::rivals::lower_always;
    use super::*;
    use crate::Curve;
    use kaustik::film::metrics::Errors;

    /// Figure 8 of the spatial target: three methods, two budgets.
    fn of(error: impl Fn(usize, usize) -> f64) -> Results {
        let figures = crate::named::find("spatial-target")
            .unwrap()
            .figures(FigureScale::Quick);
        let figure = figures.into_iter().find(|figure| figure.number == 8);
        results(figure.unwrap().study, |method, budget, _| Errors {
            rmse_xyz: error(method, budget),
            ..Errors::default()
        })
    }

    #[test]
    fn errors_that_rise_do_not_fall() {
        let verdict = |errors: [f64; 2]| {
            let results = of(|_, budget| errors[budget]);
            falls(&results, "villa", Figure::RmseXyz, "spatial").verdict
        };
        assert_eq!(verdict([2.0, 1.0]), Verdict::Holds);
        assert_eq!(verdict([1.0, 2.0]), Verdict::Fails);
        assert_eq!(verdict([1.0, 0.0]), Verdict::Open);
    }

    #[test]
    fn one_scene_is_enough_to_fail() {
        let of = |verdicts: [Verdict; 2]| {
            let check = |place: &str| Finding::new(place.to_owned(), verdicts[place.len() - 1]);
            everywhere(&["a", "bb"], check)
        };
        let [holds, fails, open] = [Verdict::Holds, Verdict::Fails, Verdict::Open];
        assert_eq!(of([holds, holds]), Finding::new("a; bb".to_owned(), holds));
        assert_eq!(of([holds, open]).verdict, open);
        assert_eq!(of([open, fails]).verdict, fails);
    }

    #[test]
    fn noise_is_compared_at_every_time() {
        let verdict = |first: [f64; 2]| {
            let results = of(|method, budget| if method == 2 { first[budget] } else { 2.0 });
            let rivals = ["sppm", "visibility"];
            lower_always(&results, "canyon", Curve::Nsd, "spatial", &rivals).verdict
        };
        assert_eq!(verdict([1.0, 1.0]), Verdict::Holds);
        assert_eq!(verdict([3.0, 1.0]), Verdict::Fails);
    }
}
