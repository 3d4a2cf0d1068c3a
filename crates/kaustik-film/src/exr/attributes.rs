//! The values of the attributes that we understand.

use super::bytes::Bytes;
use super::header::ChannelInfo;
use crate::read::DecodeError;
use ::exr::prelude::{Compression, SampleType};

/// A box2i: the smallest and largest column and row, inclusive: x0, y0, x1, y1.
pub(super) fn window(value: &mut Bytes<'_>) -> Result<[i32; 4], DecodeError> {
    let mut window = [0; 4];
    for corner in &mut window {
        *corner = value.i32("window")?;
    }
    Ok(window)
}

/// Tile width and height of a file with one level.
pub(super) fn tiles(value: &mut Bytes<'_>) -> Result<[u32; 2], DecodeError> {
    let size = [value.u32("tile width")?, value.u32("tile height")?];
    if size.contains(&0) {
        return Err(DecodeError::unsupported(format!(
            "tiles of {} x {} pixels",
            size[0], size[1]
        )));
    }
    if value.u8("tile mode")? & 0xf != 0 {
        return Err(DecodeError::unsupported(
            "several resolution levels, expected one".into(),
        ));
    }
    Ok(size)
}

/// The text of a string attribute; `None` if it is not UTF-8.
pub(super) fn text(value: &mut Bytes<'_>) -> Result<Option<String>, DecodeError> {
    let bytes = value.take(value.left(), "text")?;
    Ok(std::str::from_utf8(bytes).ok().map(str::to_owned))
}

/// All channels, in the order of the file.
pub(super) fn channels(value: &mut Bytes<'_>) -> Result<Vec<ChannelInfo>, DecodeError> {
    const MOST: usize = 1024;
    let mut channels = Vec::new();
    loop {
        let at = value.at();
        let name = value.name("channel name")?;
        if name.is_empty() {
            return Ok(channels);
        }
        if channels.len() == MOST {
            let found = MOST as u64 + 1;
            return Err(DecodeError::TooLarge {
                what: "channels",
                found,
                limit: MOST as u64,
            });
        }
        let sample_type = match value.u32("sample type")? {
            0 => SampleType::U32,
            1 => SampleType::F16,
            2 => SampleType::F32,
            other => {
                return Err(DecodeError::malformed(
                    "sample type",
                    at,
                    format!("it is {other}, expected 0 to 2"),
                ));
            }
        };
        let linear = value.take(4, "channel flags")?[0] != 0;
        if [value.u32("sampling")?, value.u32("sampling")?] != [1, 1] {
            return Err(DecodeError::unsupported(format!(
                "channel '{name}' is subsampled"
            )));
        }
        channels.push(ChannelInfo {
            name: name.to_owned(),
            sample_type,
            linear,
        });
    }
}

/// The compression of this number.
pub(super) fn compression(code: u8) -> Result<Compression, DecodeError> {
    Ok(match code {
        0 => Compression::Uncompressed,
        1 => Compression::RLE,
        2 => Compression::ZIP1,
        3 => Compression::ZIP16,
        4 => Compression::PIZ,
        5 => Compression::PXR24,
        6 => Compression::B44,
        7 => Compression::B44A,
        8 => Compression::DWAA(None),
        9 => Compression::DWAB(None),
        other => {
            return Err(DecodeError::unsupported(format!(
                "compression number {other}, expected 0 to 9"
            )));
        }
    })
}
