use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};
use crate::description::LightKind;

const POSITIVE: (f32, f32) = (0.0, f32::INFINITY);

/// What an entry of `KHR_lights_punctual` says; nodes place it.
#[derive(Clone, Debug)]
pub(super) struct Punctual {
    pub(super) name: String,
    pub(super) kind: LightKind,
    pub(super) color: [f32; 3],
    pub(super) intensity: f32,
    pub(super) range: Option<f32>,
}

/// Reads all punctual lights of the file.
pub(super) fn load(reader: &mut Reader<'_>) -> Result<Vec<Punctual>, LoadError> {
    let mut lights = Vec::new();
    let Some(extension) = reader.root.extension("KHR_lights_punctual")? else {
        return Ok(lights);
    };
    for place in extension.list("lights")? {
        let mut range = place.get("range")?.map(|r| r.f32()).transpose()?;
        if range.is_some_and(|r| r <= 0.0) {
            reader.warn(&place, "a range that is not above 0 is ignored");
            range = None;
        }
        let color = reader.numbers(&place, "color", [1.0; 3], POSITIVE)?;
        let intensity = reader.number(&place, "intensity", 1.0, POSITIVE)?;
        // One that is too bright for a number would put out all others.
        if color.iter().any(|c| !(c * intensity).is_finite()) {
            let found = format!("a colour of {color:?} times an intensity of {intensity:e}");
            return Err(place.error(ErrorKind::Value, found, "a product that is a number"));
        }
        lights.push(Punctual {
            name: place.text("name")?.to_owned(),
            kind: kind(reader, &place)?,
            color,
            intensity,
            range,
        });
    }
    Ok(lights)
}

fn kind(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<LightKind, LoadError> {
    let kind = place.need("type")?;
    match kind.string()? {
        "point" => Ok(LightKind::Point),
        "directional" => Ok(LightKind::Directional),
        "spot" => spot(reader, place),
        _ => Err(kind.mismatch("point, spot or directional")),
    }
}

/// The extension wants 0 <= inner < outer <= pi/2.
fn spot(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<LightKind, LoadError> {
    let (mut inner, mut outer) = (0.0, FRAC_PI_4);
    if let Some(spot) = place.get("spot")? {
        // a little more than pi/2 is what a decimal of it may round to
        let range = (0.0, FRAC_PI_2 * 1.000_001);
        inner = reader.number(&spot, "innerConeAngle", inner, range)?;
        outer = reader.number(&spot, "outerConeAngle", outer, range)?;
        if inner > outer {
            reader.warn(
                &spot,
                "the inner cone is the wider one; the outer one is used for both",
            );
            inner = outer;
        }
    }
    Ok(LightKind::Spot { inner, outer })
}
