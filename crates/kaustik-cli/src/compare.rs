//! `kaustik compare`.

use std::path::Path;
use std::process::ExitCode;

use kaustik::film::{self, Image, Keep, Limits, metrics};

use crate::arguments::CompareWords;
use crate::{Failure, output};

pub(crate) fn run(words: &CompareWords) -> Result<ExitCode, Failure> {
    let (reference, images) = words
        .images
        .split_last()
        .ok_or_else(|| Failure::Input("expected pictures and a reference".to_owned()))?;
    let reference = read(reference)?;
    let half = words.half.as_deref().map(read).transpose()?;
    if half
        .as_ref()
        .is_some_and(|half| half.rgb() == reference.rgb())
    {
        return Err(Failure::Input(
            "the two halves of the reference are the same picture: expected two of other seeds"
                .to_owned(),
        ));
    }
    let names: Vec<String> = images
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let images = images
        .iter()
        .map(|path| read(path))
        .collect::<Result<Vec<_>, _>>()?;
    let pairs: Vec<(&str, &Image)> = names.iter().map(String::as_str).zip(&images).collect();
    let report = metrics::compare(&pairs, &reference, half.as_ref()).map_err(Failure::input)?;
    if words.json {
        let text = serde_json::to_string_pretty(&report).map_err(Failure::other)?;
        output::print(&(text + "\n"))?;
    } else {
        output::print(&format!("{report}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn read(path: &Path) -> Result<Image, Failure> {
    film::read(path, &Limits::default(), Keep::Main).map_err(Failure::input)
}
