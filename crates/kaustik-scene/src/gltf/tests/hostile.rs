//! Files that lie: containers, syntax, budgets, paths.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;

use super::file::{File, floats, glb};
use crate::gltf::{ErrorKind, LoadError, LoadOptions, Loaded, load, load_bytes};

fn bytes(bytes: &[u8]) -> Result<Loaded, LoadError> {
    load_bytes(bytes, "test.glb", &LoadOptions::default())
}

fn kind(b: &[u8]) -> ErrorKind {
    bytes(b).expect_err("this should have been refused").kind()
}

#[test]
fn a_glb_cut_anywhere_is_refused() {
    let whole = File::triangle().glb();
    assert!(bytes(&whole).is_ok());
    for length in 0..whole.len() {
        let error = bytes(&whole[..length]).expect_err("half a file");
        assert_eq!(error.kind(), ErrorKind::Syntax, "{length}: {error}");
    }
}

#[test]
fn a_text_cut_anywhere_is_refused() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "byteLength": 44, "uri": "data:;base64,AAAA" }]);
    let whole = file.json_bytes();
    for length in 0..whole.len() {
        assert_eq!(kind(&whole[..length]), ErrorKind::Syntax, "{length}");
    }
}

#[test]
fn wrong_chunks_are_refused_with_their_place() {
    let whole = File::triangle().glb();
    let with = |at: usize, word: u32| {
        let mut b = whole.clone();
        b[at..at + 4].copy_from_slice(&word.to_le_bytes());
        b
    };
    let json = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    for (b, words) in [
        (with(4, 1), ["byte 4", "version 1"]),
        (with(8, u32::MAX), ["byte 8", "may be incomplete"]),
        (with(8, 11), ["byte 8", "a length of 11"]),
        (with(12, u32::MAX), ["byte 12", "a chunk of 4294967295"]),
        (with(12, json as u32 + 1), ["byte ", "found"]),
        (with(16, 0x4e49_4200), ["byte 16", "the JSON chunk first"]),
        (
            with(20 + json, u32::MAX - 8),
            ["a chunk of 4294967287", "left"],
        ),
    ] {
        let message = bytes(&b).unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "\"{message}\" lacks \"{word}\"");
        }
    }
    // a shorter binary chunk holds less than its buffer says
    let short = with(20 + json, 40);
    assert!(bytes(&short).is_err());
    // no binary chunk at all; the type of the second chunk is unknown
    assert_eq!(kind(&with(24 + json, 0)), ErrorKind::Reference);
    // bytes after the end
    let mut longer = whole.clone();
    longer.extend([0; 5]);
    let loaded = bytes(&longer).unwrap();
    assert_eq!(
        loaded.warnings[0].message,
        "5 bytes after the end are ignored"
    );
}

#[test]
fn syntax_errors_tell_line_and_column() {
    let message = bytes(b"{\n  \"asset\": {\n    \"version\" 2\n")
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "test.glb: line 3, column 15: found broken JSON (expected `:`), expected well-formed JSON"
    );
    for text in [
        "",
        "null",
        "[]",
        "3",
        "\"\"",
        "{}",
        "{\"asset\":{}}",
        "\u{feff}{}",
        "{\"asset\":[]}",
    ] {
        assert!(bytes(text.as_bytes()).is_err(), "{text}");
    }
    assert_eq!(kind(b"\xff\xfe{}"), ErrorKind::Syntax);
    let deep = [b"[".repeat(100_000), b"]".repeat(100_000)].concat();
    assert_eq!(kind(&deep), ErrorKind::Syntax);
    let deep = b"{\"a\":".repeat(100_000);
    assert_eq!(kind(&deep), ErrorKind::Syntax);
}

