use std::sync::Arc;

use glam::Quat;

use super::json::{Cursor, shorten};
use super::reader::Reader;
use super::{ErrorKind, LoadError, extras, image};
use crate::description::{EnvironmentDescription, ImageData, Pixels};
use crate::environment::decode_hdr;
use crate::texture::{SRGB, SRGB_16};

type Result<T> = std::result::Result<T, LoadError>;

/// Keys of scenes, and of an environment with an image.
const SCENE: [&str; 1] = ["environment"];
const IMAGE: [&str; 7] = [
    "uri",
    "bufferView",
    "mimeType",
    "name",
    "strength",
    "rotation",
    "generated",
];

/// Reads `extras.kaustik.environment` of a scene: `[r, g, b]`, or an object with the image's
/// `uri` or `bufferView` (Radiance HDR, PNG or JPEG), `strength` and `rotation` (a unit
/// quaternion x, y, z, w).
pub(super) fn load<'a>(
    reader: &mut Reader<'a>,
    scene: &Cursor<'a>,
) -> Result<Option<EnvironmentDescription>> {
    let Some(ours) = scene.extras()? else {
        return Ok(None);
    };
    extras::warn_of_unknown(reader, &ours, &SCENE)?;
    let Some(place) = ours.get("environment")? else {
        return Ok(None);
    };
    if place.is_array() {
        let color = place.floats()?;
        if color.iter().any(|&c| c < 0.0) {
            return Err(place.mismatch("a radiance of 0 or more"));
        }
        return Ok(Some(EnvironmentDescription::Constant(color)));
    }
    if !place.is_object() {
        return Err(place.mismatch("[r, g, b], or an object with \"uri\""));
    }
    extras::warn_of_unknown(reader, &place, &IMAGE)?;
    let mut image = picture(reader, &place)?;
    if place.flag("generated")? {
        image.encoded = Vec::new();
    }
    Ok(Some(EnvironmentDescription::Image {
        image: Arc::new(image),
        strength: reader.number(&place, "strength", 1.0, (0.0, f32::INFINITY))?,
        rotation: rotation(&place)?,
    }))
}

/// Kept with its bits; the length must be 1 to within rounding.
pub(super) fn rotation(place: &Cursor<'_>) -> Result<Quat> {
    let xyzw: [f32; 4] = place.floats_or("rotation", [0.0, 0.0, 0.0, 1.0])?;
    let length: f32 = xyzw.iter().map(|q| q * q).sum();
    if (length - 1.0).abs() > 1e-3 {
        return Err(place.need("rotation")?.mismatch("a quaternion of length 1"));
    }
    Ok(Quat::from_array(xyzw))
}

/// A picture with radiances in the place of colours that are coded.
fn with_radiances(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    mut picture: ImageData,
) -> Result<ImageData> {
    let (values, bytes_each) = match &picture.pixels {
        Pixels::Rgba8(bytes) => (bytes.len(), 1),
        Pixels::Rgba16(values) => (values.len(), 2),
        Pixels::RgbF32(_) => return Ok(picture),
    };
    reader.budget.take_many(&place.pointer(), values / 4, 12)?;
    picture.pixels = radiances(&picture.pixels);
    reader.budget.give(bytes_each * values as u64);
    Ok(picture)
}

/// Coded pixels as what they are meant to show, alpha left out.
pub(super) fn radiances(pixels: &Pixels) -> Pixels {
    /// Of four values a pixel the first three.
    fn colours<T>(values: &[T]) -> impl Iterator<Item = &T> {
        values.chunks_exact(4).flat_map(|pixel| &pixel[..3])
    }
    let decoded = match pixels {
        Pixels::Rgba8(bytes) => colours(bytes).map(|&c| SRGB[usize::from(c)]).collect(),
        Pixels::Rgba16(values) => (colours(values).map(|&c| SRGB_16[usize::from(c)])).collect(),
        Pixels::RgbF32(values) => values.clone(),
    };
    Pixels::RgbF32(decoded)
}

fn picture<'a>(reader: &mut Reader<'a>, place: &Cursor<'a>) -> Result<ImageData> {
    let (bytes, uri) = image::source(reader, place)?;
    let name = match place.text("name")? {
        "" => uri,
        name => name,
    };
    if let Some(format) = image::format_of(&bytes) {
        let picture = image::decode(reader, place, name, bytes, format)?;
        return with_radiances(reader, place, picture);
    }
    // RGBE spends at least a byte on some 32 pixels; a pixel takes 12, and 12 while decoding
    let most = (bytes.len() as u64).saturating_mul(32 * 24);
    let most = most.min(24 << 25);
    reader.budget.take(&place.pointer(), most)?;
    let decoded = decode_hdr(name, &bytes).map_err(|e| {
        let found = format!(
            "a picture that does not decode ({})",
            shorten(&e.to_string())
        );
        place.error(ErrorKind::Image, found, "Radiance HDR, PNG or JPEG")
    })?;
    if decoded.cleaned > 0 {
        let message = format!(
            "{} values were negative, infinite or no numbers",
            decoded.cleaned
        );
        reader.warn(place, message);
    }
    let mut picture = decoded.image;
    let kept = 12 * u64::from(picture.width) * u64::from(picture.height);
    reader.budget.give(most.saturating_sub(kept));
    reader.budget.take(&place.pointer(), bytes.len() as u64)?;
    picture.encoded = Arc::unwrap_or_clone(bytes);
    Ok(picture)
}
