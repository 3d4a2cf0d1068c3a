use std::borrow::Cow;

use image::codecs::hdr::HdrEncoder;
use image::codecs::png::PngEncoder;
use image::{
    ExtendedColorType, ImageBuffer, ImageEncoder as _, ImageFormat, ImageResult, Rgb, Rgba,
};
use serde_json::{Value, json};

use super::ExportError;
use super::writer::{Object, Writer, extras, number, numbers};
use crate::Description;
use crate::description::{EnvironmentDescription, Filtering, ImageData, Pixels, Wrap};

type Result<T> = std::result::Result<T, ExportError>;

const WEBP: &str = "EXT_texture_webp";

/// Writes all images with the bytes that they were read from, or else as PNG.
pub(super) fn images(writer: &mut Writer, description: &Description) -> Result<()> {
    let mut list = Vec::new();
    for (i, image) in description.images.iter().enumerate() {
        let place = format!("images[{i}] (\"{}\")", image.name);
        if matches!(image.pixels, Pixels::RgbF32(_)) {
            return Err(ExportError::Unsupported {
                place,
                found: "an image of floats".into(),
                expected: "four integers a pixel, as glTF's textures are PNG, JPEG or WebP".into(),
            });
        }
        let (bytes, generated) = encoded(image, &place)?;
        let mime = match bytes.first() {
            Some(0xff) => "image/jpeg",
            Some(b'R') => "image/webp",
            _ => "image/png",
        };
        let ours = Object::default().maybe("generated", generated.then_some(true));
        let object = Object::default()
            .named(&image.name)
            .with("bufferView", writer.view(bytes.iter().copied()))
            .with("mimeType", mime)
            .maybe("extras", extras(ours));
        list.push(object.into());
    }
    writer.set("images", list);
    Ok(())
}

/// The file of an image, and whether it had to be made.
fn encoded<'a>(image: &'a ImageData, place: &str) -> Result<(Cow<'a, [u8]>, bool)> {
    if !image.encoded.is_empty() {
        return Ok((Cow::Borrowed(&image.encoded), false));
    }
    let bytes = match &image.pixels {
        Pixels::Rgba8(pixels) => png(image, pixels),
        Pixels::Rgba16(pixels) => png_of_16_bits(image, pixels),
        Pixels::RgbF32(pixels) => hdr(image, pixels),
    };
    let bytes = bytes.map_err(|e| ExportError::Unsupported {
        place: place.to_owned(),
        found: e.to_string(),
        expected: "as many pixels as its width and height say".into(),
    })?;
    Ok((Cow::Owned(bytes), true))
}

fn png(image: &ImageData, pixels: &[u8]) -> ImageResult<Vec<u8>> {
    check_length(pixels.len(), image, 4)?;
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(
        pixels,
        image.width,
        image.height,
        ExtendedColorType::Rgba8,
    )?;
    Ok(bytes)
}

fn png_of_16_bits(image: &ImageData, pixels: &[u16]) -> ImageResult<Vec<u8>> {
    check_length(pixels.len(), image, 4)?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    if let Some(buffer) = ImageBuffer::<Rgba<u16>, _>::from_raw(image.width, image.height, pixels) {
        buffer.write_to(&mut bytes, ImageFormat::Png)?;
    }
    Ok(bytes.into_inner())
}

/// Shared exponents hold what once came from such a file; whether anything is lost, the check
/// of the finished file tells.
fn hdr(image: &ImageData, pixels: &[f32]) -> ImageResult<Vec<u8>> {
    check_length(pixels.len(), image, 3)?;
    let rgb: Vec<Rgb<f32>> = pixels
        .chunks_exact(3)
        .map(|p| Rgb([p[0], p[1], p[2]]))
        .collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&rgb, image.width as usize, image.height as usize)?;
    Ok(bytes)
}

fn check_length(values: usize, image: &ImageData, each: u64) -> ImageResult<()> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    if pixels > 0 && values as u64 == pixels * each {
        return Ok(());
    }
    let (width, height) = (image.width, image.height);
    let message = format!("{values} values for {width} x {height} pixels");
    Err(std::io::Error::other(message).into())
}

/// Writes the textures, and each kind of sampling once.
pub(super) fn textures(writer: &mut Writer, description: &Description) {
    let mut kinds: Vec<(Wrap, Wrap, Filtering)> = Vec::new();
    let mut list = Vec::new();
    for texture in &description.textures {
        let kind = (texture.wrap_s, texture.wrap_t, texture.filtering);
        let known = kinds.iter().position(|k| *k == kind);
        let sampler = known.unwrap_or_else(|| {
            kinds.push(kind);
            kinds.len() - 1
        });
        let webp = description
            .images
            .get(texture.image)
            .is_some_and(|image| image.encoded.starts_with(b"RIFF"));
        let object = Object::default().with("sampler", sampler);
        let object = if webp {
            // there is no picture of another format beside it
            writer.requires(WEBP);
            object.with("extensions", json!({ WEBP: { "source": texture.image } }))
        } else {
            object.with("source", texture.image)
        };
        list.push(object.into());
    }
    writer.set("textures", list);
    writer.set("samplers", kinds.into_iter().map(sampler).collect());
}

fn sampler((wrap_s, wrap_t, filtering): (Wrap, Wrap, Filtering)) -> Value {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    };
    let filter = match filtering {
        Filtering::Linear => 9729,
        Filtering::Nearest => 9728,
    };
    Object::default()
        .with("magFilter", filter)
        .with("wrapS", wrap(wrap_s))
        .with("wrapT", wrap(wrap_t))
        .into()
}

/// What stands in `extras.kaustik.environment` of the scene.
pub(super) fn environment(
    writer: &mut Writer,
    environment: &EnvironmentDescription,
) -> Result<Value> {
    let (image, strength, rotation) = match environment {
        EnvironmentDescription::Constant(color) => return Ok(numbers(color)),
        EnvironmentDescription::Image {
            image,
            strength,
            rotation,
        } => (image, *strength, *rotation),
    };
    let place = format!("environment (\"{}\")", image.name);
    let (bytes, generated) = encoded(image, &place)?;
    let object = Object::default()
        .named(&image.name)
        .with("bufferView", writer.view(bytes.iter().copied()))
        .maybe("generated", generated.then_some(true))
        .with("strength", number(strength))
        .with("rotation", numbers(&rotation.to_array()));
    Ok(object.into())
}
