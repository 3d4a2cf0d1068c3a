//! How claims are measured.

use kaustik::mcmc::Mean;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::rivals::lower;
use crate::chart::number;
use crate::parts::{Parts, luminances, quarters};
use crate::{
    Cell, Figure, Finding, Group, Quartiles, Results, SceneResults, Verdict, mean_and_error,
};

/// A scene by name with its place in the study.
pub(super) fn scene<'a>(results: &'a Results, name: &str) -> Option<&'a SceneResults> {
    let place = results
        .study
        .scenes
        .iter()
        .position(|scene| scene.name == name)?;
    results.scenes.get(place)
}

pub(super) fn method(results: &Results, name: &str) -> Option<usize> {
    results
        .study
        .methods
        .iter()
        .position(|method| method.name == name)
}

/// A method in a scene at the last budget.
pub(super) fn last<'a>(results: &'a Results, place: &str, name: &str) -> Option<&'a Group> {
    let budget = results.study.budgets.amounts.len() - 1;
    scene(results, place)?.group(method(results, name)?, budget)
}

/// Small steps are accepted about as often as the paper says: within ten points.
pub(super) fn acceptance(results: &Results, place: &str, rates: &[(&str, f64)]) -> Finding {
    let mut parts = Vec::new();
    let mut holds = true;
    for &(name, published) in rates {
        let rate = last(results, place, name).and_then(|g| g.statistic("/chain/small_acceptance"));
        let Some(rate) = rate else {
            return Finding::open("not rendered");
        };
        holds &= (rate - published).abs() <= 0.1;
        parts.push(format!("{name}: {:.1} % of small steps", 100.0 * rate));
    }
    Finding::new(parts.join("; "), holds)
}

/// A replica's share of the light is larger in the darkest quarter of the picture than in the brightest.
pub(super) fn carries_the_dark(results: &Results, place: &str, name: &str, layer: &str) -> Finding {
    let found = scene(results, place).and_then(|scene| {
        let shown = scene
            .shown
            .iter()
            .find(|s| Some(s.method) == method(results, name))?;
        let part = shown.image.layer(layer)?;
        let part = luminances([part.channel("R")?, part.channel("G")?, part.channel("B")?]);
        let whole = luminances(shown.image.rgb());
        let share = |pixels: &[usize]| {
            let sum = |of: &[f64]| pixels.iter().map(|&i| of[i]).sum::<f64>();
            sum(&part) / sum(&whole)
        };
        let [dark, bright] = quarters(&scene.reference.image);
        Some([share(&dark), share(&bright)])
    });
    match found {
        Some([dark, bright]) if dark.is_finite() && bright.is_finite() => Finding::new(
            format!(
                "{place}: {layer} holds {:.1} % of the light in the darkest quarter of the picture, {:.1} % in \
                 the brightest",
                100.0 * dark,
                100.0 * bright
            ),
            dark > bright,
        ),
        _ => Finding::open("no such layer in the picture"),
    }
}

/// A replica's annealed population has more effective particles than the first one resampled for it at once.
pub(super) fn more_effective(results: &Results, place: &str, name: &str, level: usize) -> Finding {
    let of = |which: &str| {
        let path = format!("/replicas/levels/{level}/effective_{which}");
        last(results, place, name)?.statistic(&path)
    };
    match (of("at_once"), of("annealed")) {
        (Some(at_once), Some(annealed)) => Finding::new(
            format!(
                "{place}: {annealed:.0} effective particles by annealing, {at_once:.0} by resampling at once"
            ),
            annealed > at_once,
        ),
        _ => Finding::open("not rendered, or without that replica"),
    }
}

