//! Accessors, primitives and meshes.

use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use super::file::{File, TRIANGLE, floats, shorts};
use crate::gltf::ErrorKind;

#[test]
fn a_lone_triangle_is_a_scene() {
    let d = File::triangle().clean();
    assert_eq!((d.meshes.len(), d.instances.len()), (1, 1));
    let mesh = &d.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.indices, [[0, 1, 2]]);
    assert!(mesh.normals.is_empty() && mesh.uv[0].is_empty());
    assert_eq!(d.instances[0].material, None);
}

#[test]
fn nothing_is_a_scene_too() {
    assert_eq!(File::empty().clean(), crate::Description::default());
}

#[test]
fn interleaved_attributes_are_read() {
    let mut file = File::triangle();
    // a word of rubbish, then position and uv side by side
    let mut bytes = vec![0xff; 4];
    for i in 0..3 {
        bytes.extend(floats(&TRIANGLE[3 * i..3 * i + 3]));
        bytes.extend(floats(&[i as f32, 0.5]));
    }
    let view = file.view(&bytes);
    file.json["bufferViews"][view]["byteStride"] = json!(20);
    file.json["accessors"][0] = json!({ "type": "VEC3", "componentType": 5126, "count": 3, "bufferView": view, "byteOffset": 4 });
    let uv = json!({ "type": "VEC2", "componentType": 5126, "count": 3, "bufferView": view, "byteOffset": 16 });
    file.primitive()["attributes"]["TEXCOORD_0"] = json!(2);
    file.push("accessors", uv);
    let d = file.clean();
    assert_eq!(d.meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    let uv = [0.0, 1.0, 2.0].map(|u| Vec2::new(u, 0.5));
    assert_eq!(d.meshes[0].uv[0], uv);
}

#[test]
fn a_stride_below_the_element_is_refused() {
    let mut file = File::triangle();
    file.json["bufferViews"][0]["byteStride"] = json!(8);
    file.refused(&["/accessors/0", "byteStride 8", "12 bytes"]);
}

#[test]
fn sparse_over_data_and_over_nothing() {
    for over_data in [true, false] {
        let mut file = File::triangle();
        let indices = file.view(&[1]);
        let values = file.view(&floats(&[5.0, 6.0, 7.0]));
        file.json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        if !over_data {
            let accessor = file.json["accessors"][0].as_object_mut().unwrap();
            accessor.remove("bufferView");
        }
        let last = if over_data { Vec3::Y } else { Vec3::ZERO };
        let expected = [Vec3::ZERO, Vec3::new(5.0, 6.0, 7.0), last];
        assert_eq!(file.clean().meshes[0].positions, expected);
        file.json["accessors"][0]["sparse"]["count"] = json!(4);
        file.refused(&["/accessors/0/sparse/count", "4", "at most"]);
        file.json["accessors"][0]["sparse"]["count"] = json!(2);
        file.refused(&["/accessors/0/sparse/indices", "within the 1 bytes"]);
    }
}

#[test]
fn sparse_indices_stay_below_the_count() {
    let mut file = File::triangle();
    let indices = file.view(&[3]);
    let values = file.view(&floats(&[0.0; 3]));
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    file.refused(&["/accessors/0/sparse/indices", "found 3", "below"]);
}

#[test]
fn normalised_integers_become_fractions() {
    let mut file = File::triangle();
    let uv = shorts(&[0, 65535, 65535, 0, 0, 0]);
    file.attribute("TEXCOORD_0", "VEC2", 5123, &uv);
    file.attribute("TEXCOORD_1", "VEC2", 5121, &[0, 255, 255, 0, 51, 0]);
    file.attribute("COLOR_0", "VEC3", 5121, &[255, 0, 51, 0, 0, 0, 0, 0, 0]);
    let mesh = file.clean().meshes[0].clone();
    assert_eq!(mesh.uv[0], [Vec2::Y, Vec2::X, Vec2::ZERO]);
    assert_eq!(mesh.uv[1][2], Vec2::new(0.2, 0.0));
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.2, 1.0]);
}

#[test]
fn all_kinds_of_colours_read_alike() {
    let values = [1.0, 0.0, 1.0, 0.0];
    for width in [3, 4] {
        for component in [5121, 5123, 5126] {
            let three = || (0..3 * width).map(|i| values[i % width]);
            let bytes: Vec<u8> = match component {
                5121 => three().map(|v| (v * 255.0) as u8).collect(),
                5123 => shorts(&three().map(|v| (v * 65535.0) as u16).collect::<Vec<_>>()),
                _ => floats(&three().collect::<Vec<_>>()),
            };
            let mut file = File::triangle();
            file.attribute("COLOR_0", &format!("VEC{width}"), component, &bytes);
            let alpha = if width == 3 { 1.0 } else { 0.0 };
            let expected = [[1.0, 0.0, 1.0, alpha]; 3];
            assert_eq!(
                file.clean().meshes[0].colors,
                expected,
                "{width} {component}"
            );
        }
    }
}

