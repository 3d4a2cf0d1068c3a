//! Reading: chunks in the order of the file, each block at most once, all of them present.

use super::blocks::{self, Block, Decoder};
use super::bytes::Bytes;
use super::header::{self, ChannelInfo, Part};
use crate::read::{DecodeError, Keep, Limits, reserve};
use crate::{Channel, Image, Layer};

/// Decodes an EXR file: one or several parts, scan lines or tiles of one level, any of the ten
/// compressions, half, float or integer samples. All parts with the first one's data window are kept as
/// layers; a file with only `Y` gives gray. Values are taken to be linear Rec.709.
///
/// # Errors
/// A file that is not EXR, is cut short or contradicts itself, is larger than the limits, or holds what
/// is not supported (deep data, subsampled channels, several levels). Never a panic, whatever the bytes.
pub fn decode(bytes: &[u8], limits: &Limits, keep: Keep) -> Result<Image, DecodeError> {
    let mut bytes = Bytes::new(bytes);
    let (parts, multipart) = header::read(&mut bytes, limits, keep)?;
    let mut readers = Vec::new();
    for part in &parts {
        let [columns, rows] = part.block_counts();
        let count = columns as u64 * rows as u64;
        // Each block takes eight bytes of the offset table, which the block count must not outgrow.
        if count > bytes.left() as u64 / 8 {
            return Err(DecodeError::malformed(
                "offset table",
                bytes.at(),
                format!("{count} blocks do not fit in the file"),
            ));
        }
        bytes.take(count as usize * 8, "offset table")?;
        readers.push(PartReader::new(part, &parts[0], keep, count as usize)?);
    }
    let total: usize = readers.iter().map(|reader| reader.missing).sum();
    for _ in 0..total {
        let at = bytes.at();
        let index = if multipart {
            bytes.size("part number")?
        } else {
            0
        };
        let reader = readers.get_mut(index);
        let reader = reader
            .ok_or_else(|| DecodeError::malformed("part number", at, format!("it is {index}")))?;
        reader.chunk(&mut bytes)?;
    }
    assemble(&parts, readers)
}

/// The blocks of one part on their way into planes.
struct PartReader<'a> {
    part: &'a Part,
    decoder: Decoder,
    seen: Vec<bool>,
    missing: usize,
    /// For each channel its plane, empty until the first block is decoded; `None` if not wanted.
    planes: Vec<Option<Vec<f32>>>,
}

impl<'a> PartReader<'a> {
    fn new(part: &'a Part, first: &Part, keep: Keep, count: usize) -> Result<Self, DecodeError> {
        let fits = (part.origin, part.size) == (first.origin, first.size);
        let main = std::ptr::eq(part, first);
        let wanted = |channel: &ChannelInfo| match keep {
            Keep::All => fits,
            Keep::Main => main && channel.is_main(),
        };
        let planes = part
            .channels
            .iter()
            .map(|channel| wanted(channel).then(Vec::new))
            .collect();
        let seen = vec![false; count];
        Ok(Self {
            part,
            decoder: Decoder::new(part)?,
            seen,
            missing: count,
            planes,
        })
    }

    /// One chunk: where it goes, how long it is, its bytes.
    fn chunk(&mut self, bytes: &mut Bytes<'_>) -> Result<(), DecodeError> {
        let at = bytes.at();
        let (block, index) = self.place(bytes, at)?;
        let length = bytes.size("block size")?;
        let stored = bytes.take(length, "pixel block")?;
        if std::mem::replace(&mut self.seen[index], true) {
            return Err(DecodeError::malformed(
                "block position",
                at,
                "the same block twice".into(),
            ));
        }
        if self.planes.iter().all(Option::is_none) {
            return Ok(());
        }
        let data = self.decoder.decode(block, stored, at)?;
        self.scatter(block, &data)
    }

    /// Reads a chunk's coordinates: the block and its number.
    fn place(&self, bytes: &mut Bytes<'_>, at: usize) -> Result<(Block, usize), DecodeError> {
        let wrong = || {
            DecodeError::malformed(
                "block position",
                at,
                "it lies outside of the data window".into(),
            )
        };
        let [width, height] = self.part.block_size();
        let [columns, rows] = self.part.block_counts();
        let (column, row) = if self.part.tiles.is_some() {
            let tile = [bytes.size("tile column")?, bytes.size("tile row")?];
            if [bytes.i32("tile level")?, bytes.i32("tile level")?] != [0, 0] {
                return Err(wrong());
            }
            (tile[0], tile[1])
        } else {
            let y = i64::from(bytes.i32("block row")?) - i64::from(self.part.origin[1]);
            let y = usize::try_from(y).map_err(|_| wrong())?;
            if y % height != 0 {
                return Err(wrong());
            }
            (0, y / height)
        };
        if column >= columns || row >= rows {
            return Err(wrong());
        }
        let at = [column * width, row * height];
        let size = [
            width.min(self.part.size[0] - at[0]),
            height.min(self.part.size[1] - at[1]),
        ];
        Ok((Block { at, size }, row * columns + column))
    }

