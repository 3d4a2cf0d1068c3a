//! One table of files made to hurt, each with what must become of it.

use serde_json::{Value, json};

use super::file::{File, floats, jpeg, png, shorts};
use crate::gltf::{ErrorKind, LoadError, LoadOptions, Loaded, load_bytes};

/// What must become of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    /// It loads, with as many warnings.
    Loads(usize),
    /// It is refused with this code at this place.
    Refused(ErrorKind, &'static str),
    /// It is refused with this code; where a parser gives up is its own affair.
    RefusedSomewhere(ErrorKind),
}
use ErrorKind::{Budget, Hierarchy, Image, NotFinite, Reference, Syntax};
use Fate::{Loads, Refused, RefusedSomewhere};

fn fate(result: &Result<Loaded, LoadError>) -> (Option<ErrorKind>, String, usize) {
    match result {
        Ok(loaded) => (None, String::new(), loaded.warnings.len()),
        Err(error) => (Some(error.kind()), error.place().to_owned(), 0),
    }
}

fn judge(name: &str, result: &Result<Loaded, LoadError>, expected: Fate) {
    let wanted = match expected {
        Loads(warnings) => (None, String::new(), warnings),
        Refused(kind, place) => (Some(kind), place.to_owned(), 0),
        RefusedSomewhere(kind) => (Some(kind), fate(result).1, 0),
    };
    let message = result.as_ref().err().map(ToString::to_string);
    assert_eq!(fate(result), wanted, "{name}: {message:?}");
}

fn load(file: &File) -> Result<Loaded, LoadError> {
    file.load_with(&LoadOptions::default())
}

/// A triangle with one value of its document replaced.
fn with(pointer: &str, value: Value) -> File {
    let mut file = File::triangle();
    file.json["accessors"][0]["byteOffset"] = json!(0);
    file.json["bufferViews"][0]["byteOffset"] = json!(0);
    file.json["nodes"][0]["scale"] = json!([1, 1, 1]);
    file.json["nodes"][0]["rotation"] = json!([0, 0, 0, 1]);
    file.json["nodes"][0]["translation"] = json!([0, 0, 0]);
    *file.json.pointer_mut(pointer).unwrap() = value;
    file
}

#[test]
fn counts_and_offsets_meet_their_fate() {
    let count = "/accessors/0/count";
    for (pointer, value, expected) in [
        (
            count,
            json!(0),
            Refused(Reference, "/meshes/0/primitives/0/indices"),
        ),
        (count, json!(4), Refused(Reference, "/accessors/0")),
        (
            count,
            json!(1_u64 << 31),
            Refused(Reference, "/accessors/0"),
        ),
        (
            count,
            json!(1_u64 << 62),
            Refused(Reference, "/accessors/0"),
        ),
        (count, json!(u64::MAX), Refused(Reference, "/accessors/0")),
        (count, json!(1.5), Refused(ErrorKind::Value, count)),
        (count, json!("3"), Refused(ErrorKind::Value, count)),
        ("/accessors/1/count", json!(0), Loads(0)),
        ("/accessors/1/count", json!(2), Loads(1)),
        (
            "/accessors/0/byteOffset",
            json!(u64::MAX - 7),
            Refused(Reference, "/accessors/0"),
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX - 7),
            Refused(Reference, "/bufferViews/0"),
        ),
        (
            "/bufferViews/0/byteLength",
            json!(u64::MAX - 7),
            Refused(Reference, "/bufferViews/0"),
        ),
        (
            "/accessors/0/bufferView",
            json!(2),
            Refused(Reference, "/accessors/0/bufferView"),
        ),
        (
            "/accessors/0/type",
            json!("MAT3"),
            Refused(ErrorKind::Value, "/accessors/0/type"),
        ),
        (
            "/accessors/0/componentType",
            json!(5124),
            Refused(ErrorKind::Value, "/accessors/0/componentType"),
        ),
    ] {
        let name = format!("{pointer} = {value}");
        judge(&name, &load(&with(pointer, value)), expected);
    }
    for (count, expected) in [
        (1_u64 << 33, Refused(Budget, "/accessors/0")),
        (1 << 62, Refused(Budget, "/accessors/0")),
        (u64::MAX, Refused(Budget, "/accessors/0")),
    ] {
        let mut file = with("/accessors/0/count", json!(count));
        let indices = file.view(&[0]);
        let values = file.view(&floats(&[0.0; 3]));
        if let Some(accessor) = file.json["accessors"][0].as_object_mut() {
            accessor.remove("bufferView");
        }
        file.json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        judge(&format!("sparse {count}"), &load(&file), expected);
    }
}

