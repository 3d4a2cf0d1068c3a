//! Small sound scene files that between them use all that the loader reads.

use meshoptimizer_rs::{Workspace, codec};
use serde_json::{Value, json};

use kaustik::scene::{builtin, gltf};

use crate::kind::Kind;
use crate::picture;

/// A scene file in its two parts.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) json: Value,
    pub(crate) binary: Vec<u8>,
}

/// All of them.
pub(crate) fn all() -> Vec<Model> {
    let mut models = vec![
        triangle(),
        textured(&picture::first(Kind::Png)),
        textured(&picture::first(Kind::Jpeg)),
        textured(&picture::first(Kind::Webp)),
        sparse(),
        quantized(),
        instanced(),
        lit(),
        variants(),
        compressed(),
        in_a_cube(),
        bent(),
        moving(),
    ];
    for words in ["cornell", "glass-cube", "furnace?kind=plate"] {
        models.extend(exported(words));
    }
    for material in [
        "varnished",
        "velvet",
        "soap",
        "brushed",
        "glossy-paint",
        "colored-glass",
        "pane",
        "rough-pane",
        "coated",
        "glowing",
    ] {
        models.push(with_material(material));
    }
    models
}

impl Model {
    fn empty() -> Self {
        Self {
            json: json!({ "asset": { "version": "2.0" } }),
            binary: Vec::new(),
        }
    }

    /// The text, with its buffer's length if it does not say one.
    pub(crate) fn complete(&self) -> Value {
        let mut json = self.json.clone();
        if json["buffers"].is_null() && !self.binary.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        json
    }

    /// A GLB file.
    pub(crate) fn glb(&self) -> Vec<u8> {
        joined(self.complete().to_string().as_bytes(), &self.binary)
    }

    fn push(&mut self, key: &str, value: Value) -> usize {
        match &mut self.json[key] {
            Value::Array(array) => {
                array.push(value);
                array.len() - 1
            }
            other => {
                *other = json!([value]);
                0
            }
        }
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "type": kind, "componentType": component, "count": count, "bufferView": view });
        self.push("accessors", accessor)
    }

    fn attribute(&mut self, name: &str, kind: &str, values: &[f32], width: usize) {
        let accessor = self.accessor(kind, 5126, values.len() / width, &floats(values));
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }
}

/// A GLB file of two chunks.
pub(crate) fn joined(text: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk, fill) in [(b"JSON", text, b' '), (b"BIN\0", binary, 0)] {
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

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

const CORNERS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.2];

/// Two triangles in a small hierarchy, with normals.
fn triangle() -> Model {
    let mut model = Model::empty();
    let positions = model.accessor("VEC3", 5126, 4, &floats(&CORNERS));
    let indices = model.accessor("SCALAR", 5123, 6, &shorts(&[0, 1, 2, 2, 1, 3]));
    model.json["meshes"] = json!([{ "primitives": [
        { "attributes": { "POSITION": positions }, "indices": indices, "mode": 4 }
    ]}]);
    let up: Vec<f32> = [0.0, 0.0, 1.0].repeat(4);
    model.attribute("NORMAL", "VEC3", &up, 3);
    model.json["nodes"] = json!([
        { "children": [1, 2], "scale": [1.0, 2.0, 1.0] },
        { "mesh": 0, "translation": [0.5, 0.0, -1.0] },
        { "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 2,0,0,1], "name": "second" },
    ]);
    model.json["scenes"] = json!([{ "nodes": [0], "name": "all" }]);
    model.json["scene"] = json!(0);
    model
}

/// The same with this picture for a base colour, normals and more.
pub(crate) fn textured(picture: &[u8]) -> Model {
    let mut model = triangle();
    model.attribute(
        "TEXCOORD_0",
        "VEC2",
        &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        2,
    );
    model.attribute("COLOR_0", "VEC4", &[0.5; 16], 4);
    model.attribute("TANGENT", "VEC4", &[1.0, 0.0, 0.0, 1.0].repeat(4), 4);
    let view = model.view(picture);
    model.push("images", json!({ "bufferView": view, "name": "picture" }));
    model.json["samplers"] = json!([{ "wrapS": 33648, "wrapT": 33071, "magFilter": 9729 }]);
    let webp = picture.starts_with(b"RIFF");
    let texture = if webp {
        json!({ "sampler": 0, "extensions": { "EXT_texture_webp": { "source": 0 } } })
    } else {
        json!({ "sampler": 0, "source": 0 })
    };
    model.push("textures", texture);
    let moved = json!({ "KHR_texture_transform": {
        "offset": [0.1, 0.2], "rotation": 0.3, "scale": [2.0, 0.5] } });
    model.json["materials"] = json!([{
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0, "extensions": moved },
            "metallicRoughnessTexture": { "index": 0 }, "metallicFactor": 0.5 },
        "normalTexture": { "index": 0, "scale": 0.7 },
        "emissiveTexture": { "index": 0 }, "emissiveFactor": [0.5, 0.5, 0.5],
        "alphaMode": "MASK", "alphaCutoff": 0.2, "doubleSided": true,
    }]);
    model.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    model.json["extensionsUsed"] = json!(["KHR_texture_transform", "EXT_texture_webp"]);
    model
}

