//! Whose error is lower.

use super::checks::{last, method, scene};
use crate::chart::number;
use crate::{Curve, Figure, Finding, Group, Results, Verdict};

/// One method against others. A pair tells nothing where the one that came out better took more than a tenth longer, as
/// methods may that go by whole passes, or where an error is too small for the reference.
struct Contest<'a> {
    results: &'a Results,
    measured: String,
    /// A pair was told, and was lost.
    lost: bool,
    /// Why a pair is not told.
    untold: Option<String>,
}

/// A method's name, pictures and figure.
#[derive(Clone, Copy)]
struct Entrant<'a> {
    name: &'a str,
    group: &'a Group,
    value: f64,
}

/// So much longer is not the same time any more.
const LONGER: f64 = 1.1;

impl<'a> Contest<'a> {
    fn new(results: &'a Results, measured: String) -> Self {
        Self {
            results,
            measured,
            lost: false,
            untold: None,
        }
    }

    /// Is the figure of one at most `factor` times the other's?
    fn pair(&mut self, ours: Entrant<'_>, theirs: Entrant<'_>, factor: f64) {
        // With halves small errors may come out at or below zero.
        if !(ours.value > 0.0 && theirs.value > 0.0) {
            self.untold = Some("too small for this reference".to_owned());
            return;
        }
        let won = ours.value <= factor * theirs.value;
        let (better, worse) = if won { (ours, theirs) } else { (theirs, ours) };
        let [long, short] = [better, worse].map(|entrant| entrant.group.seconds());
        if self.results.study.budgets.unit.is_time() && long > LONGER * short {
            self.untold = Some(format!(
                "{} took {} s, {} {} s",
                better.name,
                number(long),
                worse.name,
                number(short)
            ));
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

/// Methods at the last budget by some figure, the first against the others, each with a factor. `None`: one
/// was not rendered.
fn against(
    results: &Results,
    place: &str,
    what: &str,
    figure: &dyn Fn(&Group) -> Option<f64>,
    better: &str,
    worse: &[(&str, f64)],
) -> Option<Finding> {
    let entrant = |name| {
        let group = last(results, place, name)?;
        let value = figure(group)?;
        Some(Entrant { name, group, value })
    };
    // What is counted in samples says what they took.
    let told = |entrant: Entrant<'_>| match results.study.budgets.unit.is_time() {
        true => number(entrant.value),
        false => format!(
            "{} in {} s",
            number(entrant.value),
            number(entrant.group.seconds())
        ),
    };
    let ours = entrant(better)?;
    let measured = format!("{place}, {what}: {better} {}", told(ours));
    let mut contest = Contest::new(results, measured);
    for &(name, factor) in worse {
        let theirs = entrant(name)?;
        let ratio = ours.value / theirs.value;
        contest.measured += &format!(", {name} {} (ratio {ratio:.2})", told(theirs));
        contest.pair(ours, theirs, factor);
    }
    Some(contest.finding())
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
    let median = |group: &Group| Some(group.quartiles(figure).median);
    against(results, place, figure.name(), &median, better, worse).unwrap_or_else(not_rendered)
}

/// At the last budget the normalised standard deviation of `better` over its seeds is at most `factor` times
/// that of each of `worse`.
pub(super) fn lower_nsd(
    results: &Results,
    place: &str,
    better: &str,
    worse: &[(&str, f64)],
) -> Finding {
    let nsd = |group: &Group| Some(group.nsd?.mean);
    against(results, place, "NSD", &nsd, better, worse).unwrap_or_else(not_rendered)
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
    let mut contest = Contest::new(results, measured);
    for &name in worse {
        let Some(theirs) = method(results, name) else {
            return not_rendered();
        };
        let entrant = |name, method, budget| {
            let group = scene.group(method, budget)?;
            let value = group.point(curve)?.median;
            Some(Entrant { name, group, value })
        };
        let mut won = 0;
        for budget in 0..budgets {
            let pair = entrant(better, ours, budget).zip(entrant(name, theirs, budget));
            let Some((ours, theirs)) = pair else {
                return not_rendered();
            };
            won += usize::from(ours.value < theirs.value);
            contest.pair(ours, theirs, 1.0);
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
    let found: Option<Vec<Entrant<'_>>> = among
        .iter()
        .map(|name| {
            let group = last(results, place, name)?;
            let value = group.quartiles(figure).median;
            Some(Entrant { name, group, value })
        })
        .collect();
    let Some(found) = found else {
        return not_rendered();
    };
    let parts = found
        .iter()
        .map(|entrant| format!("{} {}", entrant.name, number(entrant.value)));
    let parts: Vec<String> = parts.collect();
    let measured = format!("{place}, {}: {}", figure.name(), parts.join(", "));
    let mut contest = Contest::new(results, measured);
    let is_wanted = |entrant: &&Entrant<'_>| wanted.contains(&entrant.name);
    let first = (found.iter().filter(is_wanted)).min_by(|a, b| a.value.total_cmp(&b.value));
    let Some(&first) = first else {
        return not_rendered();
    };
    for &other in found.iter().filter(|entrant| !is_wanted(entrant)) {
        contest.pair(first, other, 1.0);
    }
    contest.finding()
}