#[test]
fn indices_at_and_past_the_end() {
    let place = "/meshes/0/primitives/0/indices";
    for (index, expected) in [
        (2, Loads(0)),
        (3, Refused(Reference, place)),
        (4, Refused(Reference, place)),
        (u16::MAX, Refused(Reference, place)),
    ] {
        let mut file = File::triangle();
        let accessor = file.accessor("SCALAR", 5123, 3, &shorts(&[0, 1, index]));
        file.primitive()["indices"] = json!(accessor);
        judge(&format!("index {index}"), &load(&file), expected);
    }
}

#[test]
fn hierarchies_meet_their_fate() {
    let deep = || {
        let mut nodes: Vec<Value> = (1..200_000).map(|i| json!({ "children": [i] })).collect();
        nodes.push(json!({ "mesh": 0 }));
        nodes
    };
    // node i has the children i + 1, twice: 2^40 ways to the last one
    let doubled: Vec<Value> = (1..=40)
        .map(|i| json!({ "children": [i, i] }))
        .chain([json!({})])
        .collect();
    let child = "/nodes/0/children/1";
    for (name, nodes, expected) in [
        (
            "self-cycle",
            json!([{ "children": [0] }]),
            Refused(Hierarchy, "/nodes/0"),
        ),
        (
            "2-cycle",
            json!([{ "children": [1] }, { "children": [0] }]),
            Refused(Hierarchy, "/nodes/0"),
        ),
        (
            "two parents",
            json!([{ "children": [1, 2] }, { "children": [2] }, {}]),
            Refused(Hierarchy, "/nodes/1/children/0"),
        ),
        ("2^40 paths", json!(doubled), Refused(Hierarchy, child)),
        (
            "child past the end",
            json!([{ "children": [1] }]),
            Refused(Reference, "/nodes/0/children/0"),
        ),
        (
            "a chain of 200,000",
            json!(deep()),
            Refused(Hierarchy, "/nodes/4096"),
        ),
    ] {
        let mut file = File::triangle();
        file.json["nodes"] = nodes;
        judge(name, &load(&file), expected);
    }
    // allowed to be that deep, the chain loads, and a stack of 256 KiB is enough for it
    let mut file = File::triangle();
    file.json["nodes"] = json!(deep());
    let bytes = file.glb();
    let options = LoadOptions {
        max_depth: 1 << 20,
        ..LoadOptions::default()
    };
    let small = std::thread::Builder::new().stack_size(256 << 10);
    let loaded =
        small.spawn(move || load_bytes(&bytes, "deep.glb", &options).map(|l| l.description));
    let description = loaded.unwrap().join().unwrap().unwrap();
    assert_eq!(description.instances.len(), 1);
}

