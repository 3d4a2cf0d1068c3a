//! Reading pictures of any of the known kinds, within limits.
//!
//! A file is told by its first bytes, not by its name. What it holds is taken to be Rec.709: EXR and
//! Radiance HDR linear, PNG with the sRGB curve, which is undone.

use crate::{Image, ImageError, exr, tone};
use ::image::{DynamicImage, ImageFormat};
use std::fs::File;
use std::io::{self, Cursor, Read as _};
use std::path::{Path, PathBuf};

/// What a file may cost: it is refused before more is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest file in bytes.
    pub max_file_bytes: u64,
    /// Most columns or rows (never above [`Image::MAX_SIDE`]).
    pub max_side: u32,
    /// Most samples over all channels, of 4 bytes each.
    pub max_samples: u64,
}

impl Default for Limits {
    /// Files of 2 GiB, 65,536 pixels a side, 2^28 samples (1 GiB).
    fn default() -> Self {
        Self {
            max_file_bytes: 1 << 31,
            max_side: Image::MAX_SIDE,
            max_samples: 1 << 28,
        }
    }
}

/// Which channels to keep in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// All layers.
    All,
    /// R, G and B of the main layer only: what comparisons need.
    Main,
}

/// Bytes that are not a picture that we can have.
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// None of the known kinds.
    #[error("not a picture of a known kind: expected EXR, PNG or Radiance HDR")]
    UnknownKind,
    /// The file ends too early.
    #[error("cut short at byte {at}: {what} needs {wanted} bytes, {left} are left")]
    Truncated {
        /// What was being read.
        what: &'static str,
        /// Where.
        at: usize,
        /// Bytes wanted.
        wanted: usize,
        /// Bytes there.
        left: usize,
    },
    /// A value that makes no sense.
    #[error("{what} at byte {at}: {message}")]
    Malformed {
        /// What was being read.
        what: &'static str,
        /// Where.
        at: usize,
        /// What is wrong with it.
        message: String,
    },
    /// Sound, perhaps, but not for us.
    #[error("not supported: {0}")]
    Unsupported(String),
    /// Over the limits.
    #[error("too large: {found} {what}, at most {limit} are read")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much the file announces.
        found: u64,
        /// The limit.
        limit: u64,
    },
    /// Within the limits, but more than the machine has.
    #[error("{0} samples do not fit in memory")]
    Memory(usize),
    /// Channels that do not make an image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// What the PNG or HDR decoder says.
    #[error("{0}")]
    Codec(String),
}

impl DecodeError {
    pub(crate) fn malformed(what: &'static str, at: usize, message: String) -> Self {
        Self::Malformed { what, at, message }
    }

    pub(crate) fn unsupported(what: String) -> Self {
        Self::Unsupported(what)
    }

    /// The same, with its place counted from `by` bytes earlier.
    pub(crate) fn shifted(mut self, by: usize) -> Self {
        match &mut self {
            Self::Truncated { at, .. } | Self::Malformed { at, .. } => *at += by,
            _ => {}
        }
        self
    }
}

/// A picture file that cannot be read: which, and why.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system does not give it.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not a picture that we can have.
    #[error("{}: {source}", .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: DecodeError,
    },
}

/// Reads an EXR, PNG or Radiance HDR file into linear Rec.709.
///
/// # Errors
/// If the path is not a readable regular file, or its contents are not a picture within the limits.
pub fn read(path: &Path, limits: &Limits, keep: Keep) -> Result<Image, ReadError> {
    let io = |source| ReadError::Io {
        path: path.to_owned(),
        source,
    };
    let wrong = |source| ReadError::Decode {
        path: path.to_owned(),
        source,
    };
    // Asked before it is opened: opening a pipe would wait for its other end.
    let metadata = std::fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(io(io::Error::other("not a regular file")));
    }
    let too_large = |found| DecodeError::TooLarge {
        what: "bytes",
        found,
        limit: limits.max_file_bytes,
    };
    if metadata.len() > limits.max_file_bytes {
        return Err(wrong(too_large(metadata.len())));
    }
    let mut bytes = Vec::new();
    let length = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
    bytes
        .try_reserve_exact(length)
        .map_err(|_| wrong(DecodeError::Memory(length)))?;
    // The file may have grown since it was asked: no further than the limit.
    let file = File::open(path).map_err(io)?;
    file.take(limits.max_file_bytes)
        .read_to_end(&mut bytes)
        .map_err(io)?;
    decode(&bytes, limits, keep).map_err(wrong)
}

