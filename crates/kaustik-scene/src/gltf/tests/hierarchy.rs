//! Nodes, scenes, cameras and lights.

use glam::{Affine3A, Quat, Vec3};
use serde_json::{Value, json};

use super::file::{File, floats};
use crate::description::{Blades, Lens, LightKind, Projection, Shutter};
use crate::gltf::{ErrorKind, LoadOptions};

fn nodes(nodes: Value, roots: Value) -> File {
    let mut file = File::triangle();
    file.json["nodes"] = nodes;
    file.json["scenes"][0]["nodes"] = roots;
    file
}

fn transforms(file: &File) -> Vec<Affine3A> {
    let d = file.clean();
    d.instances.iter().map(|i| i.transform).collect()
}

#[test]
fn parents_apply_to_children() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let file = nodes(
        json!([
            { "children": [2, 1], "translation": [1, 2, 3], "rotation": [0, 0, half, half] },
            { "mesh": 0, "name": "late" },
            { "mesh": 0, "name": "first", "scale": [2, -2, 2], "translation": [1, 0, 0] },
        ]),
        json!([0]),
    );
    let names: Vec<String> = file.clean().instances.into_iter().map(|i| i.name).collect();
    assert_eq!(names, ["first", "late"]);
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let parent = Affine3A::from_rotation_translation(turn, Vec3::new(1.0, 2.0, 3.0));
    let child = Affine3A::from_scale_rotation_translation(
        Vec3::new(2.0, -2.0, 2.0),
        Quat::IDENTITY,
        Vec3::X,
    );
    let found = transforms(&file);
    assert!(found[0].abs_diff_eq(parent * child, 1e-6));
    assert!(found[0].matrix3.determinant() < 0.0);
    assert!(found[1].abs_diff_eq(parent, 1e-6));
}

/// What is hidden is not there, nor what hangs below it; cameras are.
#[test]
fn hidden_nodes_show_nothing() {
    let visible = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let mut file = nodes(
        json!([
            { "extensions": visible(false), "children": [1, 2] },
            { "mesh": 0, "name": "below", "extensions": visible(true) },
            { "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "mesh": 0, "name": "seen", "extensions": { "KHR_node_visibility": {} } },
            { "mesh": 0, "name": "hidden", "extensions": visible(false) },
        ]),
        json!([0, 3, 4]),
    );
    file.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    let used = json!(["KHR_node_visibility", "KHR_lights_punctual"]);
    file.json["extensionsUsed"] = used.clone();
    file.json["extensionsRequired"] = used;
    let found = file.clean();
    let names: Vec<&str> = found.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["seen"]);
    assert_eq!((found.cameras.len(), found.lights.len()), (1, 0));
    file.json["nodes"][4]["extensions"] = json!({ "KHR_node_visibility": { "visible": 0 } });
    assert_eq!(
        file.error().place(),
        "/nodes/4/extensions/KHR_node_visibility/visible"
    );
}

#[test]
fn matrices_keep_their_bits() {
    let m = [
        0.1, -0.0, 3.0, 0.0, 1e-7, 2.5, 0.3, 0.0, 7.0, 0.7, 0.9, 0.0, 1e9, -5.0, 0.2, 1.0,
    ];
    let file = nodes(json!([{ "mesh": 0, "matrix": m }]), json!([0]));
    let found = transforms(&file)[0].to_cols_array();
    let wanted: Vec<f32> = (0..16).filter(|i| i % 4 != 3).map(|i| m[i]).collect();
    for (a, b) in found.iter().zip(&wanted) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
}

#[test]
fn without_a_scene_all_roots_are_shown() {
    let mut file = nodes(
        json!([{ "mesh": 0, "name": "c" }, { "children": [0], "scale": [3, 3, 3] }, { "mesh": 0 }]),
        json!([0]),
    );
    let document = file.json.as_object_mut().unwrap();
    document.remove("scene");
    document.remove("scenes");
    let found = transforms(&file);
    assert_eq!(found[0], Affine3A::from_scale(Vec3::splat(3.0)));
    assert_eq!(found[1], Affine3A::IDENTITY);
}

