//! Small glTF files, made in place.

use serde_json::{Value, json};

use crate::gltf::{LoadError, LoadOptions, Loaded, load_bytes};

/// A file in the making.
#[derive(Clone, Debug)]
pub(super) struct File {
    pub(super) json: Value,
    pub(super) binary: Vec<u8>,
}

pub(super) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub(super) fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub(super) const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

impl File {
    /// Nothing but a version.
    pub(super) fn empty() -> Self {
        Self {
            json: json!({ "asset": { "version": "2.0" } }),
            binary: Vec::new(),
        }
    }

    /// One triangle, placed by one node: accessor 0 holds positions, 1 indices.
    pub(super) fn triangle() -> Self {
        let mut file = Self::empty();
        file.accessor("VEC3", 5126, 3, &floats(&TRIANGLE));
        file.accessor("SCALAR", 5123, 3, &shorts(&[0, 1, 2]));
        file.json["meshes"] = json!([{ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1 }
        ]}]);
        file.json["nodes"] = json!([{ "mesh": 0 }]);
        file.json["scenes"] = json!([{ "nodes": [0] }]);
        file.json["scene"] = json!(0);
        file
    }

    pub(super) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Appends to an array of the document; the index of what was appended.
    pub(super) fn push(&mut self, key: &str, value: Value) -> usize {
        if self.json[key].is_null() {
            self.json[key] = json!([]);
        }
        let array = self.json[key].as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        self.push("bufferViews", view)
    }

    pub(super) fn accessor(
        &mut self,
        kind: &str,
        component: u32,
        count: usize,
        bytes: &[u8],
    ) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "type": kind, "componentType": component, "count": count, "bufferView": view });
        self.push("accessors", accessor)
    }

    /// Another attribute of the one primitive.
    pub(super) fn attribute(&mut self, name: &str, kind: &str, component: u32, bytes: &[u8]) {
        let accessor = self.accessor(kind, component, 3, bytes);
        self.json["accessors"][accessor]["normalized"] = json!(component != 5126);
        self.primitive()["attributes"][name] = json!(accessor);
    }

    pub(super) fn json_bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.binary.is_empty() && json["buffers"].is_null() {
            json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        json.to_string().into_bytes()
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        glb(&self.json_bytes(), &self.binary)
    }

    pub(super) fn load_with(&self, options: &LoadOptions) -> Result<Loaded, LoadError> {
        load_bytes(&self.glb(), "test.glb", options)
    }

    pub(super) fn load(&self) -> Loaded {
        match self.load_with(&LoadOptions::default()) {
            Ok(loaded) => loaded,
            Err(e) => panic!("{e}"),
        }
    }

    /// Loads what must be without a warning.
    pub(super) fn clean(&self) -> crate::Description {
        let loaded = self.load();
        assert_eq!(loaded.warnings, []);
        loaded.description
    }

    /// The description and the one warning there must be.
    pub(super) fn warned(&self) -> (crate::Description, String) {
        let loaded = self.load();
        assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
        (loaded.description, loaded.warnings[0].to_string())
    }

    pub(super) fn error(&self) -> LoadError {
        match self.load_with(&LoadOptions::default()) {
            Ok(_) => panic!("this should have been refused: {}", self.json),
            Err(e) => e,
        }
    }

    /// The error's message must hold these words.
    pub(super) fn refused(&self, words: &[&str]) {
        let message = self.error().to_string();
        for word in words {
            assert!(message.contains(word), "\"{message}\" lacks \"{word}\"");
        }
    }
}

/// A GLB of these chunks; an empty binary chunk is left out.
pub(super) fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk, fill) in [(b"JSON", json, b' '), (b"BIN\0", binary, 0)] {
        if kind == b"BIN\0" && chunk.is_empty() {
            continue;
        }
        let length = chunk.len().next_multiple_of(4);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
        bytes.resize(bytes.len() + length - chunk.len(), fill);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

/// A PNG of four bytes a pixel.
pub(super) fn png(width: u32, height: u32) -> Vec<u8> {
    let pixel = |x: u32, y: u32| image::Rgba([x as u8, y as u8, 7, 200]);
    encode(width, height, pixel, image::ImageFormat::Png)
}

/// A PNG of 16 bits a channel, whose lower bytes differ from the upper ones.
pub(super) fn png_of_16_bits(width: u32, height: u32) -> Vec<u8> {
    let pixel = |x: u32, y: u32| image::Rgba([257 * x as u16 + 1, y as u16, 700, 60_000]);
    let mut bytes = std::io::Cursor::new(Vec::new());
    (image::ImageBuffer::from_fn(width, height, pixel))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// A lossless WebP of four bytes a pixel.
pub(super) fn webp(width: u32, height: u32) -> Vec<u8> {
    let pixel = |x: u32, y: u32| image::Rgba([(9 * x) as u8, (5 * y) as u8, 7, 200 + x as u8]);
    encode(width, height, pixel, image::ImageFormat::WebP)
}

pub(super) fn jpeg(width: u32, height: u32) -> Vec<u8> {
    let pixel = |x: u32, y: u32| image::Rgb([(16 * x) as u8, (16 * y) as u8, 7]);
    encode(width, height, pixel, image::ImageFormat::Jpeg)
}

fn encode<P>(
    width: u32,
    height: u32,
    pixel: impl FnMut(u32, u32) -> P,
    format: image::ImageFormat,
) -> Vec<u8>
where
    P: image::Pixel<Subpixel = u8> + image::PixelWithColorType,
{
    let mut bytes = std::io::Cursor::new(Vec::new());
    let buffer = image::ImageBuffer::from_fn(width, height, pixel);
    buffer.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}
