//! Whose error is lower.

use super::checks::{last, method, scene};
use crate::chart::number;
use crate::ranks::chance_to_be_so_low;
use crate::{Cell, Curve, Figure, Finding, Group, Quartiles, Results, Verdict};

/// What two methods that are compared have in common.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Terms {
    /// The study's budget: time, or so many samples a pixel.
    Budget,
    /// Time, whatever the budget is: what the claim says.
    Time,
}

/// One method against others. A pair tells nothing where the one that came out better took more than a tenth longer, as
/// methods may that go by whole passes, where an error is too small for the reference, or where the seeds lie among each other.
struct Contest<'a> {
    results: &'a Results,
    terms: Terms,
    measured: String,
    /// A pair was told, and was lost.
    lost: bool,
    /// Why a pair is not told.
    untold: Option<String>,
}

/// A method's name, pictures and figure.
struct Entrant<'a> {
    name: &'a str,
    group: &'a Group,
    value: f64,
    scatter: Scatter,
}

/// How far seeds are apart.
enum Scatter {
    /// The figure of each seed.
    Seeds(Vec<f64>),
    /// Standard error, as a share, of the one figure that all seeds have together.
    Error(f64),
}

/// So much longer is not the same time any more.
const LONGER: f64 = 1.1;
/// What comes out so by chance no oftener is told.
const LEVEL: f64 = 0.05;
/// So many standard errors apart two figures are told from each other.
const SIGMAS: f64 = 2.0;

impl<'a> Entrant<'a> {
    /// By a point of a curve.
    fn of(name: &'a str, group: &'a Group, curve: Curve) -> Option<Self> {
        match curve {
            Curve::Figure(figure) => Some(Self::of_cells(name, group, |cell| figure.of(cell))),
            Curve::Nsd => Some(Self {
                name,
                group,
                value: group.nsd?.mean,
                scatter: Scatter::Error(group.nsd_error),
            }),
        }
    }

    /// By the median of a number of each render.
    fn of_cells(name: &'a str, group: &'a Group, figure: impl Fn(&Cell) -> f64) -> Self {
        let values: Vec<f64> = group.cells.iter().map(figure).collect();
        Self {
            name,
            group,
            value: Quartiles::of(values.iter().copied()).median,
            scatter: Scatter::Seeds(values),
        }
    }

    /// Is it surely below `factor` times the other, whichever medians say so?
    fn is_told_below(&self, other: &Self, factor: f64) -> bool {
        match (&self.scatter, &other.scatter) {
            (Scatter::Seeds(ours), Scatter::Seeds(theirs)) => {
                let theirs: Vec<f64> = theirs.iter().map(|value| factor * value).collect();
                chance_to_be_so_low(ours, &theirs) <= LEVEL
            }
            (Scatter::Error(a), Scatter::Error(b)) => {
                (factor * other.value / self.value).ln() > SIGMAS * a.hypot(*b)
            }
            _ => false,
        }
    }
}

impl<'a> Contest<'a> {
    fn new(results: &'a Results, terms: Terms, measured: String) -> Self {
        Self {
            results,
            terms,
            measured,
            lost: false,
            untold: None,
        }
    }

    /// Is the figure of one at most `factor` times the other's?
    fn pair(&mut self, ours: &Entrant<'_>, theirs: &Entrant<'_>, factor: f64) {
        // With halves small errors may come out at or below zero.
        if !(ours.value > 0.0 && theirs.value > 0.0) {
            self.untold = Some("too small for this reference".to_owned());
            return;
        }
        let won = ours.value <= factor * theirs.value;
        let (better, worse) = if won { (ours, theirs) } else { (theirs, ours) };
        let [long, short] = [better, worse].map(|entrant| entrant.group.seconds());
        let in_time = self.terms == Terms::Time || self.results.study.budgets.unit.is_time();
        if in_time && long > LONGER * short {
            self.untold = Some(format!(
                "{} took {} s, {} {} s",
                better.name,
                number(long),
                worse.name,
                number(short)
            ));
            return;
        }
        let is_told = match won {
            true => ours.is_told_below(theirs, factor),
            false => theirs.is_told_below(ours, 1.0 / factor),
        };
        if !is_told {
            self.untold = Some(format!("these seeds do not tell against {}", theirs.name));
            return;
        }
        self.lost |= !won;
    }

    fn finding(self) -> Finding {
        match self.untold {
            Some(why) if !self.lost => {
                Finding::new(format!("{}; {why}", self.measured), Verdict::Open)
            }
            _ => Finding::new(self.measured, !self.lost),
        }
    }
}

