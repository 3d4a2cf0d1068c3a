//! Tables as comma-separated values (RFC 4180), numbers in full.

use std::fmt::Write as _;

use crate::{Cell, Figure, Group, Results, SceneEntry, Study};

/// A row a render.
#[must_use]
pub fn cells(results: &Results) -> String {
    let mut text =
        "scene,method,settings,seed,budget,unit,seconds,samples_per_pixel,bias,bias_trimmed"
            .to_owned();
    for figure in Figure::ALL {
        let _ = write!(text, ",{}", figure.word());
    }
    text += ",small_acceptance,large_acceptance,longest_stay,normalisation,normalisation_error,nonfinite\n";
    let study = &results.study;
    for (scene, of) in study.scenes.iter().zip(&results.scenes) {
        for group in &of.groups {
            for cell in &group.cells {
                row(&mut text, study, scene, group, cell);
            }
        }
    }
    text
}

/// Adds the row of a render.
fn row(text: &mut String, study: &Study, scene: &SceneEntry, group: &Group, cell: &Cell) {
    let method = &study.methods[group.method];
    let settings = method.settings.join(" ");
    let _ = write!(
        text,
        "{},{},{},{},{},{},{},{},{},{}",
        field(&scene.name),
        field(&method.name),
        field(&format!("{} {settings}", method.method)),
        cell.seed,
        study.amount(method, group.budget),
        study.budgets.unit.name(),
        cell.seconds,
        cell.per_pixel,
        cell.measured.raw.bias,
        cell.measured.trimmed.bias,
    );
    for figure in Figure::ALL {
        let _ = write!(text, ",{}", figure.of(cell));
    }
    for path in [
        "/chain/small_acceptance",
        "/chain/large_acceptance",
        "/chain/longest_stay",
        "/chain/normalisation",
        "/chain/normalisation_error",
        "/nonfinite",
    ] {
        let number = cell.statistics.pointer(path).filter(|v| v.is_number());
        let number = number.map_or(String::new(), ToString::to_string);
        let _ = write!(text, ",{number}");
    }
    text.push('\n');
}

/// A row for each scene, method and budget: medians and quartiles over the seeds.
#[must_use]
pub fn summary(results: &Results) -> String {
    let mut text = "scene,method,budget,unit,seeds,seconds,samples_per_pixel".to_owned();
    for figure in Figure::ALL {
        let word = figure.word();
        let _ = write!(text, ",{word},{word}_lower,{word}_upper");
    }
    text += ",nsd,bias,bias_error,reference_error\n";
    let study = &results.study;
    for (scene, of) in study.scenes.iter().zip(&results.scenes) {
        for group in &of.groups {
            let method = &study.methods[group.method];
            let _ = write!(
                text,
                "{},{},{},{},{},{},{}",
                field(&scene.name),
                field(&method.name),
                study.amount(method, group.budget),
                study.budgets.unit.name(),
                group.cells.len(),
                group.seconds(),
                group.per_pixel(),
            );
            for figure in Figure::ALL {
                let q = group.quartiles(figure);
                let _ = write!(text, ",{},{},{}", q.median, q.lower, q.upper);
            }
            let nsd = group.nsd.map_or(String::new(), |nsd| nsd.mean.to_string());
            let [bias, error] = group.bias();
            let _ = writeln!(text, ",{nsd},{bias},{error},{}", of.reference.error);
        }
    }
    text
}

/// Quoted where needed. What a spreadsheet would take for a formula is made plain text.
fn field(text: &str) -> String {
    let text = match text.chars().next() {
        Some('=' | '+' | '-' | '@') => format!("'{text}"),
        _ => text.to_owned(),
    };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::field;

    #[test]
    fn fields_are_quoted() {
        assert_eq!(field("a b"), "a b");
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(field("=1+1"), "'=1+1");
    }
}