#[test]
fn attributes_of_the_wrong_kind_are_refused() {
    for (name, kind, component, words) in [
        ("NORMAL", "VEC2", 5126, "VEC3 of FLOAT"),
        ("NORMAL", "VEC3", 5120, "VEC3 of FLOAT"),
        ("TANGENT", "VEC3", 5126, "VEC4 of FLOAT"),
        ("TEXCOORD_0", "VEC2", 5125, "VEC2 of FLOAT"),
        ("TEXCOORD_0", "VEC2", 5120, "VEC2 of FLOAT"),
        ("COLOR_0", "SCALAR", 5126, "VEC3 or VEC4"),
        ("COLOR_0", "VEC4", 5122, "VEC3 or VEC4"),
    ] {
        let mut file = File::triangle();
        file.attribute(name, kind, component, &[0; 64]);
        file.refused(&["/accessors/2", words]);
    }
    let mut file = File::triangle();
    file.attribute("TEXCOORD_0", "VEC2", 5121, &[0; 6]);
    file.json["accessors"][2]["normalized"] = json!(false);
    file.refused(&["/accessors/2", "normalized"]);
}

#[test]
fn quantised_vertices_need_their_extension() {
    let mut file = File::triangle();
    let bytes = shorts(&[0, 0, 0, 7, 0, 0, 0, 9, 0]);
    let accessor = file.accessor("VEC3", 5123, 3, &bytes);
    file.primitive()["attributes"]["POSITION"] = json!(accessor);
    file.attribute("NORMAL", "VEC3", 5120, &[0, 0, 127, 0, 0, 127, 0, 129, 0]);
    file.refused(&["/accessors/2", "KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = file.clean().meshes[0].clone();
    assert_eq!(mesh.positions[1], Vec3::new(7.0, 0.0, 0.0));
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::NEG_Y]);
}

#[test]
fn strips_and_fans_become_triangles() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, expected) in [
        (4, vec![[0, 1, 2]]),
        (5, vec![[0, 1, 2], [1, 3, 2]]),
        (6, vec![[1, 2, 0], [2, 3, 0]]),
    ] {
        let mut file = File::triangle();
        let accessor = file.accessor("VEC3", 5126, 4, &floats(&square));
        *file.primitive() = json!({ "attributes": { "POSITION": accessor }, "mode": mode });
        let loaded = file.load();
        assert_eq!(loaded.description.meshes[0].indices, expected);
        // four vertices are no whole triangles
        assert_eq!(loaded.warnings.len(), usize::from(mode == 4));
    }
}

#[test]
fn lines_and_points_are_left_out() {
    for mode in 0..4 {
        let mut file = File::triangle();
        file.primitive()["mode"] = json!(mode);
        let (d, warning) = file.warned();
        assert!(d.meshes.is_empty() && d.instances.is_empty());
        assert!(warning.starts_with("/meshes/0/primitives/0: "), "{warning}");
    }
    let mut file = File::triangle();
    file.primitive()["mode"] = json!(7);
    file.refused(&["/meshes/0/primitives/0", "mode 7"]);
}

#[test]
fn indices_out_of_range_are_refused() {
    let mut file = File::triangle();
    let accessor = file.accessor("SCALAR", 5121, 3, &[0, 1, 3]);
    file.primitive()["indices"] = json!(accessor);
    file.refused(&["/meshes/0/primitives/0/indices", "index 3", "below 3"]);
    let accessor = file.accessor("SCALAR", 5126, 3, &floats(&[0.0; 3]));
    file.primitive()["indices"] = json!(accessor);
    file.refused(&["/accessors/3", "unsigned"]);
}

#[test]
fn positions_must_be_finite() {
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut file = File::triangle();
        file.binary[16..20].copy_from_slice(&wrong.to_le_bytes());
        let error = file.error();
        assert_eq!(error.kind(), ErrorKind::NotFinite);
        assert_eq!(error.place(), "/meshes/0/primitives/0/attributes/POSITION");
        assert!(error.found().contains("vertex 1"), "{error}");
    }
}