    /// Copies a block's samples into the planes.
    fn scatter(&mut self, block: Block, data: &[u8]) -> Result<(), DecodeError> {
        let [width, height] = self.part.size;
        for plane in self
            .planes
            .iter_mut()
            .flatten()
            .filter(|plane| plane.is_empty())
        {
            reserve(plane, width * height)?;
            plane.resize(width * height, 0.0);
        }
        let mut rest = data;
        for y in block.at[1]..block.at[1] + block.size[1] {
            let start = y * width + block.at[0];
            for (channel, plane) in self.part.channels.iter().zip(&mut self.planes) {
                let (line, after) =
                    rest.split_at(block.size[0] * channel.sample_type.bytes_per_sample());
                rest = after;
                if let Some(plane) = plane {
                    blocks::samples(
                        line,
                        channel.sample_type,
                        &mut plane[start..start + block.size[0]],
                    );
                }
            }
        }
        Ok(())
    }
}

/// Puts the planes into layers, by the dots in their names and the parts' names.
fn assemble(parts: &[Part], readers: Vec<PartReader<'_>>) -> Result<Image, DecodeError> {
    let mut layers: Vec<Layer> = vec![Layer::new("", Vec::new())];
    for (index, reader) in readers.into_iter().enumerate() {
        let part = if index == 0 {
            ""
        } else {
            reader.part.name.as_str()
        };
        for (info, plane) in reader.part.channels.iter().zip(reader.planes) {
            let Some(samples) = plane else { continue };
            let (layer, name) = split(part, &info.name, index);
            let channel = Channel { name, samples };
            match layers.iter_mut().find(|l| l.name == layer) {
                Some(layer) => layer.channels.push(channel),
                None => layers.push(Layer {
                    name: layer,
                    channels: vec![channel],
                }),
            }
        }
    }
    let part = &parts[0];
    let rgb = main_planes(&mut layers[0])?;
    let mut image = Image::from_rgb(part.size[0] as u32, part.size[1] as u32, rgb)?;
    for layer in layers {
        if !layer.channels.is_empty() {
            image.push_channels(layer)?;
        }
    }
    let (corner, full) = part.display;
    let origin = [
        part.origin[0].saturating_sub(corner[0]),
        part.origin[1].saturating_sub(corner[1]),
    ];
    let image = image.placed(origin, full);
    let metadata = part
        .metadata
        .as_deref()
        .and_then(|text| serde_json::from_str(text).ok());
    Ok(match metadata {
        Some(metadata) => image.with_metadata(metadata),
        None => image,
    })
}

/// Layer and channel of a channel's full name in a part.
fn split(part: &str, name: &str, index: usize) -> (String, String) {
    let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
    let layer = match (part, layer) {
        ("", "") if index > 0 => format!("part{index}"),
        ("", layer) => layer.to_owned(),
        (part, "") => part.to_owned(),
        (part, layer) => format!("{part}.{layer}"),
    };
    (layer, channel.to_owned())
}

/// Takes R, G, B out of the main layer, or Y three times.
fn main_planes(main: &mut Layer) -> Result<[Vec<f32>; 3], DecodeError> {
    let mut take = |name: &str| {
        let index = main
            .channels
            .iter()
            .position(|channel| channel.name == name)?;
        Some(main.channels.remove(index).samples)
    };
    if let (Some(r), Some(g), Some(b)) = (take("R"), take("G"), take("B")) {
        return Ok([r, g, b]);
    }
    match take("Y") {
        Some(y) => {
            let mut copies = [Vec::new(), Vec::new()];
            for copy in &mut copies {
                reserve(copy, y.len())?;
                copy.extend_from_slice(&y);
            }
            let [a, b] = copies;
            Ok([a, b, y])
        }
        None => Err(DecodeError::unsupported(
            "no channels R, G, B and no Y in the first part".into(),
        )),
    }
}
