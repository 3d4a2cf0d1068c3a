//! Small sound pictures of each format.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb32FImage, RgbImage, RgbaImage};
use kaustik::film::{Image, exr};

use crate::kind::Kind;

/// Pictures of a kind; none of a kind that is no picture.
pub(crate) fn all(kind: Kind) -> Vec<Vec<u8>> {
    match kind {
        Kind::Exr => exr_files(),
        Kind::Hdr => sizes(|w, h| {
            let pixel = |x: u32, y: u32| image::Rgb([x as f32, 0.5 * y as f32, 1e-3]);
            (
                DynamicImage::ImageRgb32F(Rgb32FImage::from_fn(w, h, pixel)),
                ImageFormat::Hdr,
            )
        }),
        Kind::Jpeg => sizes(|w, h| {
            let pixel = |x: u32, y: u32| image::Rgb([(9 * x) as u8, (7 * y) as u8, 40]);
            (
                DynamicImage::ImageRgb8(RgbImage::from_fn(w, h, pixel)),
                ImageFormat::Jpeg,
            )
        }),
        Kind::Png => sizes(|w, h| {
            // the largest with 16 bits a channel
            let picture = if w > 8 {
                let pixel =
                    |x: u32, y: u32| image::Rgba([900 * x as u16, 700 * y as u16, 1, 60_000]);
                DynamicImage::ImageRgba16(ImageBuffer::from_fn(w, h, pixel))
            } else {
                bytes(w, h)
            };
            (picture, ImageFormat::Png)
        }),
        Kind::Webp => sizes(|w, h| (bytes(w, h), ImageFormat::WebP)),
        _ => vec![b"planted".to_vec()],
    }
}

/// Four bytes a pixel.
fn bytes(width: u32, height: u32) -> DynamicImage {
    let pixel = |x: u32, y: u32| image::Rgba([(9 * x) as u8, (7 * y) as u8, 40, 200]);
    DynamicImage::ImageRgba8(RgbaImage::from_fn(width, height, pixel))
}

/// One picture of 8 x 8.
pub(crate) fn first(kind: Kind) -> Vec<u8> {
    all(kind).into_iter().next().unwrap_or_default()
}

fn sizes(make: impl Fn(u32, u32) -> (DynamicImage, ImageFormat)) -> Vec<Vec<u8>> {
    let sizes = [(8, 8), (1, 1), (33, 5)];
    let encode = |(w, h)| {
        let (picture, format) = make(w, h);
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).ok()?;
        Some(bytes.into_inner())
    };
    sizes.into_iter().filter_map(encode).collect()
}

/// As a render writes it, with and without further layers' metadata.
fn exr_files() -> Vec<Vec<u8>> {
    let file = |width: u32, height: u32| {
        let ramp = |scale: f32| (0..width * height).map(|i| scale * i as f32).collect();
        let image = Image::from_rgb(width, height, [ramp(1.0), ramp(0.5), ramp(0.1)]).ok()?;
        let image = image.with_metadata(serde_json::json!({ "method": "path", "seed": 1 }));
        let mut bytes = Cursor::new(Vec::new());
        exr::encode(&mut bytes, &image).ok()?;
        Some(bytes.into_inner())
    };
    [(8, 8), (1, 1), (33, 5)]
        .into_iter()
        .filter_map(|(width, height)| file(width, height))
        .collect()
}
