//! The head of an EXR file: what we need of it, each value checked before it is believed.

use super::attributes::{channels, compression, text, tiles, window};
use super::bytes::Bytes;
use super::write::ATTRIBUTE;
use crate::Image;
use crate::read::{DecodeError, Keep, Limits};
use ::exr::prelude::{Compression, SampleType};

/// One part: a rectangle of pixels and how it is stored.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// The part's name; may be empty.
    pub name: String,
    pub channels: Vec<ChannelInfo>,
    pub compression: Compression,
    /// First column and row.
    pub origin: [i32; 2],
    /// Columns and rows, each >= 1 and within the limits.
    pub size: [usize; 2],
    /// Minimum corner and size of the display window.
    pub display: ([i32; 2], [u32; 2]),
    /// Tile size, if tiled.
    pub tiles: Option<[usize; 2]>,
    pub metadata: Option<String>,
}

/// One channel, not subsampled.
#[derive(Clone, Debug)]
pub(super) struct ChannelInfo {
    pub name: String,
    pub sample_type: SampleType,
    pub linear: bool,
}

impl ChannelInfo {
    /// Is it a channel of the picture, if its part is the first?
    pub(super) fn is_main(&self) -> bool {
        matches!(self.name.as_str(), "R" | "G" | "B" | "Y")
    }
}

impl Part {
    /// Columns and rows of a whole block.
    pub(super) fn block_size(&self) -> [usize; 2] {
        self.tiles
            .unwrap_or([self.size[0], self.compression.scan_lines_per_block()])
    }

    /// Samples of the largest block, which is unpacked with all its channels whatever is kept of them.
    fn in_a_block(&self) -> u64 {
        let block = self.block_size();
        let [columns, rows] = [0, 1].map(|axis| block[axis].min(self.size[axis]) as u64);
        columns * rows * self.channels.len() as u64
    }

    /// Blocks along each axis.
    pub(super) fn block_counts(&self) -> [usize; 2] {
        let block = self.block_size();
        [
            self.size[0].div_ceil(block[0]),
            self.size[1].div_ceil(block[1]),
        ]
    }
}

/// Reads magic number, version and all headers; leaves `bytes` at the offset tables. Whether the file
/// has several parts decides how chunks are spelled. Channels that are not kept do not count against the limit of
/// samples.
pub(super) fn read(
    bytes: &mut Bytes<'_>,
    limits: &Limits,
    keep: Keep,
) -> Result<(Vec<Part>, bool), DecodeError> {
    let version = Version::read(bytes)?;
    let mut parts = Vec::new();
    let mut samples = 0u64;
    loop {
        let part = part(bytes, limits, version.tiled)?;
        let kept = (part.channels.iter()).filter(|channel| match keep {
            Keep::All => true,
            Keep::Main => parts.is_empty() && channel.is_main(),
        });
        samples += part.size[0] as u64 * part.size[1] as u64 * kept.count() as u64;
        for (what, found) in [
            ("samples", samples),
            ("samples in a block", part.in_a_block()),
        ] {
            if found > limits.max_samples {
                let limit = limits.max_samples;
                return Err(DecodeError::TooLarge { what, found, limit });
            }
        }
        parts.push(part);
        if !version.multipart {
            return Ok((parts, false));
        }
        let mut ahead = *bytes;
        if ahead.u8("end of headers")? == 0 {
            *bytes = ahead;
            return Ok((parts, true));
        }
    }
}

/// What the version word says of the whole file.
struct Version {
    /// Its only part is tiled.
    tiled: bool,
    multipart: bool,
}

impl Version {
    /// Reads magic number and version.
    fn read(bytes: &mut Bytes<'_>) -> Result<Self, DecodeError> {
        const TILED: u32 = 0x200;
        const LONG_NAMES: u32 = 0x400;
        const DEEP: u32 = 0x800;
        const MULTIPART: u32 = 0x1000;
        const KNOWN: u32 = TILED | LONG_NAMES | DEEP | MULTIPART;
        if bytes.u32("magic number")? != 0x0131_2f76 {
            return Err(DecodeError::malformed(
                "magic number",
                0,
                "expected an EXR file".into(),
            ));
        }
        let version = bytes.u32("version")?;
        if version & 0xff != 2 || version & !0xff & !KNOWN != 0 {
            return Err(DecodeError::unsupported(format!(
                "version word {version:#x}, expected OpenEXR 2"
            )));
        }
        if version & DEEP != 0 {
            return Err(DecodeError::unsupported(
                "deep data, expected flat pixels".into(),
            ));
        }
        Ok(Self {
            tiled: version & TILED != 0,
            multipart: version & MULTIPART != 0,
        })
    }
}

