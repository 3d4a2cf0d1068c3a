use super::json::Cursor;
use super::reader::Reader;
use super::{LoadError, extras};
use crate::description::{Lens, Projection, Shutter};

/// What an entry of `/cameras` says; nodes place it.
#[derive(Clone, Debug)]
pub(super) struct CameraKind {
    pub(super) name: String,
    pub(super) projection: Projection,
    pub(super) lens: Option<Lens>,
    pub(super) shutter: Option<Shutter>,
}

/// Reads all cameras of the file.
pub(super) fn load(reader: &mut Reader<'_>) -> Result<Vec<CameraKind>, LoadError> {
    let mut cameras = Vec::new();
    for place in reader.root.list("cameras")? {
        let (lens, shutter) = match place.extras()? {
            Some(ours) => extras::camera(reader, &ours)?,
            None => (None, None),
        };
        cameras.push(CameraKind {
            name: place.text("name")?.to_owned(),
            projection: projection(&place)?,
            lens,
            shutter,
        });
    }
    Ok(cameras)
}

fn projection(place: &Cursor<'_>) -> Result<Projection, LoadError> {
    let kind = place.need("type")?;
    match kind.string()? {
        "perspective" => {
            let place = place.need("perspective")?;
            let aspect_ratio = match place.get("aspectRatio")? {
                Some(ratio) => Some(above(&ratio, 0.0, f32::INFINITY, "a ratio above 0")?),
                None => None,
            };
            let yfov = place.need("yfov")?;
            let expected = "an angle above 0 and below pi";
            let yfov = above(&yfov, 0.0, std::f32::consts::PI, expected)?;
            Ok(Projection::Perspective { yfov, aspect_ratio })
        }
        "orthographic" => {
            let place = place.need("orthographic")?;
            // the sign would mirror the picture; only the size is meant
            let size = |key| match place.need(key)?.f32()?.abs() {
                size if size > 0.0 => Ok(size),
                _ => Err(place.need(key)?.mismatch("half an extent other than 0")),
            };
            Ok(Projection::Orthographic {
                xmag: size("xmag")?,
                ymag: size("ymag")?,
            })
        }
        _ => Err(kind.mismatch("perspective or orthographic")),
    }
}

fn above(place: &Cursor<'_>, least: f32, most: f32, expected: &str) -> Result<f32, LoadError> {
    let value = place.f32()?;
    if value > least && value < most {
        return Ok(value);
    }
    Err(place.mismatch(expected))
}
