//! Images: found, checked against the limits before they are decoded, decoded.

use std::io;
use std::sync::Arc;

use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};

use super::json::{Cursor, shorten};
use super::reader::Reader;
use super::{ErrorKind, LoadError, extras};
use crate::description::{ImageData, Pixels};

type Result<T> = std::result::Result<T, LoadError>;

/// Which pixels of the file each entry of `/images` became.
#[derive(Debug, Default)]
pub(super) struct Images {
    pub(super) list: Vec<Arc<ImageData>>,
    /// For each image of the file its index in `list`; `None` if its format is not read.
    pub(super) index: Vec<Option<usize>>,
}

/// Reads all images of the file. One in a format that is not read (KTX2) is left out;
/// whether that matters is seen where a texture uses it.
pub(super) fn load(reader: &mut Reader<'_>) -> Result<Images> {
    let mut images = Images::default();
    for place in reader.root.list("images")? {
        let (bytes, uri) = source(reader, &place)?;
        let Some(format) = format_of(&bytes) else {
            let found = "neither PNG, JPEG nor WebP; it is left out";
            reader.warnings.push(place.pointer(), found);
            images.index.push(None);
            continue;
        };
        let name = match place.text("name")? {
            "" => uri,
            name => name,
        };
        let mut image = decode(reader, &place, name, bytes, format)?;
        if is_generated(reader, &place)? {
            image.encoded = Vec::new();
        }
        images.index.push(Some(images.list.len()));
        images.list.push(Arc::new(image));
    }
    Ok(images)
}

/// The bytes of an image and its uri (empty if it has none, or holds the data itself).
pub(super) fn source<'a>(
    reader: &mut Reader<'a>,
    place: &Cursor<'a>,
) -> Result<(Arc<Vec<u8>>, &'a str)> {
    if let Some(uri) = place.get("uri")? {
        let bytes = reader.folder.fetch(&uri, &mut reader.budget)?;
        let text = uri.string()?;
        let is_data = text
            .get(..5)
            .is_some_and(|s| s.eq_ignore_ascii_case("data:"));
        return Ok((bytes, if is_data { "" } else { text }));
    }
    let view = place.need("bufferView").map_err(|_| {
        let found = "neither \"uri\" nor \"bufferView\"";
        place.error(ErrorKind::Value, found, "one of them")
    })?;
    let bytes = reader.buffers.view(&view)?.bytes;
    reader.budget.take(&view.pointer(), bytes.len() as u64)?;
    Ok((Arc::new(bytes.to_vec()), ""))
}

/// By content: the type that a file claims is often wrong.
pub(super) fn format_of(bytes: &[u8]) -> Option<ImageFormat> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(ImageFormat::Png),
        [0xff, 0xd8, 0xff, ..] => Some(ImageFormat::Jpeg),
        [
            b'R',
            b'I',
            b'F',
            b'F',
            _,
            _,
            _,
            _,
            b'W',
            b'E',
            b'B',
            b'P',
            ..,
        ] => Some(ImageFormat::WebP),
        _ => None,
    }
}

/// Pixels that a byte of a file can stand for: deflate repeats at most 258 bytes in 2 bits
/// and a byte holds up to 8 pixels; JPEG spends at least a bit on 64 pixels. WebP can say "all
/// alike" in a few bytes, whatever the size: it gets 4 million pixels, and more for each byte. A
/// header that claims more lies, and is refused before memory is set aside for it.
fn plausible(format: ImageFormat, bytes: usize) -> u64 {
    let (least, per_byte) = match format {
        ImageFormat::Png => (0, 8256),
        ImageFormat::WebP => (1 << 22, 4096),
        _ => (0, 512),
    };
    least + per_byte * (bytes as u64 + 64)
}

/// Decodes to four bytes a pixel. The decoder gets strict limits.
pub(super) fn decode(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    name: &str,
    bytes: Arc<Vec<u8>>,
    format: ImageFormat,
) -> Result<ImageData> {
    let fail = |e: &dyn std::fmt::Display| {
        let found = format!(
            "image data that does not decode ({})",
            shorten(&e.to_string())
        );
        place.error(
            ErrorKind::Image,
            found,
            format!("a well-formed {format:?} file"),
        )
    };
    let side = reader.options.max_image_side;
    let mut input = ImageReader::with_format(io::Cursor::new(bytes.as_slice()), format);
    input.limits(limits(side, reader.budget.left()));
    let decoder = input.into_decoder().map_err(|e| fail(&e))?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if width > side || height > side || pixels > plausible(format, bytes.len()) {
        let found = format!("an image of {width} x {height} in {} bytes", bytes.len());
        let expected = format!("sides up to {side} and data for them");
        return Err(place.error(ErrorKind::Image, found, expected));
    }
    // the decoder's own pixels (WebP's planes beside them), the converted ones, and the file kept
    // for export
    let planes = if format == ImageFormat::WebP { 2 } else { 1 };
    let scratch = decoder.total_bytes().saturating_mul(planes);
    let kept = 4 * pixels + bytes.len() as u64 + name.len() as u64;
    reader
        .budget
        .take(&place.pointer(), scratch.saturating_add(kept))?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(|e| fail(&e))?;
    reader.budget.give(scratch);
    Ok(ImageData {
        name: name.to_owned(),
        width,
        height,
        pixels: Pixels::Rgba8(decoded.into_rgba8().into_raw()),
        encoded: Arc::unwrap_or_clone(bytes),
    })
}

/// Did the exporter make the file from pixels that had none (`extras.kaustik.generated`)?
fn is_generated(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<bool> {
    let Some(ours) = place.extras()? else {
        return Ok(false);
    };
    extras::warn_of_unknown(reader, &ours, &["generated"])?;
    ours.flag("generated")
}

fn limits(side: u32, memory: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(side);
    limits.max_image_height = Some(side);
    limits.max_alloc = Some(memory);
    limits
}
