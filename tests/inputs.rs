//! What a scene is made from is read, and not written over.

use std::fs;

use serde_json::Value;

use crate::words::{kaustik, path, refused};

/// The two chunks of a GLB file.
fn chunks(glb: &[u8]) -> (Value, &[u8]) {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let (json, rest) = glb[20..].split_at(length);
    (
        serde_json::from_slice(json).expect("a document"),
        &rest[8..],
    )
}

/// A scene as text, with its buffer in a file beside it.
#[test]
fn files_that_a_scene_names_are_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| path(folder.path(), name);
    let (glb, gltf, buffer) = (at("a.glb"), at("a.gltf"), at("a.bin"));
    assert!(
        kaustik(&["scenes", "cornell", "--export", &glb])
            .status
            .success()
    );
    let bytes = fs::read(&glb).expect("a file");
    let (mut document, binary) = chunks(&bytes);
    document["buffers"][0]["uri"] = "a.bin".into();
    fs::write(&gltf, document.to_string()).expect("a file");
    fs::write(&buffer, binary).expect("a file");
    let words = [
        "render", &gltf, "--width", "8", "--height", "8", "--spp", "1", "-q",
    ];
    assert!(
        kaustik(&[&words[..], &["--stats", &at("a.json")]].concat())
            .status
            .success()
    );
    for output in ["--stats", "--checkpoint"] {
        refused(
            &[&words[..], &[output, &buffer]].concat(),
            &["a.bin", "which is read"],
        );
    }
    assert_eq!(fs::read(&buffer).expect("a file"), binary);
    let lines = at("lines.glb");
    let replay = ["replay", &gltf, "--at", "0:0", "--gltf"];
    refused(
        &[&replay[..], &[&lines]].concat(),
        &["lines.glb", "as text", ".gltf"],
    );
    assert!(fs::metadata(lines).is_err());
}

/// An exported scene goes where a link leads, as pictures do.
#[cfg(unix)]
#[test]
fn exports_follow_links() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| path(folder.path(), name);
    fs::write(at("real.glb"), b"old").expect("a file");
    std::os::unix::fs::symlink("real.glb", at("link.glb")).expect("a link");
    assert!(
        kaustik(&["scenes", "cornell", "--export", &at("link.glb")])
            .status
            .success()
    );
    assert!(
        fs::symlink_metadata(at("link.glb"))
            .expect("a link")
            .is_symlink()
    );
    assert!(
        fs::read(at("real.glb"))
            .expect("a file")
            .starts_with(b"glTF")
    );
}
