//! From films to a picture: a linear combination of XYZ sums, in linear Rec.709.

use crate::{Film, Image, ImageError};
use kaustik_spectrum::{Rgb, Xyz};

/// Films that cannot be developed together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DevelopError {
    /// An empty list.
    #[error("no film to develop: expected at least one")]
    Nothing,
    /// Films of different sizes.
    #[error("films differ in size or crop window: they cannot be developed together")]
    Mismatch,
    /// A factor that is NaN or infinite.
    #[error("factor {0} of a film is not finite")]
    Factor(f64),
    /// The planes do not fit in memory.
    #[error("a picture of {0} pixels does not fit in memory")]
    Memory(usize),
    /// A film larger than an image may be.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// The picture sum of factor x film over the list, in linear Rec.709 (colours outside of its gamut have
/// negative components, which are kept).
///
/// A factor is whatever turns sums into means: 1 / samples a pixel, b / mutations x pixels, ... Films may
/// differ in quantum and filter, but not in size or crop window. Sums are combined in `f64`; apart from
/// the three planes of the result nothing is allocated.
///
/// # Errors
/// An empty list, films of different size, a factor that is not finite, no memory.
pub fn develop(films: &[(&Film, f64)]) -> Result<Image, DevelopError> {
    develop_with(films, |xyz| Rgb::from(Xyz(xyz.map(|v| v as f32))).0)
}

/// As [`develop`], but the planes that come out as R, G, B hold X, Y, Z: for metrics in XYZ.
///
/// # Errors
/// As [`develop`].
pub fn develop_xyz(films: &[(&Film, f64)]) -> Result<Image, DevelopError> {
    develop_with(films, |xyz| xyz.map(|v| v as f32))
}

fn develop_with(
    films: &[(&Film, f64)],
    colour: impl Fn([f64; 3]) -> [f32; 3],
) -> Result<Image, DevelopError> {
    let layout = films.first().ok_or(DevelopError::Nothing)?.0.layout();
    let size = (layout.width, layout.height, layout.crop);
    for (film, factor) in films {
        let other = film.layout();
        if (other.width, other.height, other.crop) != size {
            return Err(DevelopError::Mismatch);
        }
        if !factor.is_finite() {
            return Err(DevelopError::Factor(*factor));
        }
    }
    let pixels = layout.crop.area() as usize;
    let mut planes = [plane(pixels)?, plane(pixels)?, plane(pixels)?];
    for pixel in 0..pixels {
        let mut xyz = [0.0; 3];
        for (film, factor) in films {
            let value = film.value(pixel);
            for c in 0..3 {
                xyz[c] += factor * value[c];
            }
        }
        for (plane, value) in planes.iter_mut().zip(colour(xyz)) {
            plane.push(value);
        }
    }
    let origin = [layout.crop.x0 as i32, layout.crop.y0 as i32];
    let image = Image::from_rgb(layout.crop.width(), layout.crop.height(), planes)?;
    Ok(image.placed(origin, [layout.width, layout.height]))
}

/// An empty plane with room for this many samples.
fn plane(pixels: usize) -> Result<Vec<f32>, DevelopError> {
    let mut plane = Vec::new();
    plane
        .try_reserve_exact(pixels)
        .map_err(|_| DevelopError::Memory(pixels))?;
    Ok(plane)
}
