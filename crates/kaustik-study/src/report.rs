//! The files of finished studies.

use std::path::{Path, PathBuf};

use kaustik::film::write_file;

use crate::{Axis, Curve, Results, Section, StudyError, chart, csv, page};

/// Writes tables, curves and the page into a folder that exists, and returns the page's path. Each section
/// has a word of its own, with which its tables and curves begin.
///
/// # Errors
/// What cannot be drawn or written.
pub fn write(
    folder: &Path,
    title: &str,
    sections: &[(&str, Section<'_>)],
) -> Result<PathBuf, StudyError> {
    for (word, section) in sections {
        let results = section.results;
        put(
            &folder.join(format!("{word}-cells.csv")),
            &csv::cells(results),
        )?;
        put(
            &folder.join(format!("{word}-summary.csv")),
            &csv::summary(results),
        )?;
        for scene in 0..results.scenes.len() {
            curves(folder, word, results, scene)?;
        }
    }
    let views: Vec<Section<'_>> = (sections.iter())
        .map(|(_, section)| Section {
            results: section.results,
            judged: section.judged,
        })
        .collect();
    let path = folder.join("index.html");
    put(&path, &page(title, &views)?)?;
    Ok(path)
}

/// Every curve over time and over samples. Files are named by the scene's number: a name may hold anything.
fn curves(folder: &Path, word: &str, results: &Results, scene: usize) -> Result<(), StudyError> {
    for curve in Curve::all() {
        for (axis, over) in [(Axis::Seconds, "seconds"), (Axis::Samples, "samples")] {
            if let Some(svg) = chart(results, scene, curve, axis)? {
                let name = format!("{word}-scene-{}-{}-{over}.svg", scene + 1, curve.word());
                put(&folder.join(name), &svg)?;
            }
        }
    }
    Ok(())
}

fn put(path: &Path, text: &str) -> Result<(), StudyError> {
    write_file(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}
