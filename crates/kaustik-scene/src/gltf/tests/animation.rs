//! Animations: what they say, and files made to hurt.

use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::file::{File, floats};
use crate::description::{Interpolation, Load};
use crate::gltf::{ErrorKind, LoadError, LoadOptions, Loaded};
use crate::{Scene, SceneOptions};

/// A triangle (node 0) below a node (1) that a sampler moves along x from 0 to 2 within two seconds, and a camera
/// (node 2) whose shutter is open for these.
fn file() -> File {
    let mut file = File::triangle();
    file.accessor("SCALAR", 5126, 2, &floats(&[0.0, 2.0]));
    file.accessor("VEC3", 5126, 2, &floats(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]));
    file.json["nodes"] = json!([
        { "mesh": 0, "translation": [0, 5, 0] },
        { "children": [0], "name": "carrier", "scale": [3, 3, 3] },
        { "camera": 0 }
    ]);
    file.json["scenes"] = json!([{ "nodes": [1, 2] }]);
    file.json["cameras"] = json!([{
        "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 },
        "extras": { "kaustik": { "shutter": [0, 2] } }
    }]);
    file.json["animations"] = json!([{
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        "samplers": [{ "input": 2, "output": 3 }]
    }]);
    file
}

fn load(file: &File) -> Result<Loaded, LoadError> {
    file.load_with(&LoadOptions::default())
}

#[test]
fn samplers_become_channels_of_joints() {
    let loaded = load(&file()).expect("a sound file");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let animation = &loaded.description.animation;
    let joint = &animation.joints[0];
    assert_eq!((joint.name.as_str(), joint.parent), ("carrier", None));
    assert_eq!(joint.rest.scale, [3.0; 3]);
    let channel = joint.translation.as_ref().expect("a translation");
    assert_eq!(channel.interpolation, Interpolation::Linear);
    assert_eq!(channel.times, [0.0, 2.0]);
    assert_eq!(channel.values, [[0.0; 3], [2.0, 0.0, 0.0]]);
    let carried = animation.carried[0];
    assert_eq!((carried.load, carried.joint), (Load::Instance(0), 0));
    assert_eq!(
        carried.offset,
        DAffine3::from_translation(DVec3::new(0.0, 5.0, 0.0))
    );
    // At half of the interval: 1 along x, and 3 times 5 up.
    let options = SceneOptions::default();
    let scene = Scene::new(&loaded.description, &options).expect("a scene");
    let corner = scene.at(0.5).world().triangle(0, 0)[0];
    assert!(
        (corner - glam::Vec3::new(1.0, 15.0, 0.0)).length() < 1e-6,
        "{corner}"
    );
    assert!(scene.moves());
}

/// Two moving nodes one above the other, with something still in between; a light and a copy move along.
#[test]
fn all_that_hangs_below_moves_along() {
    let mut file = file();
    file.json["nodes"] = json!([
        { "mesh": 0, "children": [3], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "children": [0], "translation": [0, 0, 7] },
        { "children": [1] },
        { "camera": 0 }
    ]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["scenes"] = json!([{ "nodes": [2] }]);
    file.json["animations"][0]["channels"] = json!([
        { "sampler": 0, "target": { "node": 0, "path": "translation" } },
        { "sampler": 0, "target": { "node": 2, "path": "translation" } },
    ]);
    let loaded = load(&file).expect("a sound file");
    let animation = &loaded.description.animation;
    assert_eq!(animation.joints.len(), 2);
    assert_eq!(animation.joints[1].parent, Some(0));
    let up = DVec3::new(0.0, 0.0, 7.0);
    assert_eq!(
        animation.joints[1].to_parent,
        DAffine3::from_translation(up)
    );
    let mut loads: Vec<_> = animation
        .carried
        .iter()
        .map(|c| (c.load, c.joint))
        .collect();
    loads.sort_by_key(|(load, _)| format!("{load:?}"));
    let expected = [Load::Camera(0), Load::Instance(0), Load::Light(0)];
    assert_eq!(loads, expected.map(|load| (load, 1)));
    let scene = Scene::new(&loaded.description, &SceneOptions::default()).expect("a scene");
    let at = scene.at(1.0);
    assert_eq!(at.camera().position(), DVec3::new(4.0, 0.0, 7.0));
    assert_eq!(at.punctual_position(0), Some(DVec3::new(4.0, 0.0, 7.0)));
    assert_eq!(scene.at(0.0).camera().position(), up);
}

/// Without a shutter nobody sees motion: nothing of it is read, whatever it is, and the file says what it shows.
#[test]
fn without_a_shutter_all_is_at_rest() {
    let mut file = file();
    file.json["cameras"][0]["extras"] = json!({});
    file.json["animations"][0]["samplers"][0]["input"] = json!(99);
    let loaded = load(&file).expect("a sound file");
    assert!(loaded.description.animation.is_empty());
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].message.contains("shutter"));
}

