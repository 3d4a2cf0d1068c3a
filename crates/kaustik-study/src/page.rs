//! One page that opens from disk: pictures, maps, curves and tables are inside it; it loads nothing and
//! runs nothing.

use kaustik::film::Tone;
use minijinja::{Environment, context};
use serde::Serialize;

use crate::chart::number;
use crate::figure::Figure;
use crate::layers::{Part, parts};
use crate::picture::{address, close_up, error_map, heat_gradient, signed_gradient, signed_map};
use crate::{Axis, Curve, Judged, Results, SceneResults, Shown, Study, StudyError, chart};

/// One part of a page: a study and what is to be said about it.
#[derive(Debug)]
pub struct Section<'a> {
    /// What it measured.
    pub results: &'a Results,
    /// Claims held against it; may be empty.
    pub judged: &'a [Judged],
}

#[derive(Serialize)]
struct SectionView {
    title: String,
    about: String,
    facts: String,
    claims: Vec<ClaimView>,
    scenes: Vec<SceneView>,
}

#[derive(Serialize)]
struct ClaimView {
    claim: &'static str,
    measured: String,
    verdict: &'static str,
}

#[derive(Serialize)]
struct SceneView {
    name: String,
    reference: String,
    settings: String,
    budget: String,
    columns: Vec<ColumnView>,
    charts: Vec<String>,
    header: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// Pictures under each other: a method's, or the reference's.
#[derive(Serialize)]
struct ColumnView {
    name: String,
    note: String,
    picture: String,
    close_ups: Vec<String>,
    error: String,
    nsd: String,
    signed: String,
    layers: Vec<Part>,
    is_logarithmic: bool,
}

/// The page.
///
/// # Errors
/// If a picture or the template fails.
pub fn page(title: &str, sections: &[Section<'_>]) -> Result<String, StudyError> {
    let failed = |error: minijinja::Error| StudyError::page("page", error);
    let mut environment = Environment::new();
    // a name in .html: what is put in is escaped
    environment
        .add_template("page.html", include_str!("page.html"))
        .map_err(failed)?;
    let sections: Vec<SectionView> = sections.iter().map(section).collect::<Result<_, _>>()?;
    let template = environment.get_template("page.html").map_err(failed)?;
    template
        .render(context! {
            title,
            sections,
            version => env!("CARGO_PKG_VERSION"),
            heat => heat_gradient(),
            signed => signed_gradient(),
        })
        .map_err(failed)
}

fn section(section: &Section<'_>) -> Result<SectionView, StudyError> {
    let results = section.results;
    let study = &results.study;
    let scenes = (0..results.scenes.len()).map(|index| scene(results, index));
    let claims = section.judged.iter().map(|judged| ClaimView {
        claim: judged.claim,
        measured: judged.finding.measured.clone(),
        verdict: judged.finding.verdict.word(),
    });
    let threads = match study.threads {
        0 => "all threads".to_owned(),
        1 => "one thread".to_owned(),
        n => format!("{n} threads"),
    };
    Ok(SectionView {
        title: study.title.clone(),
        about: study.about.clone(),
        facts: format!(
            "{} x {} pixels, {} seeds, {}, paths of at most {} edges.",
            study.width,
            study.height,
            study.seeds.len(),
            threads,
            study.max_depth
        ),
        claims: claims.collect(),
        scenes: scenes.collect::<Result<_, _>>()?,
    })
}

fn scene(results: &Results, index: usize) -> Result<SceneView, StudyError> {
    let study = &results.study;
    let (entry, of) = (&study.scenes[index], &results.scenes[index]);
    let reference = study.reference_of(entry);
    let mut columns = vec![reference_column(study, index, of)?];
    for shown in &of.shown {
        columns.push(column(study, index, of, shown)?);
    }
    let mut charts = Vec::new();
    let drawn = [
        (Curve::from(Figure::RmseXyz), Axis::Seconds),
        (Curve::from(Figure::RelativeMse), Axis::Seconds),
        (Curve::Nsd, Axis::Seconds),
        (Curve::from(Figure::Over10), Axis::Seconds),
        (Curve::from(Figure::RmseXyz), Axis::Samples),
        (Curve::Nsd, Axis::Samples),
    ];
    for (curve, axis) in drawn {
        charts.extend(chart(results, index, curve, axis)?);
    }
    let r = &of.reference;
    let reached = if r.error <= r.wanted {
        String::new()
    } else {
        format!(
            ", above the {} % that were wanted",
            number(100.0 * r.wanted)
        )
    };
    Ok(SceneView {
        name: entry.name.clone(),
        reference: format!(
            "{} renders of {} samples a pixel by {} in {} s; standard error of their mean {} %{reached}",
            r.renders,
            reference.per_pixel,
            reference.method,
            number(r.seconds),
            number(100.0 * r.error),
        ),
        settings: reference.settings.join(" "),
        budget: study.last_budget(),
        columns,
        charts,
        header: HEADER.to_vec(),
        rows: rows(study, of),
    })
}

const TONE: Tone = Tone {
    exposure: 0.0,
    curve: kaustik::film::ToneCurve::Srgb,
};

fn reference_column(
    study: &Study,
    index: usize,
    of: &SceneResults,
) -> Result<ColumnView, StudyError> {
    let image = &of.reference.image;
    let crops = &study.scenes[index].close_ups;
    let crops = crops.iter().map(|&window| close_up(image, window, &TONE));
    Ok(ColumnView {
        name: "reference".to_owned(),
        note: format!("standard error {} %", number(100.0 * of.reference.error)),
        picture: address(image, &TONE)?,
        close_ups: crops.collect::<Result<_, _>>()?,
        error: String::new(),
        nsd: String::new(),
        signed: String::new(),
        layers: Vec::new(),
        is_logarithmic: false,
    })
}

fn column(
    study: &Study,
    index: usize,
    of: &SceneResults,
    shown: &Shown,
) -> Result<ColumnView, StudyError> {
    let method = &study.methods[shown.method];
    let image = &shown.on_page();
    let (width, height) = (image.width(), image.height());
    let crops = &study.scenes[index].close_ups;
    let crops = crops.iter().map(|&window| close_up(image, window, &TONE));
    let layers = parts(image, &TONE)?;
    let cell = of
        .group(shown.method, study.budgets.amounts.len() - 1)
        .and_then(|group| group.cells.first());
    let is_matched = study.matched.contains(&method.name);
    let figure = match is_matched {
        true => Figure::Matched,
        false => Figure::RelativeMse,
    };
    let mut note = cell.map_or(String::new(), |cell| {
        format!(
            "{} samples a pixel, {} {}",
            number(cell.per_pixel),
            figure.name(),
            number(figure.of(cell))
        )
    });
    if is_matched {
        let factor = number(f64::from(shown.factor));
        note += &format!("; shown times {factor}, at the reference's brightness");
    }
    Ok(ColumnView {
        name: method.name.clone(),
        note,
        picture: address(image, &TONE)?,
        close_ups: crops.collect::<Result<_, _>>()?,
        error: error_map(width, height, &shown.difference)?,
        nsd: match &shown.nsd {
            Some(nsd) => error_map(width, height, nsd)?,
            None => String::new(),
        },
        signed: signed_map(width, height, &shown.difference)?,
        is_logarithmic: layers.iter().any(|part| part.is_logarithmic),
        layers,
    })
}

const HEADER: [&str; 13] = [
    "method",
    "budget",
    "seconds",
    "samples a pixel",
    "RMSE in XYZ",
    "relative MSE",
    "relative MSE, worst 0.1 % dropped",
    "relative MSE at equal brightness",
    "off by more than 5, 10, 20 %",
    "NSD",
    "bias in brightness",
    "accepted, small and large",
    "longest stay, steps",
];

fn rows(study: &Study, of: &SceneResults) -> Vec<Vec<String>> {
    let row = |group: &crate::Group| {
        let method = &study.methods[group.method];
        let spread = |figure| {
            let q = group.quartiles(figure);
            let [lower, median, upper] = [q.lower, q.median, q.upper].map(number);
            format!("{median} ({lower} to {upper})")
        };
        let percent = |figure| number(100.0 * group.quartiles(figure).median);
        let [bias, error] = group.bias().map(|b| 100.0 * b);
        let error = if error.is_nan() {
            String::new()
        } else {
            format!(" ± {error:.2}")
        };
        let rate = |kind: &str| {
            let rate = group.statistic(&format!("/chain/{kind}_acceptance"));
            rate.map_or("–".to_owned(), |rate| format!("{:.1} %", 100.0 * rate))
        };
        vec![
            method.name.clone(),
            number(study.amount(method, group.budget)),
            number(group.seconds()),
            number(group.per_pixel()),
            spread(Figure::RmseXyz),
            spread(Figure::RelativeMse),
            spread(Figure::RelativeMseTrimmed),
            spread(Figure::Matched),
            format!(
                "{}, {}, {} %",
                percent(Figure::Over5),
                percent(Figure::Over10),
                percent(Figure::Over20)
            ),
            group.nsd.map_or("–".to_owned(), |nsd| number(nsd.mean)),
            format!("{bias:+.2}{error} %"),
            format!("{}, {}", rate("small"), rate("large")),
            (group.statistic("/chain/longest_stay")).map_or("–".to_owned(), number),
        ]
    };
    of.groups.iter().map(row).collect()
}