#[test]
fn numbers_in_the_document_meet_their_fate() {
    let huge = json!(1e39);
    let camera = |value: Value| json!([{ "type": "perspective", "perspective": { "yfov": value, "znear": 0.1 } }]);
    for (pointer, value, expected) in [
        ("/nodes/0/scale", json!([0, 0, 0]), Loads(1)),
        ("/nodes/0/scale", json!([1, 0, 1]), Loads(1)),
        ("/nodes/0/scale", json!([-1, 1, 1]), Loads(0)),
        ("/nodes/0/scale", json!([1e-40, 1, 1]), Loads(0)),
        ("/nodes/0/scale", json!([1e38, 1e38, 1e38]), Loads(0)),
        (
            "/nodes/0/scale",
            json!([huge, 1, 1]),
            Refused(NotFinite, "/nodes/0/scale/0"),
        ),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), Loads(1)),
        ("/nodes/0/rotation", json!([0, 0, 0, 1e38]), Loads(0)),
        (
            "/nodes/0/translation",
            json!([0, huge, 0]),
            Refused(NotFinite, "/nodes/0/translation/1"),
        ),
    ] {
        let name = format!("{pointer} = {value}");
        judge(&name, &load(&with(pointer, value)), expected);
    }
    let yfov = "/cameras/0/perspective/yfov";
    for (value, expected) in [
        (json!(0.8), Loads(0)),
        (json!(0), Refused(ErrorKind::Value, yfov)),
        (json!(4), Refused(ErrorKind::Value, yfov)),
        (huge.clone(), Refused(NotFinite, yfov)),
    ] {
        let mut file = File::triangle();
        file.json["cameras"] = camera(value.clone());
        judge(&format!("yfov {value}"), &load(&file), expected);
    }
    let light = "/extensions/KHR_lights_punctual/lights/0/intensity";
    for (value, expected) in [
        (json!(1e38), Loads(0)),
        (json!(1e-42), Loads(0)),
        (json!(-1), Loads(1)),
        (huge.clone(), Refused(NotFinite, light)),
        (json!(null), Refused(ErrorKind::Value, light)),
    ] {
        let mut file = File::triangle();
        file.json["extensions"] = json!({ "KHR_lights_punctual": {
            "lights": [{ "type": "point", "intensity": value }] } });
        judge(&format!("intensity {value}"), &load(&file), expected);
    }
}

#[test]
fn numbers_in_the_buffer_meet_their_fate() {
    for (value, expected) in [
        (
            f32::NAN,
            Refused(NotFinite, "/meshes/0/primitives/0/attributes/POSITION"),
        ),
        (
            f32::INFINITY,
            Refused(NotFinite, "/meshes/0/primitives/0/attributes/POSITION"),
        ),
        (
            f32::NEG_INFINITY,
            Refused(NotFinite, "/meshes/0/primitives/0/attributes/POSITION"),
        ),
        (1e38, Loads(0)),
        (1e-42, Loads(0)),
        (-0.0, Loads(0)),
    ] {
        let mut file = File::triangle();
        file.binary[4..8].copy_from_slice(&value.to_le_bytes());
        judge(&format!("a position of {value:e}"), &load(&file), expected);
        // a scene of it is compiled, or refused in words
        if let Ok(loaded) = load(&file) {
            let options = crate::SceneOptions::default();
            let _ = crate::Scene::new(&loaded.description, &options).map_err(|e| e.to_string());
        }
    }
    for value in [f32::NAN, f32::INFINITY, 1e38, 1e-42, 0.0] {
        let mut file = File::triangle();
        file.attribute("NORMAL", "VEC3", 5126, &floats(&[value; 9]));
        let loaded = file.load();
        let normals = &loaded.description.meshes[0].normals;
        let sound = normals.iter().all(|n| n.is_finite());
        assert!(sound, "normals of {value:e}: {normals:?}");
    }
}

