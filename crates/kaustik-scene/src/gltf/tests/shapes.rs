//! Morph targets and skins at rest.

use glam::{Affine3A, Vec3};
use serde_json::json;

use super::file::{File, floats, shorts};

const UP: [f32; 9] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];

/// Column by column: a scale and a translation.
fn matrix(scale: f32, [x, y, z]: [f32; 3]) -> [f32; 16] {
    let mut all = [0.0; 16];
    (all[0], all[5], all[10], all[15]) = (scale, scale, scale, 1.0);
    (all[12], all[13], all[14]) = (x, y, z);
    all
}

/// A triangle with normals along z and a skin of as many joints as there are matrices. The joints are nodes 1 and up,
/// which stand as they are told; `pulls` are joints and weights at each corner.
fn skinned(
    joints: &[serde_json::Value],
    inverse_binds: &[[f32; 16]],
    pulls: [([u16; 4], [f32; 4]); 3],
) -> File {
    let mut file = File::triangle();
    file.attribute("NORMAL", "VEC3", 5126, &floats(&UP));
    let by = pulls.map(|(joints, _)| joints).concat();
    let much = pulls.map(|(_, weights)| weights).concat();
    let by = file.accessor("VEC4", 5123, 3, &shorts(&by));
    file.primitive()["attributes"]["JOINTS_0"] = json!(by);
    file.attribute("WEIGHTS_0", "VEC4", 5126, &floats(&much));
    let places: Vec<usize> = joints
        .iter()
        .map(|joint| file.push("nodes", joint.clone()))
        .collect();
    let nodes: Vec<usize> = (0..=joints.len()).collect();
    file.json["scenes"][0]["nodes"] = json!(nodes);
    let matrices = floats(&inverse_binds.concat());
    let accessor = file.accessor("MAT4", 5126, inverse_binds.len(), &matrices);
    file.json["skins"] = json!([{ "joints": places, "inverseBindMatrices": accessor }]);
    file.json["nodes"][0]["skin"] = json!(0);
    file
}