#[test]
fn other_versions_are_refused() {
    let version = |v: &str| bytes(format!(r#"{{"asset":{{"version":"{v}"}}}}"#).as_bytes());
    assert!(version("2.0").is_ok() && version("2.1").is_ok());
    let message = version("1.0").unwrap_err().to_string();
    assert!(
        message.contains("/asset/version: found \"1.0\""),
        "{message}"
    );
    let later = br#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#;
    assert_eq!(kind(later), ErrorKind::Value);
}

#[test]
fn a_sparse_accessor_cannot_ask_for_the_world() {
    let start = Instant::now();
    let mut file = File::triangle();
    let indices = file.view(&[0]);
    let values = file.view(&floats(&[0.0; 3]));
    let accessor = json!({
        "type": "VEC3", "componentType": 5126, "count": 8_600_000_000_u64,
        "sparse": {
            "count": 1,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        },
    });
    let accessor = file.push("accessors", accessor);
    file.primitive()["attributes"]["POSITION"] = json!(accessor);
    let error = file.error();
    assert_eq!(error.kind(), ErrorKind::Budget, "{error}");
    assert!(error.to_string().contains("GiB"), "{error}");
    for count in [u64::MAX, u64::MAX / 12, u64::MAX / 16] {
        file.json["accessors"][accessor]["count"] = json!(count);
        assert_eq!(file.error().kind(), ErrorKind::Budget);
    }
    assert!(start.elapsed() < Duration::from_secs(1));
}

#[test]
fn ranges_are_checked_without_overflow() {
    let most = json!(u64::MAX);
    for (pointer, place) in [
        ("/accessors/0/count", "/accessors/0"),
        ("/accessors/0/byteOffset", "/accessors/0"),
        ("/bufferViews/0/byteOffset", "/bufferViews/0"),
        ("/bufferViews/0/byteLength", "/bufferViews/0"),
        ("/bufferViews/0/byteStride", "/accessors/0"),
        ("/accessors/0/bufferView", "/accessors/0/bufferView"),
        ("/bufferViews/0/buffer", "/bufferViews/0/buffer"),
        (
            "/meshes/0/primitives/0/indices",
            "/meshes/0/primitives/0/indices",
        ),
        ("/nodes/0/mesh", "/nodes/0/mesh"),
        ("/scenes/0/nodes/0", "/scenes/0/nodes/0"),
        ("/buffers/0/byteLength", "/buffers/0"),
    ] {
        let mut file = File::triangle();
        file.json["buffers"] = json!([{ "byteLength": file.binary.len() }]);
        file.json["accessors"][0]["byteOffset"] = json!(0);
        file.json["bufferViews"][0]["byteStride"] = json!(12);
        *file.json.pointer_mut(pointer).unwrap() = most.clone();
        let error = file.error();
        assert_eq!(error.place(), place, "{error}");
        assert_eq!(error.kind(), ErrorKind::Reference, "{error}");
        *file.json.pointer_mut(pointer).unwrap() = json!(-1);
        let error = file.error();
        assert_eq!((error.place(), error.found()), (pointer, "-1"), "{error}");
    }
}

#[test]
fn the_budget_is_the_callers() {
    let file = File::triangle();
    let need = file.load().memory;
    assert!(
        file.load_with(&LoadOptions::default().with_max_memory(need))
            .is_ok()
    );
    let error = file
        .load_with(&LoadOptions::default().with_max_memory(need - 1))
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Budget);
    assert!(error.to_string().contains("--max-memory"), "{error}");
    // the tree of many small objects costs much more than its text
    let objects = format!("{{\"a\":[{}0]}}", "{\"\":0},".repeat(1 << 16));
    let options = LoadOptions::default().with_max_memory(4 << 20);
    let error = load_bytes(objects.as_bytes(), "test.gltf", &options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Budget);
}

#[test]
fn repeated_references_do_not_multiply_time() {
    let start = Instant::now();
    let mut file = File::triangle();
    let primitive = file.primitive().clone();
    file.json["meshes"] = json!([{ "primitives": vec![primitive; 20_000] }]);
    let nodes = vec![json!({ "mesh": 0 }); 100];
    file.json["nodes"] = json!(nodes);
    file.json["scenes"][0]["nodes"] = json!((0..100).collect::<Vec<_>>());
    let loaded = file.load();
    assert_eq!(loaded.description.meshes.len(), 1);
    assert_eq!(loaded.description.instances.len(), 2_000_000);
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn warnings_do_not_flood() {
    let mut file = File::triangle();
    let mut line = file.primitive().clone();
    line["mode"] = json!(1);
    file.json["meshes"] = json!([{ "primitives": vec![line; 10_000] }]);
    let warnings = file.load().warnings;
    assert_eq!(warnings.len(), 201);
    assert_eq!(warnings[200].message, "9800 more warnings are not shown");
}

/// A scene file in a folder of its own, beside a secret.
struct Disk {
    folder: tempfile::TempDir,
}

impl Disk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("scene")).unwrap();
        fs::write(folder.path().join("secret.bin"), File::triangle().binary).unwrap();
        Self { folder }
    }

    fn scene(&self) -> std::path::PathBuf {
        self.folder.path().join("scene")
    }

    /// Loads a scene whose buffer is at `uri`.
    fn load(&self, uri: &str) -> Result<Loaded, LoadError> {
        let mut file = File::triangle();
        file.json["buffers"] = json!([{ "uri": uri, "byteLength": file.binary.len() }]);
        let path = self.scene().join("scene.gltf");
        fs::write(&path, file.json_bytes()).unwrap();
        load(&path, &LoadOptions::default())
    }
}

#[test]
fn files_beside_the_scene_are_read() {
    let disk = Disk::new();
    let binary = File::triangle().binary;
    fs::create_dir(disk.scene().join("a b")).unwrap();
    fs::write(disk.scene().join("a b/100%.bin"), binary).unwrap();
    assert!(disk.load("a%20b/100%25.bin").is_ok());
    assert!(disk.load("./a b/../a%20b/100%25.bin").is_ok());
    let error = disk.load("a%20b/100%2525.bin").unwrap_err();
    assert_eq!(
        (error.kind(), error.place()),
        (ErrorKind::Io, "/buffers/0/uri")
    );
}