/// The start takes less than so many seconds on every scene.
pub(super) fn starts_within(results: &Results, name: &str, limit: f64) -> Finding {
    let mut parts = Vec::new();
    let mut holds = true;
    let mut particles = None;
    for scene in &results.study.scenes {
        let group = last(results, &scene.name, name);
        let Some(seconds) = group.and_then(|g| g.statistic("/pilot_seconds")) else {
            return Finding::open("not rendered");
        };
        particles = particles.or_else(|| group?.statistic("/replicas/particles"));
        holds &= seconds < limit;
        parts.push(format!("{} {seconds:.2} s", scene.name));
    }
    let particles = particles.unwrap_or(0.0);
    let measured = format!("{particles} particles on the wall: {}", parts.join(", "));
    if particles < 10_000.0 {
        return Finding::new(measured, Verdict::Open);
    }
    Finding::new(measured, holds)
}

/// The shadow rays that a sample of one method takes, against another's.
pub(super) fn fewer_shadow_rays(
    results: &Results,
    place: &str,
    fewer: &str,
    more: &str,
) -> Finding {
    let each = |name: &str| {
        let group = last(results, place, name)?;
        Some(group.statistic("/rays/any")? / group.statistic("/steps")?)
    };
    match (each(fewer), each(more)) {
        (Some(a), Some(b)) if a.is_finite() && b > 0.0 => Finding::new(
            format!("{place}: {fewer} traces {a:.2} shadow rays a sample, {more} {b:.2}"),
            a < b,
        ),
        _ => Finding::open("not rendered, or by a version that did not count rays"),
    }
}

/// Mean colour of a close-up: red, green, blue with the standard error of each.
type Tint = [[f64; 2]; 3];

/// Of each close-up by a method, over the seeds.
fn tints(results: &Results, place: &str, name: &str) -> Option<Vec<Tint>> {
    let colours = last(results, place, name)?.cells.iter();
    tints_of(&colours.map(|cell| &cell.colours[..]).collect::<Vec<_>>())
}

/// Of each close-up by the reference, from its halves.
fn reference_tints(results: &Results, place: &str) -> Option<Vec<Tint>> {
    let entry = results.study.scenes.iter().find(|s| s.name == place)?;
    let reference = &scene(results, place)?.reference;
    let parts = Parts::of(&reference.image, &entry.close_ups);
    let halves = (reference.halves.each_ref()).map(|half| parts.colours(half));
    tints_of(&halves.each_ref().map(|colours| &colours[..]))
}

/// Of each close-up, from those of independent pictures.
fn tints_of(pictures: &[&[[f64; 3]]]) -> Option<Vec<Tint>> {
    let close_ups = pictures.first()?.len();
    let of = |close_up: usize, channel: usize| {
        let value = |colours: &&[[f64; 3]]| Some(colours.get(close_up)?[channel]);
        let values: Option<Vec<f64>> = pictures.iter().map(value).collect();
        Some(mean_and_error(&values?))
    };
    let colour = |close_up| Some([of(close_up, 0)?, of(close_up, 1)?, of(close_up, 2)?]);
    (0..close_ups).map(colour).collect()
}

fn colour(rgb: Tint) -> String {
    rgb.map(|[mean, error]| format!("{} ± {}", number(mean), number(error)))
        .join(", ")
}

/// So many standard errors apart two mean colours are told from each other.
const SIGMAS: f64 = 2.0;

/// A method has the mean colour of the reference within a share, in each of the scene's close-ups. Open where neither seeds nor
/// halves of the reference tell: a channel differs if it does so by more than the share and by twice the error of that, and none
/// does if none can by more.
pub(super) fn same_tint(results: &Results, place: &str, name: &str, within: f64) -> Finding {
    let theirs = reference_tints(results, place);
    match tints(results, place, name).zip(theirs) {
        Some((ours, theirs)) => {
            tints_agree(place, [(name, ours), ("the reference", theirs)], within)
        }
        None => Finding::open("not rendered"),
    }
}

