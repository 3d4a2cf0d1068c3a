//! Images that are decoded side by side: what is told and what is taken is as one by one.

use std::sync::Arc;

use serde_json::{Value, json};

use super::file::{File, png, png_of_16_bits};
use super::surface::crc32;
use crate::description::Pixels;
use crate::gltf::{ErrorKind, LoadOptions, export_bytes, load_bytes};

const SIDE: u32 = 64;

fn with_images(sources: Vec<Option<Vec<u8>>>) -> File {
    let mut file = File::empty();
    let mut image = |source: Option<Vec<u8>>| match source {
        Some(bytes) => json!({ "bufferView": file.view(&bytes) }),
        None => json!({}),
    };
    let images: Vec<Value> = sources.into_iter().map(&mut image).collect();
    file.json["images"] = json!(images);
    file
}

/// A header that is sound, with half of the data.
fn half() -> Vec<u8> {
    let whole = png(SIDE, SIDE);
    whole[..whole.len() / 2].to_vec()
}

/// A header that promises too much.
fn lie() -> Vec<u8> {
    let mut bytes = png(1, 1);
    bytes[16..20].copy_from_slice(&30_000_u32.to_be_bytes());
    let sum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

#[test]
fn the_first_broken_image_is_told() {
    let good = || Some(png(SIDE, SIDE));
    for (later, what) in [
        (Some(half()), "data that does not decode"),
        (Some(lie()), "a header that lies"),
        (None, "no source at all"),
    ] {
        let error = with_images(vec![good(), Some(half()), good(), later]).error();
        assert_eq!(error.kind(), ErrorKind::Image, "{what}: {error}");
        assert_eq!(error.place(), "/images/1", "before {what}: {error}");
    }
}

/// Each image in its own place, and each texture with its image, however many are decoded at a time.
#[test]
fn images_keep_their_order() {
    let sides: Vec<u32> = (1..=40).rev().collect();
    let images = sides.iter().map(|&side| Some(png(side, 1))).collect();
    let mut file = with_images(images);
    file.json["textures"] = (0..sides.len()).map(|i| json!({ "source": i })).collect();
    let d = file.clean();
    let width = |index: usize| d.images[index].width;
    assert!((0..d.images.len()).map(width).eq(sides.iter().copied()));
    let of_textures = d.textures.iter().map(|texture| width(texture.image));
    assert!(of_textures.eq(sides));
    for image in &d.images {
        let Pixels::Rgba8(pixels) = &image.pixels else {
            panic!("bytes expected");
        };
        let last = image.width as u8 - 1;
        assert_eq!(pixels[pixels.len() - 4..], [last, 0, 7, 200]);
    }
}

/// What a PNG of 16 bits holds is kept, takes its memory, and comes back from an export, be the file
/// kept or made anew.
#[test]
fn all_bits_of_16_are_kept() {
    let file = with_images(vec![Some(png_of_16_bits(3, 2))]);
    let loaded = file.load();
    let mut description = loaded.description;
    let last = [2 * 257 + 1, 1, 700, 60_000];
    let Pixels::Rgba16(values) = &description.images[0].pixels else {
        panic!("16 bits expected");
    };
    assert_eq!((values.len(), &values[20..]), (24, &last[..]));
    let eight = with_images(vec![Some(png(3, 2))]).load();
    assert!(loaded.memory >= eight.memory + 4 * 6);
    for made in [false, true] {
        if made {
            Arc::make_mut(&mut description.images[0]).encoded = Vec::new();
        }
        let written = export_bytes(&description).unwrap();
        let back = load_bytes(&written, "test.glb", &LoadOptions::default()).unwrap();
        assert_eq!(back.description, description, "made: {made}");
    }
}

/// Memory to work in counts for those that are decoded at the time: what is enough for one after the other is enough.
#[test]
fn images_that_fit_one_by_one_fit() {
    let file = with_images(vec![Some(png(SIDE, SIDE)); 12]);
    let kept = file.load().memory;
    let scratch = u64::from(4 * SIDE * SIDE);
    let within = |bytes| file.load_with(&LoadOptions::default().with_max_memory(bytes));
    let loaded = within(kept + scratch).expect("room for one at a time");
    assert_eq!(loaded.description.images.len(), 12);
    let error = within(kept + scratch - 1).unwrap_err();
    assert_eq!(
        (error.kind(), error.place()),
        (ErrorKind::Budget, "/images/11")
    );
}

/// What ambient occlusion alone looks at is not read, and may be missing or broken; as soon as anything else does, it is.
#[test]
fn images_of_occlusion_alone_are_not_read() {
    let mut file = with_images(vec![Some(png(2, 1)), Some(half())]);
    file.push("images", json!({ "uri": "nowhere.png" }));
    file.json["textures"] = json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }]);
    file.json["materials"] = json!([
        { "occlusionTexture": { "index": 1 }, "emissiveTexture": { "index": 0 } },
        { "occlusionTexture": { "index": 2 } },
    ]);
    let description = file.clean();
    assert_eq!(
        (description.images.len(), description.textures.len()),
        (1, 1)
    );
    assert_eq!(description.images[0].width, 2);
    let sheen = json!({ "KHR_materials_sheen": { "sheenColorTexture": { "index": 1 } } });
    let base = json!({ "baseColorTexture": { "index": 1 } });
    for (key, value) in [("extensions", sheen), ("pbrMetallicRoughness", base)] {
        let mut file = file.clone();
        file.json["materials"][1][key] = value;
        assert_eq!(file.error().place(), "/images/1");
    }
    // Of another texture, which no material names.
    file.push("textures", json!({ "source": 1 }));
    assert_eq!(file.error().place(), "/images/1");
}