#[test]
fn the_named_scene_is_shown_else_the_first() {
    let mut file = nodes(
        json!([{ "mesh": 0, "name": "a" }, { "mesh": 0, "name": "b" }]),
        json!([0]),
    );
    file.push("scenes", json!({ "nodes": [1], "name": "second" }));
    file.json["scene"] = json!(1);
    let d = file.clean();
    assert_eq!(
        (d.name.as_str(), d.instances[0].name.as_str()),
        ("second", "b")
    );
    file.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(file.clean().instances[0].name, "a");
    file.json["scene"] = json!(2);
    file.refused(&["/scene:", "found 2", "/scenes, 0 to 1"]);
}

#[test]
fn cycles_and_second_parents_are_refused() {
    let file = nodes(
        json!([{ "children": [1] }, { "children": [0] }]),
        json!([0]),
    );
    assert_eq!(file.error().kind(), ErrorKind::Hierarchy);
    let file = nodes(json!([{ "children": [0] }]), json!([]));
    file.refused(&["/nodes/0", "its own ancestor"]);
    let file = nodes(
        json!([{ "children": [2] }, { "children": [2] }, {}]),
        json!([0, 1]),
    );
    file.refused(&[
        "/nodes/1/children/0",
        "also a child of node 0",
        "let two nodes",
    ]);
    let file = nodes(json!([{ "children": [1] }, {}]), json!([0, 1]));
    file.refused(&["/nodes/1", "twice"]);
    let file = nodes(json!([{ "children": [7] }]), json!([0]));
    file.refused(&["/nodes/0/children/0", "found 7"]);
}

#[test]
fn exponential_graphs_end_at_once() {
    // forty levels, each of which has the next one as a child twice
    let mut all: Vec<Value> = (1..40).map(|i| json!({ "children": [i, i] })).collect();
    all.push(json!({ "mesh": 0 }));
    let error = nodes(all.into(), json!([0])).error();
    assert_eq!(error.kind(), ErrorKind::Hierarchy);
}

#[test]
fn depth_is_bounded_and_overflows_no_stack() {
    let chain = |length: usize| {
        let mut all: Vec<Value> = (1..length).map(|i| json!({ "children": [i] })).collect();
        all.push(json!({ "mesh": 0 }));
        nodes(all.into(), json!([0]))
    };
    let deepest = LoadOptions::default().max_depth;
    assert_eq!(chain(deepest).clean().instances.len(), 1);
    chain(deepest + 1).refused(&["4097 levels deep", "at most 4096"]);
    chain(200_000).refused(&["levels deep"]);
}

#[test]
fn transforms_that_flatten_are_mended_with_a_warning() {
    let file = nodes(json!([{ "mesh": 0, "rotation": [0, 0, 0, 0] }]), json!([0]));
    assert!(file.warned().1.starts_with("/nodes/0/rotation: "));
    let file = nodes(json!([{ "mesh": 0, "scale": [1, 0, 0] }]), json!([0]));
    let (d, warning) = file.warned();
    assert!(d.instances.is_empty() && warning.contains("scale is 0"));
    // Flattened along one axis it is seen, and as thin as can be.
    let file = nodes(json!([{ "mesh": 0, "scale": [4, 0, 1] }]), json!([0]));
    let (d, warning) = file.warned();
    assert!(warning.contains("flat"), "{warning}");
    let m = d.instances[0].transform.matrix3;
    assert_eq!(
        (m.x_axis.x, m.y_axis.x, m.y_axis.z, m.z_axis.z),
        (4.0, 0.0, 0.0, 1.0)
    );
    assert!((m.y_axis.y - 2e-4).abs() < 1e-9, "{m}");
    let turned = [0.0, 0.382_683_43, 0.0, 0.923_879_5];
    let file = nodes(
        json!([{ "mesh": 0, "rotation": turned, "scale": [2, 2, 0] }]),
        json!([0]),
    );
    assert_eq!(file.warned().0.instances.len(), 1);
    let file = nodes(
        json!([{ "scale": [1e30, 1, 1], "children": [1] }, { "mesh": 0, "scale": [1e30, 1, 1] }]),
        json!([0]),
    );
    assert_eq!(file.error().kind(), ErrorKind::NotFinite);
    let file = nodes(json!([{ "mesh": 0, "scale": [1e300, 1, 1] }]), json!([0]));
    file.refused(&["/nodes/0/scale/0", "single precision"]);
    let file = nodes(json!([{ "mesh": 0, "matrix": [1, 2, 3] }]), json!([0]));
    file.refused(&[
        "/nodes/0/matrix",
        "an array of 3 values",
        "an array of 16 numbers",
    ]);
}

