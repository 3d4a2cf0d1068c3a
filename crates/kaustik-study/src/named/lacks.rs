//! Light that a method leaves out.

use super::checks::last;
use crate::{Finding, Results, Verdict};

/// So many standard errors apart two means are told from each other.
const SIGMAS: f64 = 2.0;

/// Bias in brightness of two methods, in words, and whether the first is the darker one: open where their
/// seeds do not tell.
fn darker(results: &Results, place: &str, [dark, bright]: [&str; 2]) -> Finding {
    let bias = |name| Some(last(results, place, name)?.bias());
    let (Some([a, a_error]), Some([b, b_error])) = (bias(dark), bias(bright)) else {
        return Finding::open("not rendered");
    };
    let measured = format!(
        "{place}, brightness less the reference's: {dark} {:+.2} ± {:.2} %, {bright} {:+.2} ± {:.2} %",
        100.0 * a,
        100.0 * a_error,
        100.0 * b,
        100.0 * b_error
    );
    let clear = SIGMAS * a_error.hypot(b_error);
    let verdict = match b - a {
        d if d > clear => Verdict::Holds,
        d if d < -clear => Verdict::Fails,
        _ => Verdict::Open,
    };
    Finding::new(measured, verdict)
}

/// Without its remainder `more` lacks more of the light than `less` does.
pub(super) fn lacks_more(results: &Results, place: &str, more: &str, less: &str) -> Finding {
    darker(results, place, [more, less])
}

/// With its remainder a method has light that it lacks without it.
pub(super) fn has_again(results: &Results, place: &str, with: &str, without: &str) -> Finding {
    darker(results, place, [without, with])
}

#[cfg(test)]
mod tests {
    use super::super::FigureScale;
    use super::super::fixture::results;
    use super::*;
    use crate::named;
    use kaustik::film::metrics::Errors;

    #[test]
    fn what_is_missing_is_told_from_noise() {
        let figures = named::find("spatial-target")
            .unwrap()
            .figures(FigureScale::Quick);
        let study = figures.into_iter().find(|f| f.number == 11).unwrap().study;
        let [with, without] = ["spatial, 0.39", "no remainder, 0.39"];
        let dark = study
            .methods
            .iter()
            .position(|m| m.name == without)
            .unwrap();
        let verdict = |bias: f64, noise: f64| {
            let results = results(study.clone(), |method, _, seed| Errors {
                bias: if method == dark { bias } else { 0.0 } + noise * seed as f64,
                ..Errors::default()
            });
            has_again(&results, "tea-time", with, without).verdict
        };
        assert_eq!(verdict(-0.3, 0.01), Verdict::Holds);
        assert_eq!(verdict(0.3, 0.01), Verdict::Fails);
        assert_eq!(verdict(-0.3, 1.0), Verdict::Open);
    }
}