fn tints_agree(
    place: &str,
    [(a, ours), (b, theirs)]: [(&str, Vec<Tint>); 2],
    within: f64,
) -> Finding {
    let mut parts = Vec::new();
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    let mut known = true;
    for (ours, theirs) in ours.into_iter().zip(theirs) {
        parts.push(format!("{a} {}; {b} {}", colour(ours), colour(theirs)));
        for ([x, x_error], [y, y_error]) in ours.into_iter().zip(theirs) {
            let off = (x / y - 1.0).abs();
            let error = SIGMAS * (x_error / x).hypot(y_error / y);
            // One seed has no error, and of black no share is known.
            known &= (off + error).is_finite();
            least = least.max(off - error);
            most = most.max(off + error);
        }
    }
    let verdict = match (least > within, most <= within) {
        (true, _) => Verdict::Fails,
        (_, true) if known => Verdict::Holds,
        _ => Verdict::Open,
    };
    let measured = format!(
        "{place}, mean linear red, green, blue of each close-up: {}",
        parts.join(" | ")
    );
    Finding::new(measured, verdict)
}

/// A method's colours are off against those of another: the mean colour by half a percent more in a close-up, beyond twice the error
/// of that, or the error.
pub(super) fn tint_differs(results: &Results, place: &str, wrong: &str, right: &str) -> Finding {
    let all = tints(results, place, wrong).zip(tints(results, place, right));
    let Some((ours, theirs)) = all else {
        return Finding::open("not rendered");
    };
    let tint = tints_agree(place, [(wrong, ours), (right, theirs)], 0.005);
    let rmse = lower(
        results,
        place,
        Figure::RmseXyz,
        right,
        &[(wrong, 1.0 / 1.1)],
    );
    let verdict = match (tint.verdict, rmse.verdict) {
        (Verdict::Fails, _) | (_, Verdict::Holds) => Verdict::Holds,
        (Verdict::Holds, Verdict::Fails) => Verdict::Fails,
        _ => Verdict::Open,
    };
    Finding::new(format!("{}; {}", tint.measured, rmse.measured), verdict)
}

/// At the last budget the brightness of whole pictures varies less over the seeds of one method than over another's. Told where the
/// ratio of the variances comes out so by chance once in twenty at most.
pub(super) fn steadier(results: &Results, place: &str, better: &str, worse: &str) -> Finding {
    let spread = |name: &str| {
        let cells = &last(results, place, name)?.cells;
        let brightness = |cell: &Cell| (1.0 + cell.measured.raw.bias).ln();
        let all: Mean = cells.iter().map(brightness).collect();
        let freedom = all.count().checked_sub(1).filter(|n| *n > 0)? as f64;
        Some((all.variance(), freedom)).filter(|(variance, _)| variance.is_finite())
    };
    let Some((ours, theirs)) = spread(better).zip(spread(worse)) else {
        return Finding::open("not rendered, or one seed");
    };
    let verdict = match (
        larger_by_chance(theirs, ours),
        larger_by_chance(ours, theirs),
    ) {
        (p, _) if p <= LEVEL => Verdict::Holds,
        (_, p) if p <= LEVEL => Verdict::Fails,
        _ => Verdict::Open,
    };
    let measured = format!(
        "{place}, standard deviation of the brightness over seeds: {better} {:.2} %, {worse} {:.2} %",
        100.0 * ours.0.sqrt(),
        100.0 * theirs.0.sqrt()
    );
    Finding::new(measured, verdict)
}

/// The chance that the first of two variances of normal numbers with so many degrees of freedom comes out so much larger
/// than the second though they are equal: Fisher's F.
fn larger_by_chance((a, of_a): (f64, f64), (b, of_b): (f64, f64)) -> f64 {
    let ratio = Some(a / b).filter(|ratio| !ratio.is_nan());
    let law = FisherSnedecor::new(of_a, of_b).ok();
    // Two zeros tell nothing.
    ratio.zip(law).map_or(1.0, |(ratio, law)| law.sf(ratio))
}

/// What comes out so by chance no oftener is told.
const LEVEL: f64 = 0.05;