/// A sparse accessor over a view, and a strip without indices.
fn sparse() -> Model {
    let mut model = triangle();
    let indices = model.view(&[1, 3]);
    let values = model.view(&floats(&[0.0, 0.0, 0.5, 1.0, 1.0, 1.0]));
    model.json["accessors"][0]["sparse"] = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    let strip = json!({ "attributes": { "POSITION": 0 }, "mode": 5 });
    if let Value::Array(primitives) = &mut model.json["meshes"][0]["primitives"] {
        primitives.push(strip);
    }
    model
}

fn quantized() -> Model {
    let mut model = triangle();
    let bytes = [0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 127, 127, 9, 0];
    let view = model.view(&bytes);
    model.json["bufferViews"][view]["byteStride"] = json!(4);
    model.json["accessors"][0] = json!({
        "type": "VEC3", "componentType": 5120, "normalized": true, "count": 4, "bufferView": view });
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    model
}

fn instanced() -> Model {
    let mut model = triangle();
    let places = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0, -1.0];
    let translation = model.accessor("VEC3", 5126, 3, &floats(&places));
    let turns = [0.0, 0.0, 0.0, 1.0].repeat(3);
    let rotation = model.accessor("VEC4", 5126, 3, &floats(&turns));
    let scale = model.accessor("VEC3", 5126, 3, &floats(&[1.0; 9]));
    model.json["nodes"][1]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": {
        "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale } } });
    model.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    model
}

/// Lights of all kinds, cameras of both, a lens with blades.
fn lit() -> Model {
    let mut model = triangle();
    model.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5 },
          "extras": { "kaustik": { "aperture": 0.1, "focus": 3.0, "blades": 6, "rotation": 0.2 } } },
        { "type": "orthographic", "name": "flat",
          "orthographic": { "xmag": 2.0, "ymag": 1.5, "znear": 0.0, "zfar": 10.0 } },
    ]);
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 5.0, "color": [1.0, 0.5, 0.2], "range": 9.0 },
        { "type": "spot", "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.6 } },
        { "type": "directional", "intensity": 2.0 },
    ]}});
    for i in 0..3 {
        model.push(
            "nodes",
            json!({ "translation": [0.0, 0.0, 2.0],
            "extensions": { "KHR_lights_punctual": { "light": i } } }),
        );
    }
    for i in 0..2 {
        model.push(
            "nodes",
            json!({ "camera": i, "translation": [0.5, 0.5, 4.0] }),
        );
    }
    model.json["scenes"] = json!([{ "nodes": [0, 3, 4, 5, 6, 7] }]);
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model
}

/// A morph target, and a skin of two joints.
fn bent() -> Model {
    let mut model = triangle();
    let lift = model.accessor("VEC3", 5126, 4, &floats(&[0.2; 12]));
    let joints = model.accessor("VEC4", 5123, 4, &shorts(&[0, 1, 0, 0].repeat(4)));
    let weights = [0.25, 0.75, 0.0, 0.0].repeat(4);
    model.attribute("WEIGHTS_0", "VEC4", &weights, 4);
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let binds = model.accessor("MAT4", 5126, 2, &floats(&identity.repeat(2)));
    let primitive = &mut model.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["JOINTS_0"] = json!(joints);
    primitive["targets"] = json!([{ "POSITION": lift, "NORMAL": lift }]);
    model.json["meshes"][0]["weights"] = json!([0.5]);
    for place in [[0.0, 0.0, 0.0], [0.3, 1.0, 0.0]] {
        model.push("nodes", json!({ "translation": place }));
    }
    model.json["skins"] =
        json!([{ "joints": [3, 4], "skeleton": 3, "inverseBindMatrices": binds }]);
    model.json["nodes"][1]["skin"] = json!(0);
    model.json["nodes"][2]["weights"] = json!([1.5]);
    model.json["scenes"][0]["nodes"] = json!([0, 3, 4]);
    model
}

/// Nodes that move while a shutter is open, by all kinds of channels and interpolations.
fn moving() -> Model {
    let mut model = lit();
    model.json["cameras"][0]["extras"]["kaustik"]["shutter"] = json!([0.1, 0.6]);
    let times = model.accessor("SCALAR", 5126, 2, &floats(&[0.0, 1.0]));
    model.json["accessors"][times]["min"] = json!([0.0]);
    model.json["accessors"][times]["max"] = json!([1.0]);
    let places = [0.0, 0.0, 0.0, 1.0, 0.5, 0.0];
    let places = model.accessor("VEC3", 5126, 2, &floats(&places));
    let turns = [0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0];
    let turns = model.accessor("VEC4", 5126, 2, &floats(&turns));
    // Tangents, value, tangents at each time.
    let scales = model.accessor("VEC3", 5126, 6, &floats(&[1.0; 18]));
    let sampler =
        |output: usize, by: &str| json!({ "input": times, "output": output, "interpolation": by });
    let channel = |sampler: u32, node: u32, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    model.json["animations"] = json!([{
        "samplers": [sampler(places, "LINEAR"), sampler(turns, "STEP"), sampler(scales, "CUBICSPLINE")],
        "channels": [
            channel(0, 1, "translation"), channel(1, 0, "rotation"), channel(2, 0, "scale"),
            channel(0, 3, "translation"), channel(0, 6, "translation"),
        ],
    }]);
    model
}

