//! Writing: blocks of 16 lines are gathered from the planes one at a time.

use crate::atomic::{Sink, WriteError, write_file};
use crate::{Channel, Image};
use ::exr::block::UncompressedBlock;
use ::exr::block::writer::ChunksWriter as _;
use ::exr::error::Error;
use ::exr::meta::BlockDescription;
use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use ::exr::prelude::{
    AttributeValue, ChannelDescription, Compression, IntegerBounds, LineOrder, SampleType, Text,
    Vec2,
};
use std::io;
use std::path::Path;

/// The attribute that holds our description.
pub(super) const ATTRIBUTE: &str = "kaustik";

/// Writes an image with all its layers and its metadata to an EXR file, whole or not at all.
///
/// The same image gives the same bytes. Besides the image, a block of 16 lines is in memory.
///
/// # Errors
/// If the file cannot be written (see [`write_file`]).
pub fn write(path: &Path, image: &Image) -> Result<(), WriteError> {
    write_file(path, |sink| encode(sink, image))
}

/// Writes an image as EXR into anything that can be written and sought, such as a cursor over a vector.
///
/// # Errors
/// What the sink says.
pub fn encode(mut sink: &mut dyn Sink, image: &Image) -> io::Result<()> {
    let planes = planes(image);
    let header = header(image, &planes)?;
    let write = ::exr::block::write(
        &mut sink,
        [header].into_iter().collect(),
        true,
        |meta, chunks| {
            let mut compressor = chunks.sequential_blocks_compressor(&meta);
            for (index, block) in meta.enumerate_ordered_header_block_indices() {
                let data = gather(
                    &planes,
                    block.pixel_position,
                    block.pixel_size,
                    image.width() as usize,
                );
                compressor.compress_block(index, UncompressedBlock { index: block, data })?;
            }
            Ok(())
        },
    );
    write.map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// All planes with their full names, in the order of the file: sorted by name.
fn planes(image: &Image) -> Vec<(String, &Channel)> {
    let layers = image.layers().iter();
    let mut planes: Vec<_> = layers
        .flat_map(|layer| {
            layer
                .channels
                .iter()
                .map(|channel| (full_name(&layer.name, &channel.name), channel))
        })
        .collect();
    planes.sort_by(|a, b| a.0.cmp(&b.0));
    planes
}

fn full_name(layer: &str, channel: &str) -> String {
    if layer.is_empty() {
        channel.to_owned()
    } else {
        format!("{layer}.{channel}")
    }
}

fn header(image: &Image, planes: &[(String, &Channel)]) -> io::Result<Header> {
    let channels: Option<_> = planes
        .iter()
        .map(|(name, _)| {
            Some(ChannelDescription::named(
                Text::new_or_none(name)?,
                SampleType::F32,
            ))
        })
        .collect();
    let channels =
        channels.ok_or_else(|| io::Error::other("a channel's name is not plain text"))?;
    let size = Vec2(image.width() as usize, image.height() as usize);
    let [full_width, full_height] = image.full_size();
    let display = Vec2(full_width as usize, full_height as usize);
    let mut own = LayerAttributes {
        layer_name: None,
        ..LayerAttributes::default()
    };
    own.layer_position = Vec2(image.origin()[0], image.origin()[1]);
    if let Some(metadata) = image.metadata() {
        let text = Text::new_or_none(ascii_json(metadata)).zip(Text::new_or_none(ATTRIBUTE));
        let (text, name) =
            text.ok_or_else(|| io::Error::other("the metadata are not plain text"))?;
        own.other.insert(name, AttributeValue::Text(text));
    }
    Ok(Header::new(Text::from(ATTRIBUTE), size, channels)
        .with_encoding(
            Compression::ZIP16,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        )
        .with_attributes(own)
        .with_shared_attributes(ImageAttributes::new(IntegerBounds::new(
            Vec2(0, 0),
            display,
        ))))
}

/// JSON in ASCII: EXR's text has no agreed encoding, and JSON can escape whatever is beyond.
fn ascii_json(value: &serde_json::Value) -> String {
    let mut text = String::new();
    for c in value.to_string().chars() {
        if c.is_ascii() {
            text.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                text.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    text
}

/// The bytes of one block: for each line, for each channel, the samples.
fn gather(
    planes: &[(String, &Channel)],
    at: Vec2<usize>,
    size: Vec2<usize>,
    width: usize,
) -> Vec<u8> {
    let mut data = Vec::with_capacity(planes.len() * size.area() * 4);
    for y in at.y()..at.y() + size.height() {
        let start = y * width + at.x();
        for (_, channel) in planes {
            for sample in &channel.samples[start..start + size.width()] {
                data.extend_from_slice(&sample.to_ne_bytes());
            }
        }
    }
    data
}
