//! Images: found, checked against the limits before they are decoded, decoded.

use std::io;
use std::sync::Arc;

use image::error::DecodingError;
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::json::{Cursor, shorten};
use super::reader::Reader;
use super::{ErrorKind, LoadError, extras, idle};
use crate::description::{ImageData, Pixels};
use crate::fence::fenced;

type Result<T> = std::result::Result<T, LoadError>;

/// Which pixels of the file each entry of `/images` became.
#[derive(Debug, Default)]
pub(super) struct Images {
    pub(super) list: Vec<Arc<ImageData>>,
    /// What became of each image of the file.
    pub(super) index: Vec<Fate>,
}

/// What became of an image of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It has this index among the pixels.
    Read(usize),
    /// Its format is not read.
    Strange,
    /// Nothing looks at it.
    Idle,
}

impl Fate {
    /// Its index among the pixels.
    pub(super) fn pixels(self) -> Option<usize> {
        match self {
            Self::Read(index) => Some(index),
            Self::Strange | Self::Idle => None,
        }
    }
}

/// So many images are decoded at a time.
#[cfg(feature = "parallel")]
const BATCH: usize = 16;
#[cfg(not(feature = "parallel"))]
const BATCH: usize = 1;

/// Reads all images of the file that anything looks at. One in a format that is not read (KTX2) is left out;
/// whether that matters is seen where a texture uses it.
pub(super) fn load(reader: &mut Reader<'_>) -> Result<Images> {
    let mut images = Images::default();
    let mut waiting = Vec::new();
    let idle = idle::images(&reader.root)?;
    for (index, place) in reader.root.list("images")?.into_iter().enumerate() {
        if idle.contains(&index) {
            images.index.push(Fate::Idle);
            continue;
        }
        let next = match Encoded::find(reader, place) {
            Ok(next) => next,
            Err(error) => {
                // what is wrong with those before it is told first
                images.take(reader, &mut waiting)?;
                return Err(error);
            }
        };
        let Some(next) = next else {
            images.index.push(Fate::Strange);
            continue;
        };
        images
            .index
            .push(Fate::Read(images.list.len() + waiting.len()));
        let mut room = next.reserve(reader);
        if room.is_err() {
            // those that wait hold memory to work in: it may be what is missing
            images.take(reader, &mut waiting)?;
            room = next.reserve(reader);
        }
        waiting.push((next, room?));
        if waiting.len() == BATCH {
            images.take(reader, &mut waiting)?;
        }
    }
    images.take(reader, &mut waiting)?;
    Ok(images)
}

impl Images {
    /// Decodes all that wait, and takes them up in their order.
    fn take(
        &mut self,
        reader: &mut Reader<'_>,
        waiting: &mut Vec<(Encoded<'_>, Room)>,
    ) -> Result<()> {
        let jobs = waiting.iter().map(|(encoded, room)| encoded.job(room));
        let decoded = all_pixels(jobs.collect());
        for ((encoded, room), pixels) in waiting.drain(..).zip(decoded) {
            reader.budget.give(room.scratch);
            let place = encoded.place.clone();
            let mut image = encoded.finish(&room, pixels)?;
            if is_generated(reader, &place)? {
                image.encoded = Vec::new();
            }
            self.list.push(Arc::new(image));
        }
        Ok(())
    }
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

/// An image of the file, not decoded yet.
struct Encoded<'a> {
    place: Cursor<'a>,
    name: String,
    bytes: Arc<Vec<u8>>,
    format: ImageFormat,
}

/// What an image takes, as far as its header tells.
struct Room {
    size: [u32; 2],
    /// Bytes while it is decoded.
    scratch: u64,
    limits: Limits,
}

/// What decoding needs, and no more: it may go to another thread.
struct Job<'b> {
    bytes: &'b [u8],
    format: ImageFormat,
    limits: Limits,
}

impl<'a> Encoded<'a> {
    /// The image at a place; `None`, with a warning, if its format is not read.
    fn find(reader: &mut Reader<'a>, place: Cursor<'a>) -> Result<Option<Self>> {
        let (bytes, uri) = source(reader, &place)?;
        let Some(format) = format_of(&bytes) else {
            let found = "neither PNG, JPEG nor WebP; it is left out";
            reader.warnings.push(place.pointer(), found);
            return Ok(None);
        };
        let name = match place.text("name")? {
            "" => uri,
            name => name,
        };
        Ok(Some(Self {
            name: name.to_owned(),
            place,
            bytes,
            format,
        }))
    }

    /// Reads the header and takes the memory from the budget. The decoder gets strict limits.
    fn reserve(&self, reader: &mut Reader<'_>) -> Result<Room> {
        let (place, bytes) = (&self.place, self.bytes.len());
        let side = reader.options.max_image_side;
        let limits = limits(self.format, bytes, side, reader.budget.left());
        let job = Job {
            bytes: &self.bytes,
            format: self.format,
            limits: limits.clone(),
        };
        let decoder = job.decoder().map_err(|e| self.broken(&e))?;
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if width > side || height > side || pixels > plausible(self.format, bytes) {
            let found = format!("an image of {width} x {height} in {bytes} bytes");
            let expected = format!("sides up to {side} and data for them");
            return Err(place.error(ErrorKind::Image, found, expected));
        }
        // the decoder's own pixels and what it works with, the converted ones, and the file kept for export
        let planes = match self.format {
            ImageFormat::WebP if moves(&self.bytes) => 4, // the frame's own, a canvas, YUV and alpha
            ImageFormat::WebP => 2,
            ImageFormat::Jpeg if is_progressive(&self.bytes) => 3, // coefficients of 16 bits each
            _ => 1,
        };
        let scratch = decoder.total_bytes().saturating_mul(planes);
        let pixel = if is_wide(decoder.color_type()) { 8 } else { 4 };
        let kept = pixel * pixels + bytes as u64 + self.name.len() as u64;
        let all = scratch.saturating_add(kept);
        reader.budget.take(&place.pointer(), all)?;
        Ok(Room {
            size: [width, height],
            scratch,
            limits,
        })
    }