#[test]
fn texts_meet_their_fate() {
    let text = |text: &[u8]| load_bytes(text, "test.gltf", &LoadOptions::default());
    let sound = br#"{"asset":{"version":"2.0"}}"#;
    let long = format!(
        r#"{{"asset":{{"version":"2.0","generator":"{}"}}}}"#,
        "x".repeat(100 << 20)
    );
    let deep = |open: &str, close: &str| {
        format!("{}{}", open.repeat(100_000), close.repeat(100_000)).into_bytes()
    };
    let cases: Vec<(&str, Vec<u8>, Fate)> = vec![
        ("sound", sound.to_vec(), Loads(0)),
        (
            "a byte order mark",
            [b"\xef\xbb\xbf", &sound[..]].concat(),
            Loads(0),
        ),
        (
            "two marks",
            [b"\xef\xbb\xbf\xef\xbb\xbf", &sound[..]].concat(),
            Refused(Syntax, "line 1, column 1"),
        ),
        (
            "UTF-16",
            b"\xff\xfe{\0}\0".to_vec(),
            Refused(Syntax, "line 1, column 1"),
        ),
        // of two members with one key the last one counts
        (
            "duplicate keys",
            br#"{"asset":{"version":"1.0","version":"2.0"}}"#.to_vec(),
            Loads(0),
        ),
        (
            "duplicate keys, the last wrong",
            br#"{"asset":{"version":"2.0","version":"1.0"}}"#.to_vec(),
            Refused(ErrorKind::Value, "/asset/version"),
        ),
        ("100 MB in a string", long.into_bytes(), Loads(0)),
        ("deep arrays", deep("[", "]"), RefusedSomewhere(Syntax)),
        (
            "deep objects",
            deep("{\"a\":", "}"),
            RefusedSomewhere(Syntax),
        ),
        (
            "NaN",
            br#"{"asset":{"version":NaN}}"#.to_vec(),
            RefusedSomewhere(Syntax),
        ),
        (
            "a number too long",
            br#"{"a":1e999}"#.to_vec(),
            RefusedSomewhere(Syntax),
        ),
    ];
    for (name, bytes, expected) in &cases {
        judge(name, &text(bytes), *expected);
    }
    // invalid UTF-8 within a string
    let broken = b"{\"asset\":{\"version\":\"2.\xff\"}}";
    assert_eq!(text(broken).unwrap_err().kind(), Syntax);
}

/// A PNG's header with other dimensions, its checksum right.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = png(1, 1);
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = super::surface::crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

/// A JPEG's frame header with other dimensions.
fn jpeg_of(width: u16, height: u16) -> Vec<u8> {
    let mut bytes = jpeg(8, 8);
    let at = bytes.windows(2).position(|w| w == [0xff, 0xc0]).unwrap() + 5;
    bytes[at..at + 2].copy_from_slice(&height.to_be_bytes());
    bytes[at + 2..at + 4].copy_from_slice(&width.to_be_bytes());
    bytes
}

#[test]
fn pictures_that_claim_too_much_are_refused() {
    let start = std::time::Instant::now();
    for (name, bytes, expected) in [
        (
            "PNG 60000 x 60000",
            png_of(60_000, 60_000),
            Refused(Image, "/images/0"),
        ),
        (
            "PNG 2000000 x 16",
            png_of(2_000_000, 16),
            Refused(Image, "/images/0"),
        ),
        (
            "PNG 2^31 - 1 squared",
            png_of(0x7fff_ffff, 0x7fff_ffff),
            Refused(Image, "/images/0"),
        ),
        ("PNG 0 x 1", png_of(0, 1), Refused(Image, "/images/0")),
        (
            "JPEG 60000 x 60000",
            jpeg_of(60_000, 60_000),
            Refused(Image, "/images/0"),
        ),
        (
            "JPEG 65535 x 16",
            jpeg_of(65_535, 16),
            Refused(Image, "/images/0"),
        ),
        ("JPEG 8 x 8", jpeg_of(8, 8), Loads(0)),
    ] {
        let mut file = File::triangle();
        let view = file.view(&bytes);
        file.json["images"] = json!([{ "bufferView": view }]);
        judge(name, &load(&file), expected);
    }
    let place = "/scenes/0/extras/kaustik/environment";
    for (width, height) in [(60_000, 60_000), (2_000_000, 16)] {
        let mut file = File::triangle();
        let text = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n....");
        let view = file.view(text.as_bytes());
        file.json["scenes"][0]["extras"] =
            json!({ "kaustik": { "environment": { "bufferView": view } } });
        judge("HDR", &load(&file), Refused(Image, place));
    }
    assert!(start.elapsed().as_secs() < 5);
}
