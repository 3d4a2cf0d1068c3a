//! Large files: the time to load goes with their size.
//!
//! Each is a long test, to be run alone: `cargo test --release -p kaustik-scene -- --ignored --exact NAME --nocapture`
//! prints seconds and the most memory that was resident.

use std::time::Instant;

use serde_json::json;

use super::file::{File, floats, png};
use crate::gltf::LoadOptions;
use crate::gltf::load_bytes;
use crate::{Scene, SceneOptions};

/// So many times as large.
const FACTOR: usize = 8;
/// What caches and allocators may add to that.
const SLACK: f64 = 2.0;

/// Resident memory in MiB: the most so far.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
    number.unwrap_or(0) / 1024
}

/// Seconds to a description, and to a scene.
fn timed(what: &str, count: usize, file: &File) -> [f64; 2] {
    let bytes = file.glb();
    let before = peak();
    let start = Instant::now();
    let options = LoadOptions {
        max_memory: Some(8 << 30),
        ..LoadOptions::default()
    };
    let loaded = load_bytes(&bytes, "large.glb", &options);
    let description = loaded.unwrap_or_else(|e| panic!("{e}")).description;
    let read = start.elapsed().as_secs_f64();
    let scene = Scene::new(&description, &SceneOptions::default());
    assert!(scene.is_ok());
    let all = start.elapsed().as_secs_f64();
    println!(
        "{count} {what}, {} MiB: read in {read:.2} s, a scene after {all:.2} s, {before} to {} MiB resident",
        bytes.len() >> 20,
        peak()
    );
    [read, all]
}

/// Loads a small and a large file.
fn grows(what: &str, count: usize, file: impl Fn(usize) -> File) {
    let small = timed(what, count / FACTOR, &file(count / FACTOR));
    let large = timed(what, count, &file(count));
    for (small, large) in small.iter().zip(large) {
        assert!(
            large < small * FACTOR as f64 * SLACK + 0.1,
            "{what}: {small} s, and {large} s for {FACTOR} times as many"
        );
    }
}

#[test]
#[ignore = "long"]
fn a_million_nodes_take_linear_time() {
    grows("nodes", 1_000_000, |count| {
        let mut file = File::triangle();
        let node = |i: usize| json!({ "mesh": 0, "translation": [i % 1000, i / 1000, 0] });
        file.json["nodes"] = (0..count).map(node).collect();
        file.json["scenes"][0]["nodes"] = (0..count).collect();
        file
    });
}

#[test]
#[ignore = "long"]
fn ten_million_triangles_take_linear_time() {
    grows("triangles", 10_000_000, |count| {
        let side = (count / 2).isqrt();
        let mut file = File::empty();
        let at = |i: usize| i as f32 / side as f32;
        let height = |i: usize, j: usize| ((i * i + 3 * j) % 97) as f32 * 1e-4;
        let points: Vec<f32> = (0..=side)
            .flat_map(|i| (0..=side).flat_map(move |j| [at(i), height(i, j), at(j)]))
            .collect();
        let corners: Vec<u8> = (0..side)
            .flat_map(|i| (0..side).map(move |j| i * (side + 1) + j))
            .flat_map(|a| [a, a + 1, a + side + 2, a, a + side + 2, a + side + 1])
            .flat_map(|corner| (corner as u32).to_le_bytes())
            .collect();
        file.accessor("VEC3", 5126, points.len() / 3, &floats(&points));
        file.accessor("SCALAR", 5125, corners.len() / 4, &corners);
        file.json["meshes"] = json!([{ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1 }
        ]}]);
        file.json["nodes"] = json!([{ "mesh": 0 }]);
        file.json["scenes"] = json!([{ "nodes": [0] }]);
        file.json["scene"] = json!(0);
        file
    });
}

#[test]
#[ignore = "long"]
fn a_thousand_textures_take_linear_time() {
    let picture = png(256, 256);
    grows("textures of 256 x 256", 1000, |count| {
        let mut file = File::triangle();
        file.attribute(
            "TEXCOORD_0",
            "VEC2",
            5126,
            &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        );
        let primitive = file.primitive().clone();
        let mut primitives = Vec::new();
        for i in 0..count {
            let view = file.view(&picture);
            file.push(
                "images",
                json!({ "bufferView": view, "mimeType": "image/png" }),
            );
            file.push("textures", json!({ "source": i }));
            file.push(
                "materials",
                json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": i } } }),
            );
            let mut own = primitive.clone();
            own["material"] = json!(i);
            primitives.push(own);
        }
        file.json["meshes"][0]["primitives"] = json!(primitives);
        file
    });
}

/// Each copy is placed without a look at every triangle.
#[test]
#[ignore = "long"]
fn many_copies_of_a_large_mesh_take_linear_time() {
    grows(
        "triangles, and an eighth as many copies",
        400_000,
        |count| {
            let mut file = File::triangle();
            file.push(
                "accessors",
                json!({ "componentType": 5126, "type": "VEC3", "count": 3 * count }),
            );
            let points = file.json["accessors"].as_array().map_or(0, Vec::len) - 1;
            file.json["meshes"][0]["primitives"] =
                json!([{ "attributes": { "POSITION": points } }]);
            let node = |i: usize| json!({ "mesh": 0, "translation": [i, 0, 0] });
            file.json["nodes"] = (0..count / 8).map(node).collect();
            file.json["scenes"][0]["nodes"] = (0..count / 8).collect();
            file
        },
    );
}