/// One header, up to and including the zero that ends it.
fn part(bytes: &mut Bytes<'_>, limits: &Limits, tiled_bit: bool) -> Result<Part, DecodeError> {
    let mut raw = Raw::default();
    loop {
        let name = bytes.name("attribute name")?;
        if name.is_empty() {
            return raw.checked(bytes.at(), limits, tiled_bit);
        }
        let kind = bytes.name("attribute type")?;
        let size = bytes.size("attribute size")?;
        let at = bytes.at();
        let mut value = Bytes::new(bytes.take(size, "attribute")?);
        raw.attribute(name, kind, &mut value)
            .map_err(|error| error.shifted(at))?;
    }
}

/// Attributes as they come, before it is known whether all are there.
#[derive(Default)]
struct Raw {
    name: String,
    kind: Option<String>,
    channels: Vec<ChannelInfo>,
    compression: Option<Compression>,
    data: Option<[i32; 4]>,
    display: Option<[i32; 4]>,
    tiles: Option<[u32; 2]>,
    metadata: Option<String>,
}

impl Raw {
    fn attribute(
        &mut self,
        name: &str,
        kind: &str,
        value: &mut Bytes<'_>,
    ) -> Result<(), DecodeError> {
        match (name, kind) {
            ("channels", "chlist") => self.channels = channels(value)?,
            ("compression", "compression") => {
                self.compression = Some(compression(value.u8("compression")?)?);
            }
            ("dataWindow", "box2i") => self.data = Some(window(value)?),
            ("displayWindow", "box2i") => self.display = Some(window(value)?),
            ("tiles", "tiledesc") => self.tiles = Some(tiles(value)?),
            ("name", "string") => self.name = text(value)?.unwrap_or_default(),
            ("type", "string") => self.kind = text(value)?,
            (ATTRIBUTE, "string") => self.metadata = text(value)?,
            _ => {}
        }
        Ok(())
    }

    fn checked(self, at: usize, limits: &Limits, tiled_bit: bool) -> Result<Part, DecodeError> {
        let missing =
            |what| DecodeError::malformed("header", at, format!("attribute '{what}' is missing"));
        let data = self.data.ok_or_else(|| missing("dataWindow"))?;
        let display = self.display.ok_or_else(|| missing("displayWindow"))?;
        let compression = self.compression.ok_or_else(|| missing("compression"))?;
        if self.channels.is_empty() {
            return Err(missing("channels"));
        }
        let tiled = match self.kind.as_deref() {
            None => tiled_bit,
            Some("scanlineimage") => false,
            Some("tiledimage") => true,
            Some(other) => {
                return Err(DecodeError::unsupported(format!(
                    "part of type '{other}', expected flat pixels"
                )));
            }
        };
        let size = extent(data, limits)?;
        let full = extent(display, limits)?;
        let tiles = if tiled {
            Some(self.tiles.ok_or_else(|| missing("tiles"))?)
        } else {
            None
        };
        // A tile larger than the image is as good as one of its size.
        let tiles = tiles.map(|t| [(t[0] as usize).min(size[0]), (t[1] as usize).min(size[1])]);
        Ok(Part {
            name: self.name,
            channels: self.channels,
            compression,
            origin: [data[0], data[1]],
            size,
            display: ([display[0], display[1]], [full[0] as u32, full[1] as u32]),
            tiles,
            metadata: self.metadata,
        })
    }
}

/// Columns and rows of a window with inclusive corners.
fn extent(window: [i32; 4], limits: &Limits) -> Result<[usize; 2], DecodeError> {
    let mut size = [0; 2];
    for axis in 0..2 {
        let extent = i64::from(window[axis + 2]) - i64::from(window[axis]) + 1;
        if extent < 1 {
            return Err(DecodeError::unsupported(format!(
                "an empty window {window:?}"
            )));
        }
        let limit = u64::from(limits.max_side.min(Image::MAX_SIDE));
        if extent as u64 > limit {
            return Err(DecodeError::TooLarge {
                what: "columns or rows",
                found: extent as u64,
                limit,
            });
        }
        size[axis] = extent as usize;
    }
    Ok(size)
}