/// Makes a method's entrant, if it has what is to be compared.
type Enter<'b> = dyn for<'a> Fn(&'a str, &'a Group) -> Option<Entrant<'a>> + 'b;

/// Methods at the last budget by some figure, the first against the others, each with a factor.
fn against(
    (results, terms): (&Results, Terms),
    (place, what): (&str, &str),
    enter: &Enter<'_>,
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    let found = || {
        let ours = enter(better, last(results, place, better)?)?;
        let measured = format!("{place}, {what}: {better} {}", told(results, &ours));
        let mut contest = Contest::new(results, terms, measured);
        for &(name, factor) in worse {
            let theirs = enter(name, last(results, place, name)?)?;
            let ratio = ours.value / theirs.value;
            contest.measured += &format!(", {name} {} (ratio {ratio:.2})", told(results, &theirs));
            contest.pair(&ours, &theirs, factor);
        }
        Some(contest.finding())
    };
    found().unwrap_or_else(not_rendered)
}

/// A figure in words. What is counted in samples says what they took.
fn told(results: &Results, entrant: &Entrant<'_>) -> String {
    match results.study.budgets.unit.is_time() {
        true => number(entrant.value),
        false => format!(
            "{} in {} s",
            number(entrant.value),
            number(entrant.group.seconds())
        ),
    }
}

fn not_rendered() -> Finding {
    Finding::open("not rendered")
}

/// At the last budget the median of `better` is at most `factor` times that of each of `worse`.
pub(super) fn lower(
    results: &Results,
    place: &str,
    figure: Figure,
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    lower_by(Terms::Budget, results, (place, figure), better, worse)
}

/// As [`lower`], of a claim about equal time: open where times differ, also where the budget is one of samples.
pub(super) fn lower_in_time(
    results: &Results,
    place: &str,
    figure: Figure,
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    lower_by(Terms::Time, results, (place, figure), better, worse)
}

fn lower_by(
    terms: Terms,
    results: &Results,
    (place, figure): (&str, Figure),
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    let enter: &Enter<'_> = &|name, group| Entrant::of(name, group, figure.into());
    let finding = against(
        (results, terms),
        (place, figure.name()),
        enter,
        better,
        worse,
    );
    let known = scene(results, place).map(|scene| &scene.reference);
    match known.filter(|known| !figure.cancels_noise() && known.error > known.wanted) {
        None => finding,
        Some(known) => Finding::new(
            format!(
                "{}; the reference is known to {:.1} % only",
                finding.measured,
                100.0 * known.error
            ),
            Verdict::Open,
        ),
    }
}

/// At the last budget the normalised standard deviation of `better` over its seeds is at most `factor` times
/// that of each of `worse`.
pub(super) fn lower_nsd(
    results: &Results,
    place: &str,
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    let enter: &Enter<'_> = &|name, group| Entrant::of(name, group, Curve::Nsd);
    against(
        (results, Terms::Budget),
        (place, "NSD"),
        enter,
        better,
        worse,
    )
}

/// At the last budget the root mean square relative difference of `better` over the darkest quarter of the picture is
/// below that of `worse`; that over the brightest is told beside it.
pub(super) fn lower_in_the_dark(
    results: &Results,
    place: &str,
    better: &str,
    worse: &str,
) -> Finding {
    let of_quarter = |quarter: usize, what: &str| {
        let enter: &Enter<'_> = &|name, group| {
            Some(Entrant::of_cells(name, group, |cell| {
                cell.quarters[quarter]
            }))
        };
        let terms = (results, Terms::Budget);
        against(terms, (place, what), enter, better, &[(worse, 1.0)])
    };
    let dark = of_quarter(
        0,
        "root mean square relative difference in the darkest quarter",
    );
    let bright = of_quarter(1, "in the brightest");
    Finding::new(
        format!("{}; {}", dark.measured, bright.measured),
        dark.verdict,
    )
}

/// The median of `better`, or its NSD, is below that of each of `worse` at every budget.
pub(super) fn lower_always(
    results: &Results,
    place: &str,
    curve: impl Into<Curve>,
    better: &str,
    worse: &[&str],
) -> Finding {
    let curve = curve.into();
    let Some((scene, ours)) = scene(results, place).zip(method(results, better)) else {
        return not_rendered();
    };
    let budgets = results.study.budgets.amounts.len();
    let measured = format!("{place}, {}: {better} is below", curve.name());
    let mut contest = Contest::new(results, Terms::Budget, measured);
    for &name in worse {
        let Some(theirs) = method(results, name) else {
            return not_rendered();
        };
        let entrant = |name, method, budget| Entrant::of(name, scene.group(method, budget)?, curve);
        let mut won = 0;
        for budget in 0..budgets {
            let pair = entrant(better, ours, budget).zip(entrant(name, theirs, budget));
            let Some((ours, theirs)) = pair else {
                return not_rendered();
            };
            won += usize::from(ours.value < theirs.value);
            contest.pair(&ours, &theirs, 1.0);
        }
        contest.measured += &format!(" {name} at {won} of {budgets} times;");
    }
    contest.measured = contest.measured.trim_end_matches(';').to_owned();
    contest.finding()
}