    fn job(&self, room: &Room) -> Job<'_> {
        Job {
            bytes: &self.bytes,
            format: self.format,
            limits: room.limits.clone(),
        }
    }

    fn finish(self, room: &Room, pixels: Decoded) -> Result<ImageData> {
        let pixels = pixels.map_err(|e| self.broken(&e))?;
        let [width, height] = room.size;
        Ok(ImageData {
            name: self.name,
            width,
            height,
            pixels,
            encoded: Arc::unwrap_or_clone(self.bytes),
        })
    }

    fn broken(&self, error: &ImageError) -> LoadError {
        let error = shorten(&error.to_string());
        let found = format!("image data that does not decode ({error})");
        let expected = format!("a well-formed {:?} file", self.format);
        self.place.error(ErrorKind::Image, found, expected)
    }
}

/// Four bytes a pixel, or four numbers of 16 bits where the file has these; or why there are none.
type Decoded = std::result::Result<Pixels, ImageError>;

/// More than eight bits a channel? What is not is kept as bytes.
fn is_wide(color: ColorType) -> bool {
    use ColorType::{L16, La16, Rgb16, Rgba16};
    matches!(color, L16 | La16 | Rgb16 | Rgba16)
}

impl<'b> Job<'b> {
    fn decoder(self) -> std::result::Result<impl ImageDecoder + 'b, ImageError> {
        let format = self.format;
        fenced(|| {
            let mut input = ImageReader::with_format(io::Cursor::new(self.bytes), self.format);
            input.limits(self.limits);
            input.into_decoder()
        })
        .unwrap_or_else(|| Err(gave_up(format)))
    }

    fn pixels(self) -> Decoded {
        let format = self.format;
        let decoder = self.decoder()?;
        let decoded = fenced(|| DynamicImage::from_decoder(decoder));
        let decoded = decoded.unwrap_or_else(|| Err(gave_up(format)))?;
        Ok(if is_wide(decoded.color()) {
            Pixels::Rgba16(decoded.into_rgba16().into_raw())
        } else {
            Pixels::Rgba8(decoded.into_rgba8().into_raw())
        })
    }
}

/// Does a WebP file say that it is an animation? It begins with "RIFF", a size, "WEBP", then the first chunk.
pub(super) fn moves(webp: &[u8]) -> bool {
    const ANIMATION: u8 = 0x02;
    webp.get(12..16) == Some(b"VP8X") && webp.get(20).is_none_or(|flags| flags & ANIMATION != 0)
}

/// Is a JPEG file a progressive one, or one of which this cannot be told? Its segments come one after the other up to the
/// header of the frame.
pub(super) fn is_progressive(jpeg: &[u8]) -> bool {
    const BASELINE: [u8; 2] = [0xc0, 0xc1];
    const OTHER_FRAMES: [u8; 11] = [
        0xc2, 0xc3, 0xc5, 0xc6, 0xc7, 0xc9, 0xca, 0xcb, 0xcd, 0xce, 0xcf,
    ];
    let mut at = 2;
    while let Some(&[0xff, marker, high, low]) = jpeg.get(at..at + 4) {
        match marker {
            0xff => at += 1, // filling
            _ if BASELINE.contains(&marker) => return false,
            _ if OTHER_FRAMES.contains(&marker) => return true,
            _ => at += 2 + usize::from(u16::from_be_bytes([high, low])),
        }
    }
    true
}

/// What a panic of a decoder becomes.
fn gave_up(format: ImageFormat) -> ImageError {
    let reason = "its decoder gave up";
    ImageError::Decoding(DecodingError::new(format.into(), reason))
}

#[cfg(feature = "parallel")]
fn all_pixels(jobs: Vec<Job<'_>>) -> Vec<Decoded> {
    use rayon::prelude::*;

    jobs.into_par_iter().map(Job::pixels).collect()
}

#[cfg(not(feature = "parallel"))]
fn all_pixels(jobs: Vec<Job<'_>>) -> Vec<Decoded> {
    jobs.into_iter().map(Job::pixels).collect()
}

/// Decodes an image that is none of `/images`.
pub(super) fn decode(
    reader: &mut Reader<'_>,
    place: &Cursor<'_>,
    name: &str,
    bytes: Arc<Vec<u8>>,
    format: ImageFormat,
) -> Result<ImageData> {
    let encoded = Encoded {
        place: place.clone(),
        name: name.to_owned(),
        bytes,
        format,
    };
    let room = encoded.reserve(reader)?;
    let pixels = encoded.job(&room).pixels();
    reader.budget.give(room.scratch);
    encoded.finish(&room, pixels)
}

/// Did the exporter make the file from pixels that had none (`extras.kaustik.generated`)?
fn is_generated(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<bool> {
    let Some(ours) = place.extras()? else {
        return Ok(false);
    };
    extras::warn_of_unknown(reader, &ours, &["generated"])?;
    ours.flag("generated")
}

/// What a decoder may take beside the pixels, which are counted by [`Encoded::reserve`]. PNG's inflates the
/// profile of colours up to its limit, for each image anew, and nobody reads it: it gets a few times the file.
fn limits(format: ImageFormat, bytes: usize, side: u32, memory: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(side);
    limits.max_image_height = Some(side);
    let enough = match format {
        ImageFormat::Png => (1 << 20) + 4 * bytes as u64 + 16 * u64::from(side),
        _ => u64::MAX,
    };
    limits.max_alloc = Some(memory.min(enough));
    limits
}