/// What becomes of a file in which one value is replaced: so many warnings, or a code and a place.
type Fate = Result<usize, (ErrorKind, &'static str)>;

#[test]
fn broken_animations_meet_their_fate() {
    use ErrorKind::{NotFinite, Reference};
    let sampler = "/animations/0/samplers/0";
    let input = "/animations/0/samplers/0/input";
    let output = "/animations/0/samplers/0/output";
    let path = "/animations/0/channels/0/target/path";
    let value = ErrorKind::Value;
    let two = |a, b| json!({ "input": a, "output": b });
    let spline = json!({ "input": 2, "output": 3, "interpolation": "CUBICSPLINE" });
    let cases: [(&str, Value, Fate); 22] = [
        ("/accessors/2/count", json!(0), Err((value, input))),
        ("/accessors/2/count", json!(1), Err((value, output))),
        (
            "/accessors/2/count",
            json!(1_u64 << 31),
            Err((value, output)),
        ),
        ("/accessors/2/count", json!(u64::MAX), Err((value, output))),
        (
            "/accessors/3/count",
            json!(1_u64 << 62),
            Err((value, output)),
        ),
        (
            "/accessors/2/type",
            json!("VEC2"),
            Err((value, "/accessors/2")),
        ),
        (
            "/accessors/3/type",
            json!("VEC2"),
            Err((value, "/accessors/3")),
        ),
        (
            "/accessors/2/componentType",
            json!(5123),
            Err((value, "/accessors/2")),
        ),
        (sampler, spline, Err((value, output))),
        (
            sampler,
            json!({ "input": 2, "output": 3, "interpolation": "ROUND" }),
            Err((value, "/animations/0/samplers/0/interpolation")),
        ),
        (sampler, json!({ "output": 3 }), Err((value, sampler))),
        (sampler, json!({ "input": 2 }), Err((value, sampler))),
        (sampler, two(9, 3), Err((Reference, input))),
        (sampler, two(2, 9), Err((Reference, output))),
        (path, json!("weights"), Ok(1)),
        (path, json!("pointer"), Ok(1)),
        (path, json!("colour"), Err((value, path))),
        (
            "/animations/0/channels/0/target/node",
            json!(3),
            Err((Reference, "/animations/0/channels/0/target/node")),
        ),
        (
            "/animations/0/channels/0/sampler",
            json!(1),
            Err((Reference, "/animations/0/channels/0/sampler")),
        ),
        (
            "/animations/0/channels/0/target",
            json!({ "path": "scale" }),
            Ok(1),
        ),
        (
            "/animations/0/channels",
            json!(7),
            Err((value, "/animations/0/channels")),
        ),
        (
            "/nodes/1",
            json!({ "children": [0], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }),
            Ok(1),
        ),
    ];
    for (pointer, replaced, expected) in cases {
        let mut file = file();
        *file.json.pointer_mut(pointer).expect("a value") = replaced.clone();
        let result = load(&file);
        let found = match &result {
            Ok(loaded) => Ok(loaded.warnings.len()),
            Err(error) => Err((error.kind(), error.place().to_owned())),
        };
        let expected = expected.map_err(|(kind, place)| (kind, place.to_owned()));
        let message = result.err().map(|error| error.to_string());
        assert_eq!(found, expected, "{pointer} = {replaced}: {message:?}");
    }
    // Numbers in the buffer.
    for (times, values, expected) in [
        ([0.0, f32::NAN], [0.0; 6], (NotFinite, input)),
        ([f32::NEG_INFINITY, 0.0], [0.0; 6], (NotFinite, input)),
        ([1.0, 1.0], [0.0; 6], (value, input)),
        ([2.0, 1.0], [0.0; 6], (value, input)),
        (
            [0.0, 1.0],
            [0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0],
            (NotFinite, output),
        ),
        (
            [0.0, 1.0],
            [0.0, 0.0, f32::INFINITY, 0.0, 0.0, 0.0],
            (NotFinite, output),
        ),
    ] {
        let mut file = file();
        let input = file.accessor("SCALAR", 5126, 2, &floats(&times));
        let output = file.accessor("VEC3", 5126, 2, &floats(&values));
        file.json["animations"][0]["samplers"][0] = two(input, output);
        let error = load(&file).expect_err("a refusal");
        assert_eq!(
            (error.kind(), error.place()),
            expected,
            "{times:?} {values:?}"
        );
    }
}

/// Scale that goes through nothing, values that leave single precision once they meet: a scene or an error, no panic.
#[test]
fn extremes_end_in_a_scene_or_an_error() {
    for values in [
        [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0],
        [1e38, 1e38, 1e38, -1e38, 1.0, 1e-38],
        [3e38; 6],
    ] {
        let mut file = file();
        let scales = file.accessor("VEC3", 5126, 2, &floats(&values));
        file.json["animations"][0]["samplers"][0] = json!({ "input": 2, "output": scales });
        file.json["animations"][0]["channels"][0]["target"]["path"] = json!("scale");
        let loaded = load(&file).expect("a sound file");
        let scene = Scene::new(&loaded.description, &SceneOptions::default());
        let Ok(scene) = scene else { continue };
        for time in [0.0, 0.25, 0.5, 1.0] {
            let ray = kaustik_geometry::Ray::new(glam::Vec3::splat(0.1), glam::Vec3::Z);
            let hit = scene.at(time).world().intersect(&ray);
            assert!(hit.is_none_or(|hit| hit.t.is_finite()), "{values:?} {time}");
        }
    }
    // Flat at rest and grown by its animation: the triangle is there, and at rest it is not.
    let mut file = file();
    file.json["nodes"][1]["scale"] = json!([0, 0, 0]);
    let scales = file.accessor("VEC3", 5126, 2, &floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    file.json["animations"][0]["samplers"][0] = json!({ "input": 2, "output": scales });
    file.json["animations"][0]["channels"][0]["target"]["path"] = json!("scale");
    let loaded = load(&file).expect("a sound file");
    let scene = Scene::new(&loaded.description, &SceneOptions::default()).expect("a scene");
    let ray = kaustik_geometry::Ray::new(glam::Vec3::new(0.2, 5.2, -1.0), glam::Vec3::Z);
    assert!(scene.at(1.0).world().intersect(&ray).is_some());
    assert!(scene.at(0.0).world().intersect(&ray).is_none());
}

/// A chain of moving nodes that is too long is refused where it becomes so.
#[test]
fn moving_nodes_below_too_many_others() {
    let mut file = file();
    let mut nodes = vec![json!({ "mesh": 0 })];
    let mut channels = Vec::new();
    for index in 1..400 {
        nodes.push(json!({ "children": [index - 1] }));
        channels.push(json!({ "sampler": 0, "target": { "node": index, "path": "translation" } }));
    }
    nodes.push(json!({ "camera": 0 }));
    file.json["scenes"] = json!([{ "nodes": [399, 400] }]);
    file.json["nodes"] = nodes.into();
    file.json["animations"][0]["channels"] = channels.into();
    let error = load(&file).expect_err("a refusal");
    assert_eq!(error.kind(), ErrorKind::Hierarchy);
    assert_eq!(error.place(), "/nodes/142");
}

/// A scene of every kind of motion: joints below joints with still nodes in between, before and after what
/// stands still; the first camera carried, the second not; splines, steps and lines; all three kinds of
/// values.
fn busy() -> File {
    let mut file = file();
    let moving = [0.0, 0.0, 0.0, 0.6, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    file.accessor("VEC4", 5126, 3, &floats(&moving)); // 4
    let spline: Vec<f32> = (0..18).map(|i| i as f32 * 0.1).collect();
    file.accessor("VEC3", 5126, 6, &floats(&spline)); // 5
    file.accessor("SCALAR", 5126, 3, &floats(&[-1.0, 0.5, 4.0])); // 6
    file.accessor("VEC4", 5126, 3, &floats(&moving)); // 7
    file.json["nodes"] = json!([
        { "mesh": 0, "name": "still" },
        { "children": [2, 3], "name": "still above", "rotation": [0.6, 0, 0, 0.8], "translation": [1, 2, 3] },
        { "children": [4, 5], "name": "outer", "scale": [1, 2, 1] },
        { "mesh": 0, "name": "still below", "translation": [0.1, 0.2, 0.3] },
        { "camera": 0, "name": "carried camera", "translation": [0, 0, 0.7] },
        { "children": [6, 7, 10], "name": "between", "rotation": [0, 0.1, 0, 0.9] },
        { "mesh": 0, "name": "carried" },
        { "children": [8], "name": "inner" },
        { "mesh": 0, "name": "innermost", "translation": [3, 0, 0] },
        { "mesh": 0, "camera": 1, "name": "last" },
        { "mesh": 0, "name": "carried after" }
    ]);
    file.json["scenes"] = json!([{ "nodes": [0, 1, 9] }]);
    let camera = file.json["cameras"][0].clone();
    file.json["cameras"] = json!([camera, camera]);
    file.json["animations"] = json!([{
        "channels": [
            { "sampler": 0, "target": { "node": 2, "path": "translation" } },
            { "sampler": 1, "target": { "node": 7, "path": "rotation" } },
            { "sampler": 2, "target": { "node": 7, "path": "scale" } }
        ],
        "samplers": [
            { "input": 2, "output": 3, "interpolation": "STEP" },
            { "input": 6, "output": 7 },
            { "input": 2, "output": 5, "interpolation": "CUBICSPLINE" }
        ]
    }]);
    file
}

/// Two joints of the world: the first carries no mesh, so that nothing but the second tells where the still
/// one belongs.
fn apart() -> File {
    let mut file = file();
    file.json["nodes"] = json!([
        { "children": [1], "name": "camera's" },
        { "camera": 0 },
        { "mesh": 0, "name": "moves" },
        { "mesh": 0, "name": "still" }
    ]);
    file.json["scenes"] = json!([{ "nodes": [0, 2, 3] }]);
    let target =
        |node: usize| json!({ "sampler": 0, "target": { "node": node, "path": "translation" } });
    file.json["animations"][0]["channels"] = json!([target(0), target(2)]);
    file
}

#[test]
fn what_moves_comes_back() {
    for file in [file(), busy(), apart()] {
        let loaded = load(&file).expect("a sound file");
        let d = loaded.description;
        assert!(!d.animation.is_empty());
        let bytes = crate::gltf::export_bytes(&d).unwrap_or_else(|e| panic!("{e}"));
        let again = crate::gltf::load_bytes(&bytes, "again", &LoadOptions::default());
        let again = again.expect("an exported file").description;
        // Of single precision now, and so to the bit.
        let once_more = crate::gltf::export_bytes(&again).expect("an export");
        assert_eq!(once_more, bytes);
        let names = |d: &crate::Description| {
            let instances = d.instances.iter().map(|i| i.name.clone());
            let joints = d.animation.joints.iter().map(|j| j.name.clone());
            instances.chain(joints).collect::<Vec<_>>()
        };
        assert_eq!(names(&again), names(&d));
        let scenes =
            [&d, &again].map(|d| Scene::new(d, &SceneOptions::default()).expect("a scene"));
        for time in [0.0, 0.3, 0.99] {
            for instance in 0..d.instances.len() {
                let corners = |scene: &Scene| scene.at(time).world().triangle(instance as u32, 0);
                let [a, b] = [corners(&scenes[0]), corners(&scenes[1])];
                for (a, b) in a.into_iter().zip(b) {
                    assert!(a.distance(b) < 1e-5 * (1.0 + a.length()), "{time} {a} {b}");
                }
            }
        }
    }
}

/// A description that no file has: what a joint carries is missing, or stands in another order than any tree has.
#[test]
fn what_cannot_come_back_is_refused() {
    let sound = load(&busy()).expect("a sound file").description;
    let mut missing = sound.clone();
    missing.animation.carried[0].load = Load::Instance(99);
    let mut tangled = sound.clone();
    for carried in &mut tangled.animation.carried {
        if carried.load == Load::Instance(1) {
            carried.load = Load::Instance(4);
        }
    }
    for wrong in [missing, tangled] {
        assert!(crate::gltf::export_bytes(&wrong).is_err());
    }
}
