//! Lines as glTF, for any viewer: not a scene that loads here.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use serde_json::{Value, json};

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What a viewer calls it.
    pub name: String,
    /// Linear red, green and blue, in [0, 1].
    pub color: [f32; 3],
    /// At least two, else there is nothing to see; what is not finite is left out.
    pub points: Vec<Vec3>,
}

/// The text of a `.gltf` file: a node for each line, drawn as LINE_STRIP and unlit, everything embedded. `notes` go
/// into the `extras` of its asset.
pub fn lines(lines: &[Line], notes: &Value) -> String {
    let mut lists = Lists::default();
    for line in lines {
        lists.add(line);
    }
    let mut file = json!({
        "asset": { "version": "2.0", "generator": "kaustik", "extras": notes },
    });
    if !lists.nodes.is_empty() {
        lists.write(&mut file);
    }
    format!("{file:#}\n")
}

/// The lists of a file, one member of each for a line, and the coordinates of all points.
#[derive(Default)]
struct Lists {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    materials: Vec<Value>,
}

impl Lists {
    fn add(&mut self, line: &Line) {
        let points = line.points.iter().copied().filter(|p| p.is_finite());
        let points: Vec<Vec3> = points.collect();
        let Some(first) = points.first().filter(|_| points.len() > 1) else {
            return;
        };
        let low = points.iter().fold(*first, |low, p| low.min(*p));
        let high = points.iter().fold(*first, |high, p| high.max(*p));
        let index = self.nodes.len();
        let start = self.buffer.len();
        for point in &points {
            let bytes = point.to_array().into_iter().flat_map(f32::to_le_bytes);
            self.buffer.extend(bytes);
        }
        self.views.push(json!({
            "buffer": 0, "byteOffset": start, "byteLength": self.buffer.len() - start, "target": 34962,
        }));
        self.accessors.push(json!({
            "bufferView": index, "componentType": 5126, "count": points.len(), "type": "VEC3",
            "min": low.to_array(), "max": high.to_array(),
        }));
        let [r, g, b] = line.color;
        self.materials.push(json!({
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0 },
            "extensions": { "KHR_materials_unlit": {} },
        }));
        self.meshes.push(json!({
            "name": line.name,
            "primitives": [{ "attributes": { "POSITION": index }, "mode": 3, "material": index }],
        }));
        self.nodes.push(json!({ "name": line.name, "mesh": index }));
    }

    /// Into a document, whose only scene they become.
    fn write(self, file: &mut Value) {
        let all: Vec<usize> = (0..self.nodes.len()).collect();
        file["scene"] = json!(0);
        file["scenes"] = json!([{ "nodes": all }]);
        file["extensionsUsed"] = json!(["KHR_materials_unlit"]);
        let uri = format!(
            "data:application/octet-stream;base64,{}",
            STANDARD.encode(&self.buffer)
        );
        file["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": uri }]);
        for (name, values) in [
            ("bufferViews", self.views),
            ("accessors", self.accessors),
            ("meshes", self.meshes),
            ("nodes", self.nodes),
            ("materials", self.materials),
        ] {
            file[name] = Value::Array(values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_a_sound_file() {
        let line = |points: &[[f32; 3]]| Line {
            name: "camera".to_owned(),
            color: [1.0, 0.5, 0.0],
            points: points.iter().copied().map(Vec3::from).collect(),
        };
        let nan = [f32::NAN, 0.0, 0.0];
        let all = [
            line(&[[0.0, 1.0, 2.0], nan, [-3.0, 4.0, 5.0]]),
            line(&[[1.0; 3], nan]),
            line(&[[1.0; 3], [2.0; 3], [3.0; 3]]),
        ];
        let text = lines(&all, &json!({ "step": 7 }));
        let file = gltf::Gltf::from_slice(text.as_bytes()).expect("a sound file");
        let uri = file.buffers().next().map(|buffer| match buffer.source() {
            gltf::buffer::Source::Uri(uri) => uri.to_owned(),
            gltf::buffer::Source::Bin => String::new(),
        });
        let payload = uri.as_deref().and_then(|uri| uri.split_once("base64,"));
        let buffer = STANDARD.decode(payload.expect("a data uri").1);
        let buffer = buffer.expect("base64");
        let counts: Vec<usize> = file
            .meshes()
            .flat_map(|mesh| mesh.primitives().collect::<Vec<_>>())
            .map(|primitive| {
                assert_eq!(primitive.mode(), gltf::mesh::Mode::LineStrip);
                let accessor = primitive.get(&gltf::Semantic::Positions).expect("points");
                let view = accessor.view().expect("a view");
                let bytes = &buffer[view.offset()..view.offset() + view.length()];
                let numbers = bytes
                    .chunks(4)
                    .map(|b| f32::from_le_bytes(b.try_into().expect("four")));
                assert!(numbers.clone().all(f32::is_finite));
                assert_eq!(numbers.count(), 3 * accessor.count());
                accessor.count()
            })
            .collect();
        assert_eq!(counts, [2, 3]);
        assert_eq!(file.nodes().count(), 2);
        let empty = lines(&[], &Value::Null);
        assert!(gltf::Gltf::from_slice(empty.as_bytes()).is_ok(), "{empty}");
    }
}