#[test]
fn other_attributes_are_mended() {
    let nan = f32::NAN;
    let mut file = File::triangle();
    file.attribute(
        "NORMAL",
        "VEC3",
        5126,
        &floats(&[0.0, 0.0, 1.0, nan, 0.0, 0.0, 0.0, 0.0, 2.0]),
    );
    let (d, warning) = file.warned();
    assert_eq!(d.meshes[0].normals, [Vec3::Z, Vec3::ZERO, 2.0 * Vec3::Z]);
    assert!(warning.contains("attributes/NORMAL: vertex 1"), "{warning}");

    let mut file = File::triangle();
    file.attribute(
        "TEXCOORD_0",
        "VEC2",
        5126,
        &floats(&[1.0, nan, 1.0, 1.0, 1.0, 1.0]),
    );
    let (d, _) = file.warned();
    assert_eq!(d.meshes[0].uv[0], [Vec2::ZERO, Vec2::ONE, Vec2::ONE]);

    let mut file = File::triangle();
    file.attribute(
        "COLOR_0",
        "VEC3",
        5126,
        &floats(&[-1.0, 0.0, 0.0, 0.5, 0.5, 0.5, 2.0, 0.0, 0.0]),
    );
    let colors = &file.clean().meshes[0].colors;
    assert_eq!(colors[0], [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(colors[2], [1.0, 0.0, 0.0, 1.0]);

    let mut file = File::triangle();
    let values = [nan, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 0.0, 0.0];
    file.attribute("COLOR_0", "VEC3", 5126, &floats(&values));
    let (d, _) = file.warned();
    assert_eq!(d.meshes[0].colors[0], [1.0; 4]);

    let mut file = File::triangle();
    let mut tangents = [1.0, 0.0, 0.0, -0.5, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    file.attribute("TANGENT", "VEC4", 5126, &floats(&tangents));
    let expected = Vec4::new(1.0, 0.0, 0.0, -1.0);
    assert_eq!(file.clean().meshes[0].tangents[0], expected);
    let mut file = File::triangle();
    tangents[5] = nan;
    file.attribute("TANGENT", "VEC4", 5126, &floats(&tangents));
    let (d, _) = file.warned();
    assert!(d.meshes[0].tangents.is_empty());
}

#[test]
fn attributes_must_be_as_many_as_positions() {
    let mut file = File::triangle();
    let accessor = file.accessor("VEC3", 5126, 2, &floats(&[0.0; 6]));
    file.primitive()["attributes"]["NORMAL"] = json!(accessor);
    file.refused(&[
        "/meshes/0/primitives/0/attributes/NORMAL",
        "2 values",
        "3 positions",
    ]);
}

#[test]
fn the_same_accessors_are_one_mesh() {
    let mut file = File::triangle();
    file.json["materials"] = json!([{ "name": "a" }, { "name": "b" }]);
    file.primitive()["material"] = json!(0);
    let mut other = file.primitive().clone();
    other["material"] = json!(1);
    file.push("meshes", json!({ "primitives": [other.clone(), other] }));
    file.json["nodes"] = json!([{ "mesh": 1 }, { "mesh": 0 }]);
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let d = file.clean();
    assert_eq!(d.meshes.len(), 1);
    let materials: Vec<_> = d.instances.iter().map(|i| i.material).collect();
    assert_eq!(materials, [Some(1), Some(1), Some(0)]);
}

#[test]
fn primitives_over_shared_vertices_get_their_own_alone() {
    let mut file = File::empty();
    let positions: Vec<f32> = (0..3 * 100).map(|i| i as f32).collect();
    let attributes = json!({
        "POSITION": file.accessor("VEC3", 5126, 100, &floats(&positions)),
        "NORMAL": file.accessor("VEC3", 5126, 100, &floats(&positions)),
    });
    let mut primitives = Vec::new();
    for corners in [[97, 3, 50], [0, 1, 2], [1, 1, 99]] {
        let indices = file.accessor("SCALAR", 5123, 3, &shorts(&corners));
        primitives.push(json!({ "attributes": attributes, "indices": indices }));
    }
    file.json["meshes"] = json!([{ "primitives": primitives }]);
    let d = file.clean();
    let xs = |i: usize| -> Vec<f32> { d.meshes[i].positions.iter().map(|p| p.x).collect() };
    assert_eq!(xs(0), [9.0, 150.0, 291.0]);
    assert_eq!(d.meshes[0].indices, [[2, 0, 1]]);
    assert_eq!(d.meshes[0].normals, d.meshes[0].positions);
    assert_eq!(xs(1), [0.0, 3.0, 6.0]);
    assert_eq!(d.meshes[2].indices, [[0, 0, 1]]);
}

#[test]
fn vertices_shared_in_turns_go_where_they_belong() {
    let mut file = File::empty();
    let count = 2_000;
    let mut sets = Vec::new();
    for start in [0.0, 1e4] {
        let positions: Vec<f32> = (0..3 * count).map(|i| start + i as f32).collect();
        sets.push(file.accessor("VEC3", 5126, count, &floats(&positions)));
    }
    let mut primitives = Vec::new();
    for index in 0..40_u16 {
        let indices = file.accessor("SCALAR", 5123, 3, &shorts(&[index, index + 1, index + 2]));
        let set = sets[usize::from(index % 2)];
        primitives.push(json!({ "attributes": { "POSITION": set }, "indices": indices }));
    }
    file.json["meshes"] = json!([{ "primitives": primitives }]);
    let meshes = file.clean().meshes;
    assert_eq!(meshes.len(), 40);
    for (index, mesh) in meshes.iter().enumerate() {
        let start = [0.0, 1e4][index % 2];
        assert_eq!(mesh.positions[0].x, start + 3.0 * index as f32);
        assert_eq!(mesh.positions.len(), 3);
    }
}