/// A file with a mesh that a morph target moves and two joints bend.
pub(super) fn bent() -> File {
    let joints = [json!({}), json!({ "translation": [1, 3, 0] })];
    let pulls = [([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]); 3];
    let mut file = skinned(&joints, &[matrix(1.0, [0.0; 3]); 2], pulls);
    let lift = file.accessor("VEC3", 5126, 3, &floats(&[0.5; 9]));
    file.primitive()["targets"] = json!([{ "POSITION": lift, "NORMAL": lift, "TANGENT": lift }]);
    file.json["meshes"][0]["weights"] = json!([0.5]);
    file.push("nodes", json!({ "mesh": 0, "weights": [2.0] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    file
}

fn near(found: Vec3, expected: [f32; 3]) -> bool {
    (found - Vec3::from(expected)).length() < 1e-5
}

/// The transform of the mesh's own node is nothing, that of the first joint and the way from there all: scale 100, then a hundredth.
#[test]
fn a_skin_at_rest_stands_as_its_first_joint_holds_it() {
    let joint = json!({ "scale": [100, 100, 100], "translation": [0, 5, 0] });
    let inverse = matrix(0.01, [0.0; 3]);
    let pulls = [([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]); 3];
    let mut file = skinned(&[joint.clone(), joint], &[inverse, inverse], pulls);
    file.json["nodes"][0]["scale"] = json!([7, 7, 7]);
    let description = file.clean();
    assert_eq!(description.meshes.len(), 1);
    assert_eq!(description.meshes[0].positions[1], Vec3::X);
    let transform = description.instances[0].transform;
    let expected = Affine3A::from_translation(Vec3::new(0.0, 5.0, 0.0));
    assert!(transform.abs_diff_eq(expected, 1e-6), "{transform:?}");
}

/// Corners go where joints take them, in the mean by their weights, and normals turn with them.
#[test]
fn joints_that_do_not_rest_bend_the_mesh() {
    // The second joint was bound at (1, 0, 0) and stands there, turned by 90 degrees about y.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let joints = [
        json!({ "translation": [0, 3, 0] }),
        json!({ "translation": [1, 3, 0], "rotation": [0, half, 0, half] }),
    ];
    let binds = [matrix(1.0, [0.0; 3]), matrix(1.0, [-1.0, 0.0, 0.0])];
    let pulls = [
        ([1, 9, 0, 0], [2.0, 0.0, 0.0, 0.0]), // what does not pull may be no joint
        ([0, 0, 0, 0], [0.0; 4]),
        ([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]),
    ];
    let mut file = skinned(&joints, &binds, pulls);
    // Another node with the same skin, and one without: two shapes of the mesh.
    file.push("nodes", json!({ "mesh": 0, "skin": 0 }));
    file.push("nodes", json!({ "mesh": 0 }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    let description = file.clean();
    let meshes: Vec<usize> = description.instances.iter().map(|i| i.mesh).collect();
    assert_eq!((meshes, description.meshes.len()), (vec![0, 0, 1], 2));
    let bent = &description.meshes[0];
    // (0, 0, 0) is -x of the second joint: it goes to +z of where that stands.
    assert!(
        near(bent.positions[0], [1.0, 0.0, 1.0]),
        "{:?}",
        bent.positions
    );
    assert!(
        near(bent.positions[1], [1.0, 0.0, 0.0]),
        "{:?}",
        bent.positions
    );
    assert!(
        near(bent.positions[2], [0.5, 1.0, 0.5]),
        "{:?}",
        bent.positions
    );
    assert!(near(bent.normals[0], [1.0, 0.0, 0.0]), "{:?}", bent.normals);
    assert!(near(bent.normals[1], [0.0, 0.0, 1.0]), "{:?}", bent.normals);
    assert!(
        near(bent.normals[2], [half, 0.0, half]),
        "{:?}",
        bent.normals
    );
    let expected = Affine3A::from_translation(Vec3::new(0.0, 3.0, 0.0));
    assert!(
        description.instances[0]
            .transform
            .abs_diff_eq(expected, 1e-6)
    );
    assert_eq!(description.meshes[1].positions[1], Vec3::X);
}

/// What no joint pulls at, exporters leave to the first joint: all of it, its turn and its scale as well.
#[test]
fn what_nothing_pulls_at_follows_the_first_joint() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let joints = [
        // x becomes twice y
        json!({ "translation": [0, 3, 0], "rotation": [0, 0, half, half], "scale": [2, 2, 2] }),
        json!({ "translation": [7, 0, 0] }),
    ];
    let pulls = [
        ([1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
        ([0; 4], [0.0; 4]),
        ([1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
    ];
    let bind = matrix(1.0, [0.0; 3]);
    let description = skinned(&joints, &[bind, bind], pulls).clean();
    let transform = description.instances[0].transform;
    let [a, b] =
        [0, 1].map(|corner| transform.transform_point3(description.meshes[0].positions[corner]));
    assert!(near(a, [7.0, 0.0, 0.0]), "{a}");
    assert!(near(b, [0.0, 5.0, 0.0]), "{b}");
}

/// A first joint that flattens or mirrors what it holds does so to nothing else: here all hangs on the second.
#[test]
fn a_first_joint_spoils_nothing_that_hangs_on_others() {
    let pulls = [([1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]); 3];
    let bind = matrix(1.0, [0.0; 3]);
    for first in [
        json!([0, 0, 0]),
        json!([1, 1, 0]),
        json!([-1, 1, 1]),
        json!([1e-12, 1, 1]),
    ] {
        let joints = [
            json!({ "scale": first, "translation": [5, 0, 0] }),
            json!({ "translation": [0, 2, 0] }),
        ];
        let description = skinned(&joints, &[bind, bind], pulls).clean();
        let transform = description.instances[0].transform;
        let [a, b, c] = [0, 1, 2]
            .map(|corner| transform.transform_point3(description.meshes[0].positions[corner]));
        assert!(near(a, [0.0, 2.0, 0.0]) && near(b, [1.0, 2.0, 0.0]) && near(c, [0.0, 3.0, 0.0]));
        assert!(transform.matrix3.determinant() > 0.0);
    }
    // Where most joints mirror, the mesh stands mirrored, and what bends it is sound.
    let joints = [
        json!({ "scale": [-1, 1, 1] }),
        json!({ "scale": [-1, 1, 1], "translation": [0, 2, 0] }),
    ];
    let description = skinned(&joints, &[bind, bind], pulls).clean();
    let transform = description.instances[0].transform;
    assert!(transform.matrix3.determinant() < 0.0);
    let corner = transform.transform_point3(description.meshes[0].positions[1]);
    assert!(near(corner, [-1.0, 2.0, 0.0]), "{corner}");
}

/// Joints that are told a single-precision error apart rest; what is a millionth of a unit large may be bent as well.
#[test]
fn rest_is_told_by_what_is_seen() {
    let pulls = [([1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]); 3];
    let far = [300.0, 40.0, -7.0];
    let binds = [matrix(1.0, [0.0; 3]), matrix(1.0, far.map(|x: f32| -x))];
    let close = json!({ "translation": [300.0001, 40, -7] });
    let description = skinned(&[json!({}), close], &binds, pulls).clean();
    assert_eq!(description.meshes[0].positions[1], Vec3::X);
    let grown = [
        json!({ "scale": [1e6, 1e6, 1e6] }),
        json!({ "scale": [1e6, 1e6, 1e6], "translation": [0, 0.5, 0] }),
    ];
    let binds = [matrix(1.0, [0.0; 3]); 2];
    let description = skinned(&grown, &binds, pulls).clean();
    let corner = description.meshes[0].positions[0];
    let corner = description.instances[0].transform.transform_point3(corner);
    assert!(near(corner, [0.0, 0.5, 0.0]), "{corner}");
}

/// Tens of thousands of targets that all name one long accessor without data: refused before the work is done.
#[test]
fn the_same_data_again_and_again_is_refused() {
    let mut file = File::triangle();
    file.json["accessors"][0] =
        json!({ "type": "VEC3", "componentType": 5126, "count": 4_000_000 });
    file.primitive()["targets"] = json!(vec![json!({ "POSITION": 0 }); 20_000]);
    file.json["meshes"][0]["weights"] = json!(vec![1; 20_000]);
    file.refused(&["/meshes/0/primitives/0/targets/", "for files of this size"]);
}

#[test]
fn broken_skins_are_refused() {
    let pulls = [([0, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]); 3];
    let joints = [json!({}), json!({ "translation": [1, 0, 0] })];
    let bind = matrix(1.0, [0.0; 3]);
    let sound = skinned(&joints, &[bind, bind], pulls);
    sound.clean();
    let refused = |change: fn(&mut File), words: &[&str]| {
        let mut file = sound.clone();
        change(&mut file);
        file.refused(words);
    };
    refused(
        |f| f.json["nodes"][0]["skin"] = json!(3),
        &["/nodes/0/skin", "an index into /skins"],
    );
    refused(
        |f| f.json["skins"][0]["joints"] = json!([]),
        &["/skins/0/joints", "at least one joint"],
    );
    refused(
        |f| f.json["skins"][0]["joints"] = json!([9]),
        &["/skins/0/joints/0", "an index into /nodes"],
    );
    refused(
        |f| f.json["skins"][0]["joints"] = json!([1, 2, 1]),
        &["/skins/0/inverseBind", "one for each of the 3 joints"],
    );
    refused(
        |f| {
            let at = f.primitive()["attributes"]["JOINTS_0"]
                .as_u64()
                .expect("an index");
            f.json["accessors"][at as usize]["normalized"] = json!(true);
        },
        &["/accessors/", "not normalized"],
    );
    let stray = [([2, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]); 3];
    skinned(&joints, &[bind, bind], stray).refused(&["JOINTS_0", "joints below 2"]);
}

/// Targets by the weights of the node, else by those of the mesh; no more than there are, and none that weighs nothing.
#[test]
fn morph_targets_move_what_they_are_told_to() {
    let mut file = File::triangle();
    file.attribute("NORMAL", "VEC3", 5126, &floats(&UP));
    let lift = file.accessor(
        "VEC3",
        5126,
        3,
        &floats(&[0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0]),
    );
    let lean = file.accessor(
        "VEC3",
        5126,
        3,
        &floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    );
    file.primitive()["targets"] =
        json!([{ "POSITION": lift, "NORMAL": lean }, { "POSITION": lean }]);
    // Without weights the mesh is as it is.
    assert_eq!(file.clean().meshes[0].positions[1], Vec3::X);
    file.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    file.push("nodes", json!({ "mesh": 0, "weights": [1.0, -3.0, 8.0] }));
    file.push("nodes", json!({ "mesh": 0, "weights": [0.0] }));
    file.push("nodes", json!({ "mesh": 0 }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let description = file.clean();
    let meshes: Vec<usize> = description.instances.iter().map(|i| i.mesh).collect();
    assert_eq!(meshes, [0, 1, 2, 0]);
    let at = |mesh: usize| &description.meshes[mesh];
    assert!(near(at(0).positions[0], [0.0, 0.0, 1.0]) && near(at(0).positions[1], [1.0, 0.0, 2.0]));
    let leaning = Vec3::new(0.5, 0.0, 1.0).normalize();
    assert!(near(at(0).normals[0], leaning.to_array()) && near(at(0).normals[1], [0.0, 0.0, 1.0]));
    assert!(
        near(at(1).positions[0], [-3.0, 0.0, 2.0]) && near(at(1).positions[1], [1.0, 0.0, 4.0])
    );
    assert_eq!(at(2).positions[1], Vec3::X);
    file.json["nodes"][1]["weights"] = json!(["much"]);
    file.refused(&["/nodes/1/weights/0", "a number"]);
}