fn variants() -> Model {
    let mut model = triangle();
    let leaf = json!({ "KHR_materials_diffuse_transmission": {
        "diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [0.2, 0.9, 0.4] },
        "KHR_materials_volume": { "thicknessFactor": 0, "attenuationDistance": 0.5 },
        "KHR_materials_transmission": { "transmissionFactor": 0.5 } });
    model.json["materials"] =
        json!([{ "extensions": leaf }, { "extensions": { "KHR_materials_unlit": {} } }]);
    model.json["extensions"] = json!({ "KHR_materials_variants": {
        "variants": [{ "name": "day" }, { "name": "night" }] } });
    let primitive = &mut model.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] = json!({ "KHR_materials_variants": {
        "mappings": [{ "material": 1, "variants": [0, 1] }] } });
    model.json["extensionsUsed"] = json!([
        "KHR_materials_variants",
        "KHR_materials_unlit",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_volume",
        "KHR_materials_transmission"
    ]);
    model
}

/// Vertices and indices compressed.
fn compressed() -> Model {
    let mut model = triangle();
    let mut work = Workspace::default();
    let encoding = codec::VertexEncoding::new(0, 0);
    let vertices = encoding
        .and_then(|e| codec::encode_vertex_buffer(&floats(&CORNERS), 4, 12, e, &mut work))
        .unwrap_or_default();
    let triangles = [0, 1, 2, 2, 1, 3];
    let indices = codec::encode_index_buffer(&triangles, codec::IndexEncoding::DEFAULT, &mut work)
        .unwrap_or_default();
    let mut add = |bytes: &[u8], count: usize, stride: usize, mode: &str, view: usize| {
        let at = model.view(bytes);
        let source = model.json["bufferViews"][at].clone();
        let target = &mut model.json["bufferViews"][view];
        target["extensions"] = json!({ "EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": source["byteOffset"], "byteLength": source["byteLength"],
            "count": count, "byteStride": stride, "mode": mode } });
    };
    add(&vertices, 4, 12, "ATTRIBUTES", 0);
    add(&indices, 6, 2, "TRIANGLES", 1);
    model.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    model
}

fn in_a_cube() -> Model {
    let mut model = triangle();
    let picture = picture::first(Kind::Png);
    let view = model.view(&picture);
    let faces: Vec<usize> = (0..6)
        .map(|_| model.push("images", json!({ "bufferView": view })))
        .collect();
    model.json["extensions"] = json!({ "EXT_lights_image_based": { "lights": [{
        "intensity": 1.5, "rotation": [0.0, 0.0, 0.0, 1.0], "specularImageSize": 8,
        "specularImages": [faces], "irradianceCoefficients": vec![[0.5; 3]; 9] }] } });
    model.json["scenes"][0]["extensions"] = json!({ "EXT_lights_image_based": { "light": 0 } });
    model.json["extensionsUsed"] = json!(["EXT_lights_image_based"]);
    model
}

/// A built-in scene as it is exported.
fn exported(words: &str) -> Option<Model> {
    split(&gltf::export_bytes(&builtin::load(words).ok()?).ok()?)
}

/// The material of a ball on the two triangles.
fn with_material(name: &str) -> Model {
    let mut model = triangle();
    let ball = exported(&format!("material-ball?material={name}"));
    if let Some(ball) = ball {
        model.json["materials"] = json!([ball.json["materials"][0]]);
        model.json["extensionsUsed"] = ball.json["extensionsUsed"].clone();
        model.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    }
    model
}

/// The two parts of a GLB file of ours.
fn split(glb: &[u8]) -> Option<Model> {
    let word = |at: usize| {
        let bytes = glb.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(bytes) as usize)
    };
    let length = word(12)?;
    let json = serde_json::from_slice(glb.get(20..20 + length)?).ok()?;
    let binary = glb.get(28 + length..).unwrap_or_default().to_vec();
    Some(Model { json, binary })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is broken must be sound: else a campaign would see refusals alone.
    #[test]
    fn the_files_are_sound() {
        let models = all();
        assert!(models.len() >= 8);
        for (i, model) in models.iter().enumerate() {
            let options = gltf::LoadOptions::default();
            let loaded = gltf::load_bytes(&model.glb(), "model.glb", &options);
            let loaded = loaded.unwrap_or_else(|e| panic!("model {i}: {e}"));
            assert!(!loaded.description.instances.is_empty(), "model {i}");
            assert_eq!(loaded.warnings, [], "model {i}");
        }
    }
}
