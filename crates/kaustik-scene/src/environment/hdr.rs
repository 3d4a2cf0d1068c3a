use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use super::{EnvironmentError, MAX_RADIANCE};
use crate::description::{ImageData, Pixels};

/// Pixels that a picture may have: 8192 x 4096, 400 MB as floats.
pub const MAX_HDR_PIXELS: u64 = 1 << 25;

/// Bytes that a file may have: four a pixel are the most that a sane one needs.
pub const MAX_HDR_BYTES: u64 = 4 * MAX_HDR_PIXELS + (1 << 16);

/// Pixels that a byte may stand for. Runs of 127 equal bytes in each of four planes give 16; a
/// file that claims more is refused before memory is set aside for it.
const MAX_PIXELS_PER_BYTE: u64 = 32;

/// A picture and what had to be done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct DecodedHdr {
    /// The picture: linear Rec.709, every value finite and in [0, [`MAX_RADIANCE`]].
    pub image: ImageData,
    /// Values that were NaN, infinite, negative or too large, now 0 or the largest: worth a
    /// warning if not 0.
    pub cleaned: u64,
}

/// Reads a Radiance HDR file. Errors name the file.
pub fn load_hdr(path: &Path) -> Result<DecodedHdr, EnvironmentError> {
    let name = path.display().to_string();
    let read = |source| EnvironmentError::Read {
        name: name.clone(),
        source,
    };
    // Asked before it is opened: opening a pipe would wait for its other end.
    if !path.metadata().map_err(read)?.is_file() {
        return Err(read(io::Error::other("it is no regular file")));
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MAX_HDR_BYTES + 1).read_to_end(&mut bytes))
        .map_err(read)?;
    decode_hdr(&name, &bytes)
}

/// Decodes a Radiance HDR file; `name` is for messages. The size is checked before anything
/// is decoded.
pub fn decode_hdr(name: &str, bytes: &[u8]) -> Result<DecodedHdr, EnvironmentError> {
    let limit = |what, found, limit| {
        let name = name.to_owned();
        match found <= limit {
            true => Ok(()),
            false => Err(EnvironmentError::TooLarge {
                name,
                what,
                found,
                limit,
            }),
        }
    };
    let decode = |source| EnvironmentError::Decode {
        name: name.to_owned(),
        source,
    };
    limit("the number of bytes", bytes.len() as u64, MAX_HDR_BYTES)?;
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(decode)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    limit("the number of pixels", pixels, MAX_HDR_PIXELS)?;
    let plausible = MAX_PIXELS_PER_BYTE * bytes.len() as u64;
    limit("the number of pixels for its length", pixels, plausible)?;
    let decoded = image::DynamicImage::from_decoder(decoder).map_err(decode)?;
    let mut values = decoded.into_rgb32f().into_raw();
    let cleaned = clean_radiance(&mut values);
    let image = ImageData {
        name: name.to_owned(),
        width,
        height,
        pixels: Pixels::RgbF32(values),
        encoded: Vec::new(),
    };
    crate::texture::check(&image)?;
    Ok(DecodedHdr { image, cleaned })
}

/// Brings all values into [0, [`MAX_RADIANCE`]]; returns how many had to be.
pub fn clean_radiance(values: &mut [f32]) -> u64 {
    let mut cleaned = 0;
    for value in values {
        if !(0.0..=MAX_RADIANCE).contains(value) {
            // also not a number
            *value = if *value > 0.0 { MAX_RADIANCE } else { 0.0 };
            cleaned += 1;
        }
    }
    cleaned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_cleaned_and_counted() {
        let mut values = [f32::NAN, -1.0, f32::INFINITY, 2.0, 0.0, f32::NEG_INFINITY];
        assert_eq!(clean_radiance(&mut values), 4);
        let expected = [0.0, 0.0, MAX_RADIANCE, 2.0, 0.0, 0.0];
        assert_eq!(values.map(f32::to_bits), expected.map(f32::to_bits));
    }

    /// A flat, uncompressed picture (too narrow for run lengths).
    fn file(width: u32, height: u32, pixels: usize) -> Vec<u8> {
        let mut bytes =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
        bytes.extend([128_u8, 64, 32, 130].repeat(pixels));
        bytes
    }

    #[test]
    fn a_small_file_is_read() {
        let decoded = decode_hdr("sky.hdr", &file(3, 2, 6)).unwrap();
        assert_eq!((decoded.image.width, decoded.image.height), (3, 2));
        assert_eq!(decoded.cleaned, 0);
        let Pixels::RgbF32(values) = decoded.image.pixels else {
            panic!("floats expected");
        };
        for (i, &value) in values.iter().enumerate() {
            let expected = [2.0, 1.0, 0.5][i % 3];
            assert!((value / expected - 1.0).abs() < 0.01, "{value}");
        }
        // and through a file
        let path = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(path.path(), file(3, 2, 6)).unwrap();
        assert!(load_hdr(path.path()).is_ok());
    }

    #[test]
    fn hostile_files_are_refused() {
        let message = |bytes: &[u8]| decode_hdr("sky.hdr", bytes).unwrap_err().to_string();
        assert!(message(b"").contains("sky.hdr"));
        assert!(message(b"not a picture").contains("Radiance"));
        assert!(message(&file(100_000, 100_000, 4)).contains("the limit is"));
        assert!(message(&file(8000, 4000, 4)).contains("for its length"));
        assert!(message(&file(10, 10, 5)).contains("Radiance")); // truncated
        assert!(decode_hdr("sky.hdr", &file(0, 10, 5)).is_err());
        let missing = load_hdr(Path::new("no/such/sky.hdr")).unwrap_err();
        assert!(missing.to_string().contains("no/such/sky.hdr"));
    }
}
