//! Thousands of spoiled files: each gives a sound scene or an error, soon.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::any;
use super::file::{File, floats, glb, jpeg, shorts};
use super::shapes;
use crate::Description;
use crate::gltf::{LoadOptions, export_bytes, load_bytes};
use crate::testing::Rng;

/// A file to spoil: its JSON and its binary chunk.
type Model = (Value, Vec<u8>);

/// What a campaign saw.
#[derive(Debug, Default)]
struct Tally {
    loaded: u32,
    refused: u32,
    slowest: Duration,
}

fn below(rng: &mut Rng, most: usize) -> usize {
    (rng.uniform() * most as f64) as usize
}

fn pick<T: Clone>(rng: &mut Rng, of: &[T]) -> T {
    of[below(rng, of.len())].clone()
}

/// Files that between them use all that the loader reads.
fn models() -> Vec<Model> {
    let mut models: Vec<Model> = (0..6)
        .filter_map(|seed| split(&export_bytes(&any::description(seed)).ok()?))
        .collect();
    let mut odd = File::triangle();
    let indices = odd.view(&[2]);
    let values = odd.view(&floats(&[0.0, 2.0, 0.0]));
    odd.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    odd.attribute("COLOR_0", "VEC3", 5121, &[128; 9]);
    odd.attribute("TEXCOORD_0", "VEC2", 5123, &shorts(&[7; 6]));
    odd.attribute("NORMAL", "VEC3", 5120, &[127; 9]);
    odd.json["extensionsUsed"] = json!(["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"]);
    let t = odd.accessor("VEC3", 5126, 2, &floats(&[1.0; 6]));
    let r = odd.accessor(
        "VEC4",
        5126,
        2,
        &floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
    );
    odd.json["nodes"] = json!([
        { "mesh": 0, "children": [1], "scale": [1, -1, 1] },
        { "mesh": 0, "rotation": [0, 1, 0, 0], "translation": [1, 2, 3], "children": [2],
          "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": t, "ROTATION": r } } } },
        { "name": "leaf", "mesh": 1 },
    ]);
    let strip = json!({ "attributes": { "POSITION": 0 }, "mode": 5, "material": 0 });
    odd.push("meshes", json!({ "primitives": [strip] }));
    let view = odd.view(&jpeg(8, 8));
    odd.json["images"] =
        json!([{ "bufferView": view }, { "uri": "data:image/png;base64,iVBORw0KGgo=" }]);
    odd.json["images"].as_array_mut().unwrap().pop();
    odd.json["textures"] = json!([{ "source": 0 }]);
    odd.json["materials"] = json!([{ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "diffuseTexture": { "index": 0 }, "glossinessFactor": 0.5 } } }]);
    odd.json["buffers"] = json!([{ "byteLength": odd.binary.len() }]);
    models.push((odd.json, odd.binary));
    let mut bent = shapes::bent();
    bent.json["buffers"] = json!([{ "byteLength": bent.binary.len() }]);
    models.push((bent.json, bent.binary));
    models
}

fn split(glb: &[u8]) -> Option<Model> {
    let length = u32::from_le_bytes(glb.get(12..16)?.try_into().ok()?) as usize;
    let json = serde_json::from_slice(glb.get(20..20 + length)?).ok()?;
    let binary = glb.get(28 + length..).unwrap_or_default().to_vec();
    Some((json, binary))
}

/// One spoiled copy.
fn spoil(rng: &mut Rng, (json, binary): &Model) -> Vec<u8> {
    let (mut json, mut binary) = (json.clone(), binary.clone());
    let times = 1 + below(rng, 4);
    match below(rng, 8) {
        0 => return spoil_bytes(rng, glb(json.to_string().as_bytes(), &binary), times),
        1 => {
            let whole = glb(json.to_string().as_bytes(), &binary);
            return whole[..below(rng, whole.len())].to_vec();
        }
        2 => return spoil_lengths(rng, glb(json.to_string().as_bytes(), &binary)),
        3 => {
            let text = spoil_bytes(rng, json.to_string().into_bytes(), times);
            return glb(&text, &binary);
        }
        4 => (0..times).for_each(|_| spoil_float(rng, &mut binary)),
        5 => binary = spoil_bytes(rng, binary, times),
        _ => (0..times).for_each(|_| spoil_value(rng, &mut json)),
    }
    glb(json.to_string().as_bytes(), &binary)
}

fn spoil_bytes(rng: &mut Rng, mut bytes: Vec<u8>, times: usize) -> Vec<u8> {
    for _ in 0..times {
        let at = below(rng, bytes.len().max(1));
        match (below(rng, 4), bytes.get_mut(at)) {
            (0, Some(byte)) => *byte ^= 1 << below(rng, 8),
            (1, Some(byte)) => *byte = below(rng, 256) as u8,
            (2, Some(byte)) => *byte = pick(rng, b"0123456789-\"[]{},:.eE"),
            (_, Some(_)) => drop(bytes.remove(at)),
            (_, None) => bytes.push(0),
        }
    }
    bytes
}

/// One of the words that say how long something is.
fn spoil_lengths(rng: &mut Rng, mut glb: Vec<u8>) -> Vec<u8> {
    let json = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let at = pick(rng, &[4, 8, 12, 16, 20 + json, 24 + json]);
    if let Some(word) = glb.get_mut(at..at + 4) {
        let old = u32::from_le_bytes(word.try_into().unwrap());
        let new = pick(
            rng,
            &[
                0,
                1,
                3,
                4,
                12,
                old.wrapping_add(4),
                old.wrapping_sub(4),
                !0,
                1 << 31,
                !0 - 7,
            ],
        );
        word.copy_from_slice(&new.to_le_bytes());
    }
    glb
}

