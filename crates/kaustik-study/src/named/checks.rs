//! How claims are measured.

use kaustik::film::Image;

use crate::chart::number;
use crate::{Figure, Finding, Group, Results, SceneResults, Verdict};

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

/// Luminance of a pixel, linear Rec.709.
fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

pub(super) fn luminances(planes: [&[f32]; 3]) -> Vec<f64> {
    let pixels = planes[0].iter().zip(planes[1]).zip(planes[2]);
    pixels.map(|((r, g), b)| luminance([*r, *g, *b])).collect()
}

/// Pixels of the reference in the darkest and in the brightest quarter, black ones left out.
fn quarters(reference: &Image) -> [Vec<usize>; 2] {
    let y = luminances(reference.rgb());
    let mut lit: Vec<usize> = (0..y.len()).filter(|&i| y[i] > 0.0).collect();
    lit.sort_by(|&a, &b| y[a].total_cmp(&y[b]));
    let quarter = lit.len().div_ceil(4);
    [lit[..quarter].to_vec(), lit[lit.len() - quarter..].to_vec()]
}

/// In the darkest quarter of the picture the error of `better` is below that of `worse`.
pub(super) fn lower_in_the_dark(
    results: &Results,
    place: &str,
    better: &str,
    worse: &str,
) -> Finding {
    let Some(scene) = scene(results, place) else {
        return Finding::open("not rendered");
    };
    let [dark, bright] = quarters(&scene.reference.image);
    let error = |name: &str, pixels: &[usize]| {
        let shown = scene
            .shown
            .iter()
            .find(|s| Some(s.method) == method(results, name))?;
        let squares = pixels
            .iter()
            .map(|&i| f64::from(shown.difference[i]).powi(2));
        Some((squares.sum::<f64>() / pixels.len().max(1) as f64).sqrt())
    };
    let all = [
        (better, &dark),
        (worse, &dark),
        (better, &bright),
        (worse, &bright),
    ];
    let all: Option<Vec<f64>> = all
        .iter()
        .map(|(name, pixels)| error(name, pixels))
        .collect();
    match all.as_deref() {
        Some(&[a, b, c, d]) => Finding::new(
            format!(
                "{place}, root mean square relative difference: darkest quarter {better} {}, {worse} {}; brightest \
                 quarter {}, {}",
                number(a),
                number(b),
                number(c),
                number(d)
            ),
            a < b,
        ),
        _ => Finding::open("not rendered"),
    }
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

/// Mean colours of a method and of the reference over a scene's first close-up, or the whole picture.
fn tints(results: &Results, place: &str, name: &str) -> Option<[[f64; 3]; 2]> {
    let scene_of = scene(results, place)?;
    let shown = (scene_of.shown.iter()).find(|s| Some(s.method) == method(results, name))?;
    let entry = results.study.scenes.iter().find(|s| s.name == place)?;
    let part = |image: &Image| match entry.close_ups.first() {
        Some(window) => image.cropped(*window).ok(),
        None => Some(image.clone()),
    };
    let mean = |image: &Image| {
        let image = part(image)?;
        Some(image.rgb().map(|plane| {
            plane.iter().map(|&v| f64::from(v)).sum::<f64>() / plane.len().max(1) as f64
        }))
    };
    Some([mean(&shown.image)?, mean(&scene_of.reference.image)?])
}

fn colour(rgb: [f64; 3]) -> String {
    rgb.map(number).join(" ")
}

/// Two methods have the same mean colour within a share, where the scene's close-up is.
pub(super) fn same_tint(results: &Results, place: &str, a: &str, b: &str, within: f64) -> Finding {
    match (tints(results, place, a), tints(results, place, b)) {
        (Some([ours, reference]), Some([theirs, _])) => {
            let off = |(x, y): (&f64, &f64)| (x / y - 1.0).abs();
            let most = ours.iter().zip(&theirs).map(off).fold(0.0, f64::max);
            Finding::new(
                format!(
                    "{place}, mean linear red, green, blue of the close-up: {a} {}, {b} {}, the reference {}",
                    colour(ours),
                    colour(theirs),
                    colour(reference)
                ),
                most <= within,
            )
        }
        _ => Finding::open("not rendered"),
    }
}

/// A method's colours are off against those of another: the mean colour by half a percent more, or the error.
pub(super) fn tint_differs(results: &Results, place: &str, wrong: &str, right: &str) -> Finding {
    let error = |name| {
        Some(
            last(results, place, name)?
                .quartiles(Figure::RmseXyz)
                .median,
        )
    };
    let pairs = (tints(results, place, wrong), tints(results, place, right));
    let errors = (error(wrong), error(right));
    match (pairs, errors) {
        ((Some([ours, _]), Some([theirs, reference])), (Some(bad), Some(good))) => {
            let off = |(x, y): (&f64, &f64)| (x / y - 1.0).abs();
            let most = ours.iter().zip(&theirs).map(off).fold(0.0, f64::max);
            Finding::new(
                format!(
                    "{place}, mean linear red, green, blue: {wrong} {}, {right} {}, the reference {}; {} {} and {}",
                    colour(ours),
                    colour(theirs),
                    colour(reference),
                    Figure::RmseXyz.name(),
                    number(bad),
                    number(good)
                ),
                most > 0.005 || bad > 1.1 * good,
            )
        }
        _ => Finding::open("not rendered"),
    }
}

/// Seconds of sampling a step of the chains, in one scene over another.
pub(super) fn cost_of_a_step(
    results: &Results,
    name: &str,
    (dear, cheap): (&str, &str),
    [least, most]: [f64; 2],
) -> Finding {
    let cost = |place: &str| {
        let group = last(results, place, name)?;
        let all = group.cells.first()?.statistics.pointer("/mutations")?;
        let kinds = 0..all.as_array()?.len();
        let steps: f64 = kinds
            .filter_map(|kind| group.statistic(&format!("/mutations/{kind}/proposed")))
            .sum();
        Some(group.statistic("/seconds")? / steps).filter(|cost| cost.is_finite())
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
    let stay = group.statistic("/chain/longest_stay").unwrap_or(f64::NAN);
    let measured = format!(
        "{place}, {name}: relative MSE {}, without the worst 0.1 % of the pixels {}; longest stay {stay} steps",
        number(raw),
        number(trimmed)
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