/// Backslashes part folders where no name has them, and a percent sign that begins no escape is one.
#[test]
fn what_exporters_write_is_found() {
    let disk = Disk::new();
    let binary = File::triangle().binary;
    fs::create_dir(disk.scene().join("textures")).unwrap();
    fs::write(disk.scene().join("textures/10%.bin"), binary).unwrap();
    for uri in [
        "textures/10%.bin",
        "textures\\10%.bin",
        "textures%5C10%25.bin",
    ] {
        assert!(disk.load(uri).is_ok(), "{uri}");
    }
    let error = disk.load("textures\\11%.bin").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(error.to_string().contains("textures\\11%.bin"), "{error}");
    for uri in ["textures\\..\\..\\secret.bin", "..%5Csecret.bin"] {
        let error = disk.load(uri).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Forbidden, "{uri}");
    }
}

#[test]
fn nothing_outside_is_opened() {
    let disk = Disk::new();
    let secret = disk.folder.path().join("secret.bin");
    for uri in [
        "../secret.bin".to_owned(),
        "%2e%2e/secret.bin".to_owned(),
        "%2e%2e%2fsecret.bin".to_owned(),
        "x/../../secret.bin".to_owned(),
        secret.display().to_string(),
        format!("file://{}", secret.display()),
        format!("%66ile://{}", secret.display()),
    ] {
        let error = disk.load(&uri).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Forbidden, "{error}");
        assert_eq!(error.place(), "/buffers/0/uri");
        assert!(error.to_string().contains("copy the file beside the scene"));
    }
}

#[test]
#[cfg(unix)]
fn links_out_of_the_folder_are_not_followed() {
    use std::os::unix::fs::symlink;
    let disk = Disk::new();
    fs::write(disk.scene().join("real.bin"), File::triangle().binary).unwrap();
    symlink("real.bin", disk.scene().join("inside.bin")).unwrap();
    symlink("../secret.bin", disk.scene().join("outside.bin")).unwrap();
    symlink("..", disk.scene().join("up")).unwrap();
    assert!(disk.load("inside.bin").is_ok());
    for uri in ["outside.bin", "up/secret.bin"] {
        let error = disk.load(uri).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Forbidden, "{error}");
    }
    // a folder whose name begins like the scene's
    fs::create_dir(disk.folder.path().join("scene2")).unwrap();
    fs::copy(
        disk.scene().join("real.bin"),
        disk.folder.path().join("scene2/real.bin"),
    )
    .unwrap();
    symlink("../scene2/real.bin", disk.scene().join("sibling.bin")).unwrap();
    assert_eq!(
        disk.load("sibling.bin").unwrap_err().kind(),
        ErrorKind::Forbidden
    );
}

#[test]
#[cfg(unix)]
fn pipes_devices_and_folders_are_not_read() {
    let disk = Disk::new();
    let pipe = disk.scene().join("pipe.bin");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    fs::create_dir(disk.scene().join("folder")).unwrap();
    let mut uris = vec!["folder"];
    if made.is_ok_and(|status| status.success()) {
        uris.push("pipe.bin");
        let error = load(&pipe, &LoadOptions::default()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Forbidden, "{error}");
    }
    for uri in uris {
        let error = disk.load(uri).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Forbidden, "{error}");
        assert!(error.to_string().contains("a regular file"), "{error}");
    }
    let error = load(Path::new("/dev/zero"), &LoadOptions::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Forbidden, "{error}");
}

#[test]
fn missing_files_are_named() {
    let error = load(Path::new("/nowhere/scene.glb"), &LoadOptions::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(
        error.to_string().starts_with("/nowhere/scene.glb: "),
        "{error}"
    );
    assert!(std::error::Error::source(&error).is_some());
    let message = Disk::new().load("gone.bin").unwrap_err().to_string();
    assert!(
        message.contains("scene.gltf: /buffers/0/uri: ") && message.contains("gone.bin"),
        "{message}"
    );
}

#[test]
fn memory_has_no_folder() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "uri": "Cargo.toml", "byteLength": 1 }]);
    file.refused(&["/buffers/0/uri", "data uri"]);
}

#[test]
fn buffers_without_data_matter_only_where_used() {
    let mut file = File::triangle();
    file.json["buffers"] = json!([{ "byteLength": file.binary.len() }, { "byteLength": 100 }]);
    assert!(bytes(&file.glb()).is_ok());
    file.json["bufferViews"][0]["buffer"] = json!(1);
    file.refused(&["/bufferViews/0/buffer", "neither a uri nor a binary chunk"]);
    file.json["buffers"][0]["byteLength"] = json!(10_000);
    file.refused(&["/buffers/0", "byteLength = 10000"]);
}

#[test]
fn messages_stay_short_and_clean() {
    let mut file = File::triangle();
    file.json["nodes"][0]["mesh"] = json!(format!("\u{1b}[31m{}", "x".repeat(100_000)));
    let message = file.error().to_string();
    assert!(
        message.len() < 300 && !message.contains('\u{1b}'),
        "{message}"
    );
    let text = glb(b"{\"asset\":{\"version\":\"2.0\"}}", &[]);
    assert!(bytes(&text).is_ok());
}