fn spoil_float(rng: &mut Rng, binary: &mut [u8]) {
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        0.0,
        -0.0,
        1e-45,
        1e30,
    ];
    let words = binary.len() / 4;
    if words > 0 {
        let at = 4 * below(rng, words);
        let value = pick(rng, &odd);
        binary[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
}

/// A value somewhere in the tree is replaced, removed or repeated.
fn spoil_value(rng: &mut Rng, root: &mut Value) {
    let mut at = root;
    loop {
        let deeper = rng.uniform() < 0.9;
        let children = match at {
            Value::Array(items) => items.len(),
            Value::Object(members) => members.len(),
            _ => 0,
        };
        if children == 0 || !deeper {
            break;
        }
        let index = below(rng, children);
        at = match at {
            Value::Array(items) => &mut items[index],
            Value::Object(members) => members.values_mut().nth(index).unwrap(),
            _ => unreachable!(),
        };
    }
    let changed = match (below(rng, 4), &mut *at) {
        (0, Value::Array(items)) if !items.is_empty() => {
            let index = below(rng, items.len());
            let item = items[index].clone();
            items.push(item);
            true
        }
        (1, Value::Array(items)) if !items.is_empty() => {
            items.remove(below(rng, items.len()));
            true
        }
        (0 | 1, Value::Object(members)) if !members.is_empty() => {
            let key = members
                .keys()
                .nth(below(rng, members.len()))
                .unwrap()
                .clone();
            members.remove(&key);
            true
        }
        _ => false,
    };
    if !changed {
        *at = odd_value(rng);
    }
}

fn odd_value(rng: &mut Rng) -> Value {
    let odd = [
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(-1),
        json!(5120),
        json!(5121),
        json!(5123),
        json!(5125),
        json!(5126),
        json!(4),
        json!(5),
        json!(6),
        json!(255),
        json!(65535),
        json!(i32::MAX),
        json!(u32::MAX),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(1_000_000),
        json!(100_000_000),
        json!(0.5),
        json!(-0.0),
        json!(1e-300),
        json!(1e300),
        json!(3.5e38),
        json!(null),
        json!(true),
        json!(false),
        json!(""),
        json!("VEC2"),
        json!("VEC4"),
        json!("SCALAR"),
        json!("MAT4"),
        json!("spot"),
        json!("../x"),
        json!("/dev/zero"),
        json!("data:,"),
        json!("data:;base64,AAAA"),
        json!([]),
        json!({}),
        json!([0]),
        json!([0, 0]),
        json!([1e38, 1e38, 1e38]),
        json!({ "kaustik": {} }),
        json!([[400, 1]]),
    ];
    pick(rng, &odd)
}

/// All that the rest of the renderer relies on.
fn assert_sound(d: &Description) {
    for mesh in &d.meshes {
        mesh.check().unwrap();
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
        assert!(mesh.tangents.iter().all(|t| t.is_finite()));
    }
    for instance in &d.instances {
        assert!(instance.mesh < d.meshes.len());
        assert!(instance.material.is_none_or(|m| m < d.materials.len()));
        assert!(instance.transform.is_finite());
    }
    for texture in &d.textures {
        assert!(texture.image < d.images.len());
    }
    for m in &d.materials {
        let slots = [
            m.base_color_texture,
            m.metallic_roughness_texture,
            m.normal_texture,
            m.emissive_texture,
            m.specular.texture,
            m.specular.color_texture,
        ];
        assert!(
            slots
                .iter()
                .flatten()
                .all(|s| s.texture < d.textures.len() && s.uv_set < 2)
        );
        assert!(m.base_color.iter().all(|c| (0.0..=1.0).contains(c)));
        assert!(m.emissive.iter().all(|e| e.is_finite() && *e >= 0.0));
    }
}

fn campaign(seed: u64, count: u32) -> Tally {
    let rng = &mut Rng::new(seed);
    let models = models();
    let mut tally = Tally::default();
    for i in 0..count {
        let bytes = spoil(rng, &models[i as usize % models.len()]);
        let start = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| {
            load_bytes(&bytes, "spoiled", &LoadOptions::default())
        }));
        let time = start.elapsed();
        tally.slowest = tally.slowest.max(time);
        assert!(
            time < Duration::from_secs(1),
            "file {i} of seed {seed} took {time:?}"
        );
        match result.unwrap_or_else(|_| panic!("file {i} of seed {seed} panicked")) {
            Ok(loaded) => {
                assert_sound(&loaded.description);
                // the exporter may refuse it, in words
                let _ = export_bytes(&loaded.description);
                tally.loaded += 1;
            }
            Err(e) => {
                assert!(!e.found().is_empty() && !e.expected().is_empty());
                tally.refused += 1;
            }
        }
    }
    println!("seed {seed}: {tally:?}");
    tally
}

#[test]
fn two_thousand_spoiled_files() {
    let tally = campaign(1, 2000);
    // both ends of the loader must have been met
    assert!(tally.loaded > 200 && tally.refused > 200, "{tally:?}");
}

#[test]
#[ignore = "long"]
fn twenty_thousand_spoiled_files() {
    for seed in 2..12 {
        campaign(seed, 2000);
    }
}