/// As [`read()`], from bytes in memory.
///
/// # Errors
/// If the bytes are not a picture within the limits.
pub fn decode(bytes: &[u8], limits: &Limits, keep: Keep) -> Result<Image, DecodeError> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr::decode(bytes, limits, keep)
    } else if bytes.starts_with(b"\x89PNG") {
        decode_by_image(bytes, ImageFormat::Png, limits)
    } else if bytes.starts_with(b"#?") {
        decode_by_image(bytes, ImageFormat::Hdr, limits)
    } else {
        Err(DecodeError::UnknownKind)
    }
}

/// PNG and HDR, decoded by the image crate within its own limits. An alpha channel is dropped.
fn decode_by_image(
    bytes: &[u8],
    format: ImageFormat,
    limits: &Limits,
) -> Result<Image, DecodeError> {
    let codec = |error: ::image::ImageError| DecodeError::Codec(error.to_string());
    let side = limits.max_side.min(Image::MAX_SIDE);
    let mut fence = ::image::Limits::default();
    fence.max_image_width = Some(side);
    fence.max_image_height = Some(side);
    fence.max_alloc = Some(limits.max_samples.saturating_mul(4));
    let reader = || {
        let mut reader = ::image::ImageReader::with_format(Cursor::new(bytes), format);
        reader.limits(fence.clone());
        reader
    };
    let (width, height) = reader().into_dimensions().map_err(codec)?;
    let samples = u64::from(width) * u64::from(height) * 3;
    if samples > limits.max_samples || width.max(height) > side {
        return Err(DecodeError::TooLarge {
            what: "samples",
            found: samples,
            limit: limits.max_samples,
        });
    }
    let decoded = reader().decode().map_err(codec)?;
    let pixels = width as usize * height as usize;
    Ok(Image::from_rgb(width, height, linear(decoded, pixels)?)?)
}

/// Its pixels, so many of them, with the sRGB curve undone where they are whole numbers.
fn linear(decoded: DynamicImage, count: usize) -> Result<[Vec<f32>; 3], DecodeError> {
    match &decoded {
        DynamicImage::ImageRgb8(_)
        | DynamicImage::ImageRgba8(_)
        | DynamicImage::ImageLuma8(_)
        | DynamicImage::ImageLumaA8(_) => {
            let curve: [f32; 256] =
                std::array::from_fn(|code| tone::from_srgb(code as f64 / 255.0) as f32);
            let rgb = decoded.into_rgb8();
            planes(
                count,
                rgb.pixels()
                    .map(|pixel| pixel.0.map(|code| curve[usize::from(code)])),
            )
        }
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let rgb = decoded.into_rgb32f();
            planes(count, rgb.pixels().map(|pixel| pixel.0))
        }
        _ => {
            let linear = |code| tone::from_srgb(f64::from(code) / 65535.0) as f32;
            let rgb = decoded.into_rgb16();
            planes(count, rgb.pixels().map(|pixel| pixel.0.map(linear)))
        }
    }
}

/// Pixels into three planes.
fn planes(
    count: usize,
    pixels: impl Iterator<Item = [f32; 3]>,
) -> Result<[Vec<f32>; 3], DecodeError> {
    let mut planes = [Vec::new(), Vec::new(), Vec::new()];
    for plane in &mut planes {
        reserve(plane, count)?;
    }
    for pixel in pixels {
        for (plane, value) in planes.iter_mut().zip(pixel) {
            plane.push(value);
        }
    }
    Ok(planes)
}

/// Room for this many samples, or an error.
pub(crate) fn reserve(plane: &mut Vec<f32>, count: usize) -> Result<(), DecodeError> {
    plane
        .try_reserve_exact(count)
        .map_err(|_| DecodeError::Memory(count))
}