#[test]
fn each_copy_of_a_node_is_an_instance() {
    let mut file = File::triangle();
    let t = file.accessor("VEC3", 5126, 2, &floats(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0]));
    let s = file.accessor("VEC3", 5126, 2, &floats(&[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]));
    let r = file.accessor(
        "VEC4",
        5122,
        2,
        &super::file::shorts(&[0, 0, 0, 32767, 0, 0, 32767, 0]),
    );
    file.json["accessors"][r]["normalized"] = json!(true);
    file.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": {
        "TRANSLATION": t, "SCALE": s, "ROTATION": r,
    }}});
    file.json["nodes"][0]["translation"] = json!([0, 0, 5]);
    let found = transforms(&file);
    assert_eq!(
        found[0],
        Affine3A::from_translation(Vec3::new(1.0, 0.0, 5.0))
    );
    let expected = Vec3::new(-3.0, 2.0, 5.0);
    assert!(
        found[1]
            .transform_point3(Vec3::X)
            .abs_diff_eq(expected, 1e-6)
    );
    file.json["accessors"][s]["count"] = json!(1);
    file.refused(&["attributes/SCALE", "2, as the other"]);
}

#[test]
fn instances_have_a_limit() {
    let mut file = File::triangle();
    // two billion copies out of nothing
    let accessor = json!({ "type": "VEC3", "componentType": 5126, "count": 2_000_000_000_u32 });
    let t = file.push("accessors", accessor);
    file.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": t } } });
    assert_eq!(file.error().kind(), ErrorKind::Budget);
    file.json["accessors"][t]["count"] = json!(5_000_000);
    file.refused(&["/nodes/0", "4000000 instances"]);
}

