//! PNG files of eight bits a channel, for looking at.

use crate::atomic::{WriteError, write_file};
use crate::{Image, Tone};
use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder as _};
use std::io::{self, Write};
use std::path::Path;

/// Writes the main layer as a PNG file of sRGB colours, whole or not at all.
///
/// # Errors
/// If the file cannot be written (see [`write_file`]).
pub fn write(path: &Path, image: &Image, tone: &Tone) -> Result<(), WriteError> {
    write_file(path, |sink| encode(sink, image, tone))
}

/// Writes the main layer as PNG into anything that can be written.
///
/// Values are multiplied by 2^exposure, bent by the tone curve, clipped and rounded; three bytes a pixel
/// are allocated.
///
/// # Errors
/// What the sink says.
pub fn encode(sink: impl Write, image: &Image, tone: &Tone) -> io::Result<()> {
    let scale = tone.scale();
    let [r, g, b] = image.rgb();
    let mut codes = Vec::new();
    codes
        .try_reserve_exact(image.pixels() * 3)
        .map_err(io::Error::other)?;
    for ((r, g), b) in r.iter().zip(g).zip(b) {
        codes.extend([r, g, b].map(|&value| tone.code_scaled(value, scale)));
    }
    PngEncoder::new_with_quality(sink, CompressionType::Default, FilterType::Adaptive)
        .write_image(
            &codes,
            image.width(),
            image.height(),
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| match error {
            ::image::ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
}