/// Seconds that a step of the chains takes by the study's clock, less those of the start by the clock on the wall (a start of a
/// few thousand samples, a hundredth of the whole), in one scene over another.
pub(super) fn cost_of_a_step(
    results: &Results,
    name: &str,
    (dear, cheap): (&str, &str),
    [least, most]: [f64; 2],
) -> Finding {
    let each = |cell: &Cell| {
        let kinds = cell.statistics.pointer("/mutations")?.as_array()?;
        let proposed = kinds
            .iter()
            .filter_map(|kind| kind.get("proposed")?.as_f64());
        let start = cell.statistics.pointer("/pilot_seconds")?.as_f64()?;
        Some((cell.seconds - start) / proposed.sum::<f64>())
    };
    let cost = |place: &str| {
        let cells = &last(results, place, name)?.cells;
        let costs: Option<Vec<f64>> = cells.iter().map(each).collect();
        Some(Quartiles::of(costs?).median).filter(|cost| cost.is_finite())
    };
    match (cost(dear), cost(cheap)) {
        (Some(a), Some(b)) => Finding::new(
            format!(
                "{name}: a step costs {:.2} us on {dear}, {:.2} us on {cheap}: {:.2} times",
                1e6 * a,
                1e6 * b,
                a / b
            ),
            (least..=most).contains(&(a / b)),
        ),
        _ => Finding::open("not rendered"),
    }
}

/// The worst 0.1 % of the pixels do not make the error: it is at most so many times that of the others.
pub(super) fn few_spikes(results: &Results, place: &str, name: &str, most: f64) -> Finding {
    let Some(group) = last(results, place, name) else {
        return Finding::open("not rendered");
    };
    let raw = group.quartiles(Figure::RelativeMse).median;
    let trimmed = group.quartiles(Figure::RelativeMseTrimmed).median;
    let of = |cell| Figure::RelativeMse.of(cell) / Figure::RelativeMseTrimmed.of(cell);
    let ratios: Vec<f64> = group.cells.iter().map(of).collect();
    let stay = group.statistic("/chain/longest_stay").unwrap_or(f64::NAN);
    let measured = format!(
        "{place}, {name}: relative MSE {}, without the worst 0.1 % of the pixels {} ({:.2} times; by seed {:.2} to {:.2} times); \
         longest stay {stay} steps",
        number(raw),
        number(trimmed),
        raw / trimmed,
        ratios.iter().copied().fold(f64::INFINITY, f64::min),
        ratios.iter().copied().fold(0.0, f64::max)
    );
    if trimmed > 0.0 {
        Finding::new(measured, raw <= most * trimmed)
    } else {
        Finding::open(&(measured + "; too small for this reference"))
    }
}

/// A number of a method's statistics is at least so large.
pub(super) fn statistic_above(
    results: &Results,
    place: &str,
    name: &str,
    path: &str,
    least: f64,
) -> Finding {
    match last(results, place, name).and_then(|group| group.statistic(path)) {
        Some(found) => Finding::new(
            format!("{place}, {name}: {}", number(found)),
            found >= least,
        ),
        None => Finding::open("not rendered"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 6.39 is the 95th percentile of F with four and four degrees of freedom.
    #[test]
    fn variances_are_told_by_their_ratio() {
        let chance = |ratio: f64| larger_by_chance((ratio, 4.0), (1.0, 4.0));
        assert!((chance(6.388) - 0.05).abs() < 1e-4 && (chance(1.0) - 0.5).abs() < 1e-9);
        let of_zeros = larger_by_chance((0.0, 4.0), (0.0, 4.0));
        assert!(of_zeros >= 1.0 && larger_by_chance((1.0, 4.0), (0.0, 4.0)) < 1e-9);
    }

    #[test]
    fn colours_are_told_by_their_errors() {
        let agree = |red: f64, error: f64| {
            let tint = |red| vec![[[red, error], [1.0, error], [1.0, error]]];
            let both = [("a", tint(red)), ("b", tint(1.0))];
            tints_agree("somewhere", both, 0.05).verdict
        };
        assert_eq!(agree(1.02, 0.002), Verdict::Holds);
        assert_eq!(agree(1.02, 0.02), Verdict::Open);
        assert_eq!(agree(1.08, 0.002), Verdict::Fails);
        assert_eq!(agree(0.92, 0.02), Verdict::Open);
        assert_eq!(agree(1.0, f64::NAN), Verdict::Open);
    }
}