#[test]
fn cameras_are_in_the_order_of_the_file_or_refused() {
    let mut file = nodes(
        json!([
            { "camera": 1, "name": "node" },
            { "camera": 0, "translation": [0, 0, 1] },
            { "camera": 1 },
        ]),
        json!([0, 1, 2]),
    );
    file.json["cameras"] = json!([
        { "name": "wide", "type": "perspective", "perspective": { "yfov": 0.5, "aspectRatio": 2, "znear": 1 },
          "extras": { "kaustik": { "aperture": 0.1, "focus": 3, "shutter": [0, 0.5] }, "other": 1 } },
        { "name": "flat", "type": "orthographic", "orthographic": { "xmag": 2, "ymag": -1, "znear": 0, "zfar": 1 } },
    ]);
    let d = file.clean();
    let names: Vec<&str> = d.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["wide", "node", "flat"]);
    let wide = &d.cameras[0];
    let projection = Projection::Perspective {
        yfov: 0.5,
        aspect_ratio: Some(2.0),
    };
    assert_eq!(wide.projection, projection);
    assert_eq!(
        wide.lens,
        Some(Lens {
            aperture: 0.1,
            focus: 3.0,
            blades: None,
        })
    );
    assert_eq!(
        wide.shutter,
        Some(Shutter {
            open: 0.0,
            close: 0.5
        })
    );
    assert_eq!(wide.transform, Affine3A::from_translation(Vec3::Z));
    let flat = Projection::Orthographic {
        xmag: 2.0,
        ymag: 1.0,
    };
    assert_eq!(d.cameras[1].projection, flat);
    for (pointer, value, words) in [
        ("/cameras/0/perspective/yfov", json!(0), "an angle above 0"),
        ("/cameras/0/perspective/yfov", json!(3.2), "below pi"),
        ("/cameras/0/perspective/aspectRatio", json!(-1), "above 0"),
        (
            "/cameras/0/type",
            json!("fisheye"),
            "perspective or orthographic",
        ),
        ("/cameras/1/orthographic/xmag", json!(0), "other than 0"),
        ("/cameras/0/extras/kaustik/focus", json!(0), "above 0"),
        (
            "/cameras/0/extras/kaustik/shutter",
            json!([1, 0]),
            "open <= close",
        ),
        ("/cameras/0/extras/kaustik", json!(1), "an object"),
    ] {
        let mut file = file.clone();
        *file.json.pointer_mut(pointer).unwrap() = value;
        file.refused(&[pointer, words]);
    }
    let camera = &mut file.json["cameras"][0]["extras"]["kaustik"];
    camera["blades"] = json!(6);
    camera["rotation"] = json!(0.5);
    camera["bokeh"] = json!("round");
    let loaded = file.load();
    let blades = loaded.description.cameras[0]
        .lens
        .and_then(|lens| lens.blades);
    assert_eq!(
        blades,
        Some(Blades {
            count: 6,
            rotation: 0.5
        })
    );
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].message.contains("unknown key"));
    // A prescription is no thin lens: it is refused, whatever it says, and the refusal names what stands in its place.
    for prescription in [
        json!([]),
        json!([{ "radius": 0.05, "thickness": 0.01, "ior": 1.5, "aperture": 0.02 }]),
        json!("double-gauss"),
    ] {
        let mut file = file.clone();
        file.json["cameras"][0]["extras"]["kaustik"]["lens"] = prescription;
        let error = file
            .load_with(&LoadOptions::default())
            .expect_err("a refusal");
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        assert_eq!(error.place(), "/cameras/0/extras/kaustik/lens");
        let message = error.to_string();
        assert!(
            message.contains("thin lens") && message.contains("\"focus\""),
            "{message}"
        );
    }
    for (key, wrong) in [
        ("blades", json!(2)),
        ("blades", json!(65)),
        ("blades", json!(6.5)),
    ] {
        let mut file = file.clone();
        file.json["cameras"][0]["extras"]["kaustik"][key] = wrong;
        assert_eq!(file.error().place(), "/cameras/0/extras/kaustik/blades");
    }
}

#[test]
fn lights_are_in_the_order_of_the_nodes() {
    let mut file = File::empty();
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1, 0.5, 0], "intensity": 40, "range": 10 },
        { "type": "spot", "spot": { "outerConeAngle": 0.5 }, "name": "spot" },
        { "type": "directional" },
    ]}});
    let node = |i: u32| json!({ "extensions": { "KHR_lights_punctual": { "light": i } } });
    file.json["nodes"] = json!([node(0), node(1), node(2)]);
    let d = file.clean();
    assert_eq!(d.lights[0].color, [1.0, 0.5, 0.0]);
    assert_eq!(
        (d.lights[0].intensity, d.lights[0].range),
        (40.0, Some(10.0))
    );
    assert_eq!(
        d.lights[1].kind,
        LightKind::Spot {
            inner: 0.0,
            outer: 0.5
        }
    );
    assert_eq!(d.lights[1].name, "spot");
    assert_eq!(d.lights[2].kind, LightKind::Directional);
    file.json["nodes"][0] = node(3);
    file.refused(&["/nodes/0/extensions/KHR_lights_punctual/light", "found 3"]);
    file.json["nodes"][0] = node(0);
    file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = json!("laser");
    file.refused(&["lights/0/type", "\"laser\"", "point, spot or directional"]);
}
