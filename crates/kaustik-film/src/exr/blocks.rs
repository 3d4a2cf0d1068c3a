//! Decompression of one block of pixels, fenced in.

use super::bytes::Bytes;
use super::header::Part;
use crate::fence::fenced;
use crate::read::DecodeError;
use ::exr::math::RoundingMode;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{LevelMode, TileDescription};
use ::exr::meta::header::Header;
use ::exr::prelude::{
    ChannelDescription, Compression, IntegerBounds, LineOrder, SampleType, Text, Vec2, f16,
};

/// Turns the stored bytes of a part's blocks into samples.
pub(super) struct Decoder {
    header: Header,
}

/// A rectangle of a part's pixels, in columns and rows from the part's first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub at: [usize; 2],
    pub size: [usize; 2],
}

impl Decoder {
    pub(super) fn new(part: &Part) -> Result<Self, DecodeError> {
        let channels: Option<_> = part
            .channels
            .iter()
            .map(|c| {
                Some(ChannelDescription::new(
                    Text::new_or_none(&c.name)?,
                    c.sample_type,
                    c.linear,
                ))
            })
            .collect();
        let channels =
            channels.ok_or_else(|| DecodeError::unsupported("a channel's name".into()))?;
        let blocks = match part.tiles {
            None => BlockDescription::ScanLines,
            Some([width, height]) => BlockDescription::Tiles(TileDescription {
                tile_size: Vec2(width, height),
                level_mode: LevelMode::Singular,
                rounding_mode: RoundingMode::Down,
            }),
        };
        let header = Header::new(
            Text::from("part"),
            Vec2(part.size[0], part.size[1]),
            channels,
        )
        .with_encoding(part.compression, blocks, LineOrder::Increasing);
        Ok(Self { header })
    }

    /// The block's bytes, uncompressed: for each line, for each channel, the samples (native order).
    ///
    /// The library below is fenced in twice: sizes that it would believe are checked here, and should it
    /// panic all the same, the panic ends here.
    pub(super) fn decode(
        &self,
        block: Block,
        stored: &[u8],
        at: usize,
    ) -> Result<Vec<u8>, DecodeError> {
        let pixels = block.size[0] * block.size[1];
        let expected = pixels * self.header.channels.bytes_per_pixel;
        let fault = |message: String| DecodeError::malformed("pixel block", at, message);
        self.plausible(expected, stored).map_err(fault)?;
        let area = IntegerBounds::new(
            Vec2(block.at[0] as i32, block.at[1] as i32),
            Vec2(block.size[0], block.size[1]),
        );
        let compression = self.header.compression;
        let decoded = fenced(|| {
            compression.decompress_image_section_from_le(&self.header, stored.to_vec(), area, false)
        });
        match decoded {
            Some(Ok(data)) if data.len() == expected => Ok(data),
            Some(Ok(_)) => Err(fault("it has the wrong size".into())),
            Some(Err(error)) => Err(fault(error.to_string())),
            None => Err(fault("it cannot be decompressed".into())),
        }
    }

    /// Whether this much can have been stored in so few bytes.
    fn plausible(&self, expected: usize, stored: &[u8]) -> Result<(), String> {
        if stored.len() > expected {
            return Err(format!(
                "{} bytes stored, expected at most {expected}",
                stored.len()
            ));
        }
        if stored.len() == expected {
            return Ok(()); // stored as it is
        }
        let most = match self.header.compression {
            Compression::Uncompressed => {
                return Err(format!(
                    "{} bytes stored, expected {expected}",
                    stored.len()
                ));
            }
            Compression::RLE => 64,
            Compression::ZIP1 | Compression::ZIP16 | Compression::PXR24 => 1040, // deflate's limit is 1032
            Compression::DWAA(_) | Compression::DWAB(_) => {
                return if stored.is_empty() {
                    Ok(())
                } else {
                    dwa_counters(expected, stored)
                };
            }
            _ => {
                return if stored.is_empty() {
                    Err("it is empty".into())
                } else {
                    Ok(())
                };
            }
        };
        // PXR24 stores three of four bytes.
        if stored.len().saturating_mul(most).saturating_mul(4) / 3 + 64 < expected {
            return Err(format!("{} bytes stored for {expected}", stored.len()));
        }
        Ok(())
    }
}

/// A DWA block begins with eleven counters, which the library allocates by.
fn dwa_counters(expected: usize, stored: &[u8]) -> Result<(), String> {
    let mut bytes = Bytes::new(stored);
    let limit = (expected as u64).saturating_mul(2) + 65536;
    for _ in 0..10 {
        let counter = bytes
            .u64("DWA counter")
            .map_err(|error| error.to_string())?;
        if counter > limit {
            return Err(format!(
                "a DWA counter of {counter}, expected at most {limit}"
            ));
        }
    }
    Ok(())
}

/// Converts one line of one channel to `f32`.
pub(super) fn samples(line: &[u8], sample_type: SampleType, out: &mut [f32]) {
    match sample_type {
        SampleType::F32 => fill(line, out, f32::from_ne_bytes),
        SampleType::U32 => fill(line, out, |bytes| u32::from_ne_bytes(bytes) as f32),
        SampleType::F16 => fill(line, out, |bytes| f16::from_ne_bytes(bytes).to_f32()),
    }
}

fn fill<const N: usize>(line: &[u8], out: &mut [f32], convert: impl Fn([u8; N]) -> f32) {
    for (sample, bytes) in out.iter_mut().zip(line.as_chunks::<N>().0) {
        *sample = convert(*bytes);
    }
}
