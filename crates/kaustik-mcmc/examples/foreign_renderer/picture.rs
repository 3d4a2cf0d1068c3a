//! Pictures: their errors, and a PNG without compression.

use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

use crate::renderer::V;

/// Pixels of a side.
pub(crate) const SIDE: usize = 64;

pub(crate) type Image = Vec<V>;

pub(crate) fn mean(image: &Image) -> f64 {
    image.iter().map(|pixel| pixel.sum()).sum::<f64>() / (3 * image.len()) as f64
}

/// Root mean square difference of all channels.
pub(crate) fn rmse(image: &Image, reference: &Image) -> f64 {
    let pairs = image.iter().zip(reference);
    let squares: f64 = pairs.map(|(a, b)| (*a - *b).dot(*a - *b)).sum();
    (squares / (3 * image.len()) as f64).sqrt()
}

/// Writes pictures side by side: eight bits, curve of sRGB (roughly).
pub(crate) fn write_png(path: &Path, images: &[&Image]) -> Result<()> {
    let byte = |x: f64| (255.0 * x.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8;
    let mut rows = Vec::new();
    for y in 0..SIDE {
        rows.push(0); // no filter
        for image in images {
            let row = &image[y * SIDE..(y + 1) * SIDE];
            rows.extend(row.iter().flat_map(|v| [v.0, v.1, v.2].map(byte)));
        }
    }
    let mut out = BufWriter::new(File::create(path)?);
    out.write_all(b"\x89PNG\r\n\x1a\n")?;
    let [width, height] = [SIDE * images.len(), SIDE].map(|n| (n as u32).to_be_bytes());
    let header = [&width[..], &height, &[8, 2, 0, 0, 0]].concat();
    chunk(&mut out, b"IHDR", &header)?;
    chunk(&mut out, b"IDAT", &stored(&rows))?;
    chunk(&mut out, b"IEND", &[])?;
    out.flush()
}

/// A zlib stream of stored blocks.
fn stored(data: &[u8]) -> Vec<u8> {
    let mut out = vec![0x78, 0x01];
    let blocks = data.chunks(0xffff);
    let last = blocks.len() - 1;
    for (i, block) in blocks.enumerate() {
        let length = block.len() as u16;
        out.push(u8::from(i == last));
        out.extend(length.to_le_bytes());
        out.extend((!length).to_le_bytes());
        out.extend(block);
    }
    let (a, b) = data.iter().fold((1u32, 0u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (a + b) % 65521)
    });
    out.extend(((b << 16) | a).to_be_bytes());
    out
}

fn chunk(out: &mut impl Write, kind: &[u8; 4], data: &[u8]) -> Result<()> {
    out.write_all(&(data.len() as u32).to_be_bytes())?;
    out.write_all(kind)?;
    out.write_all(data)?;
    let crc = kind.iter().chain(data).fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 * (c & 1))
        })
    });
    out.write_all(&(!crc).to_be_bytes())
}