/// One of the `wanted` has the lowest median of several methods.
pub(super) fn best(
    results: &Results,
    place: &str,
    figure: Figure,
    among: &[&str],
    wanted: &[&str],
) -> Finding {
    best_by(Terms::Budget, results, (place, figure), among, wanted)
}

/// As [`best`], of a claim about equal time.
pub(super) fn best_in_time(
    results: &Results,
    place: &str,
    figure: Figure,
    among: &[&str],
    wanted: &[&str],
) -> Finding {
    best_by(Terms::Time, results, (place, figure), among, wanted)
}

fn best_by(
    terms: Terms,
    results: &Results,
    (place, figure): (&str, Figure),
    among: &[&str],
    wanted: &[&str],
) -> Finding {
    let entrant = |name| Entrant::of(name, last(results, place, name)?, figure.into());
    let found: Option<Vec<Entrant<'_>>> = among.iter().copied().map(entrant).collect();
    let Some(found) = found else {
        return not_rendered();
    };
    let parts = found
        .iter()
        .map(|entrant| format!("{} {}", entrant.name, told(results, entrant)));
    let parts: Vec<String> = parts.collect();
    let measured = format!("{place}, {}: {}", figure.name(), parts.join(", "));
    let mut contest = Contest::new(results, terms, measured);
    let is_wanted = |entrant: &&Entrant<'_>| wanted.contains(&entrant.name);
    let first = (found.iter().filter(is_wanted)).min_by(|a, b| a.value.total_cmp(&b.value));
    let Some(first) = first else {
        return not_rendered();
    };
    for other in found.iter().filter(|entrant| !is_wanted(entrant)) {
        contest.pair(first, other, 1.0);
    }
    contest.finding()
}

#[cfg(test)]
mod tests {
    use super::super::FigureScale;
    use super::super::fixture::results;
    use super::*;
    use crate::Verdict;
    use kaustik::film::metrics::Errors;

    /// Figure 4 of replica exchange, errors by method (0 is `bdpt`, 1 `pssmlt`) and seed.
    fn of(error: impl Fn(usize, usize) -> f64) -> Results {
        let figures = crate::named::find("relt")
            .unwrap()
            .figures(FigureScale::Quick);
        let figure = figures.into_iter().find(|figure| figure.number == 4);
        results(figure.unwrap().study, |method, _, seed| Errors {
            rmse_xyz: error(method, seed),
            ..Errors::default()
        })
    }

    fn verdict(results: &Results, factor: f64) -> Verdict {
        let rivals = [("pssmlt", factor)];
        lower(results, "cornell-direct", Figure::RmseXyz, "bdpt", &rivals).verdict
    }

    #[test]
    fn seeds_among_each_other_tell_nothing() {
        let apart = of(|method, seed| 1.0 + method as f64 + 0.1 * seed as f64);
        assert_eq!(verdict(&apart, 1.0), Verdict::Holds);
        assert_eq!(verdict(&apart, 0.4), Verdict::Fails);
        // The medians are 1.2 and 1.3.
        let mixed = of(|method, seed| 1.0 + 0.1 * method as f64 + 0.1 * seed as f64);
        assert_eq!(verdict(&mixed, 1.0), Verdict::Open);
        assert_eq!(verdict(&mixed, 1.5), Verdict::Holds);
        assert_eq!(verdict(&mixed, 0.6), Verdict::Fails);
    }

    #[test]
    fn noise_is_told_by_its_own_error() {
        let nsd = |ratio: f64| {
            let results = of(|method, _| if method == 0 { 1.0 } else { ratio });
            lower_nsd(&results, "cornell-direct", "bdpt", &[("pssmlt", 1.0)]).verdict
        };
        // Each is known to a percent.
        assert_eq!(nsd(1.04), Verdict::Holds);
        assert_eq!(nsd(1.02), Verdict::Open);
        assert_eq!(nsd(0.96), Verdict::Fails);
    }
}
