//! A scene opens nothing outside its folder, whatever its uris say.
#![cfg(target_os = "linux")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::injected::{figures, has_strace};
use crate::words::{kaustik, path};

/// Numbers that follow from their index.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        // Knuth's generator; the upper bits are the good ones
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n as u64) as usize
    }
}

/// A uri out of parts that lead out, or look as if they did.
fn uri(index: u64, outside: &str) -> String {
    let plain = outside.trim_start_matches('/');
    let parts = [
        "..",
        "../",
        "/..",
        "%2e%2e/",
        "..%2f",
        ".%2E/",
        "%2e.%5c",
        "..\\",
        "./",
        "/",
        "//",
        "%2F",
        "\\",
        "sub/",
        "sub/../../",
        "link/",
        "link/points.bin",
        "points.bin",
        "points-link.bin",
        "outside/points.bin",
        "../outside/points.bin",
        "secret/",
        "file:",
        "file://",
        "file:///",
        "http://localhost/",
        "C:",
        "\\\\host\\",
        "~/",
        "%00",
        "%FF",
        "%",
        "%2",
        "?x",
        "#y",
        " ",
        "%20",
        "data:,",
        "%252e%252e/",
        "....//",
        "/proc/self/environ",
        "/dev/zero",
        "\u{202e}",
        "\u{ff0e}\u{ff0e}/",
        outside,
        plain,
    ];
    let mut chance = Chance(index.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    chance.below(2);
    if chance.below(10) == 0 {
        // One that leads nowhere but to the folder's own file.
        let within = ["./", "sub/../", "sub/./../"];
        let steps: String = (0..chance.below(6))
            .map(|_| within[chance.below(3)])
            .collect();
        return steps + "points.bin";
    }
    let count = 1 + chance.below(5);
    let mut uri: String = (0..count)
        .map(|_| parts[chance.below(parts.len())])
        .collect();
    if chance.below(3) == 0 {
        uri += ["points.bin", "outside/points.bin", "points.png"][chance.below(3)];
    }
    uri
}

/// A folder with a scene whose buffer or image is at this uri, and beside it what must not be opened: the same bytes, so that
/// whoever opened them would have a sound scene.
struct Place {
    _folder: tempfile::TempDir,
    inside: String,
    outside: String,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let root = fs::canonicalize(folder.path()).expect("a folder");
        let (inside, outside) = (root.join("inside"), root.join("outside"));
        fs::create_dir_all(inside.join("sub")).expect("a folder");
        fs::create_dir_all(&outside).expect("a folder");
        let points: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        for folder in [&outside, &root, &inside] {
            fs::write(folder.join("points.bin"), &points).expect("a file");
        }
        std::os::unix::fs::symlink(&outside, inside.join("link")).expect("a link");
        let to = outside.join("points.bin");
        std::os::unix::fs::symlink(to, inside.join("points-link.bin")).expect("a link");
        Self {
            inside: path(&root, "inside"),
            outside: path(&outside, "points.bin"),
            _folder: folder,
        }
    }

    fn write(&self, uri: &str, image: bool) -> String {
        let (buffer, picture) = match image {
            false => (uri, "data:image/png;base64,"),
            true => ("points.bin", uri),
        };
        let scene = serde_json::json!({
            "asset": { "version": "2.0" },
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
            "materials": [match image {
                false => serde_json::json!({}),
                true => serde_json::json!({
                    "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } }
                }),
            }],
            "textures": [{ "source": 0 }],
            "images": [{ "uri": picture }],
            "accessors": [{
                "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0],
            }],
            "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
            "buffers": [{ "byteLength": 36, "uri": buffer }],
        });
        let mut scene = scene;
        if !image {
            for unused in ["textures", "images"] {
                scene.as_object_mut().expect("an object").remove(unused);
            }
        }
        let file = format!("{}/scene.gltf", self.inside);
        fs::write(&file, scene.to_string()).expect("a file");
        file
    }
}

/// Where a uri leads, if it leads to a file within the folder: nothing else may load.
fn is_inside(uri: &str, inside: &str) -> bool {
    let plain = uri.split(['?', '#']).next().unwrap_or(uri);
    let real = fs::canonicalize(Path::new(inside).join(plain));
    real.is_ok_and(|real| real.starts_with(inside)) && !plain.starts_with('/')
}

/// Without tools: outside lie the bytes that would make a sound scene, and no scene is sound by them.
#[test]
fn what_lies_outside_is_refused() {
    let place = Place::new();
    let sound = place.write("points.bin", false);
    assert!(kaustik(&["info", &sound]).status.success());
    let mut refused = 0;
    for index in 0..60 {
        let uri = uri(index, &place.outside);
        if is_inside(&uri, &place.inside) {
            continue;
        }
        let output = kaustik(&["info", &place.write(&uri, index % 2 == 1)]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{uri:?}: {said}");
        refused += 1;
    }
    for uri in [
        &place.outside,
        "../points.bin",
        "link/points.bin",
        "points-link.bin",
        "%2e%2e/points.bin",
    ] {
        let output = kaustik(&["info", &place.write(uri, false)]);
        assert_eq!(output.status.code(), Some(2), "{uri}");
    }
    assert!(refused > 40, "{refused}");
}

/// Paths that the process tried to open after it had opened the scene, as absolute paths; what system and runtime look at
/// for themselves is left out.
fn opened(trace: &str, scene: &str) -> Vec<String> {
    let after = trace.lines().skip_while(|line| !line.contains(scene));
    let quoted = after.filter_map(|line| line.split('"').nth(1));
    let own = ["/proc/self/", "/sys/", "/etc/ld.so", "/lib", "/usr/lib"];
    let runtime =
        |path: &str| path != "/proc/self/environ" && own.iter().any(|own| path.starts_with(own));
    quoted
        .filter(|path| !path.is_empty() && !runtime(path))
        .map(str::to_owned)
        .collect()
}

#[test]
#[ignore = "minutes, with strace"]
fn a_thousand_uris_open_nothing_outside() {
    if !has_strace() {
        return;
    }
    let place = Place::new();
    let trace = format!("{}.trace", place.inside);
    let (mut loaded, mut opens, mut uris) = (0, 0, BTreeSet::new());
    for index in 0.. {
        let uri = uri(index, &place.outside);
        if !uris.insert(uri.clone()) {
            continue;
        }
        let scene = place.write(&uri, index % 2 == 1);
        let status = Command::new("strace")
            .args(["-f", "-qq", "-y", "-s", "4096", "-e"])
            .args(["trace=open,openat,openat2,creat,connect", "-o", &trace])
            .arg(env!("CARGO_BIN_EXE_kaustik"))
            .args(["info", &scene])
            .output()
            .expect("strace runs");
        loaded += usize::from(status.status.success());
        let text = fs::read_to_string(&trace).expect("a trace");
        assert!(text.contains(&scene), "{uri:?}: the scene was read: {text}");
        assert!(!text.contains("connect("), "{uri:?}: {text}");
        for opened in opened(&text, &scene) {
            // Made plain where it exists; what does not is judged by its words.
            let real =
                fs::canonicalize(&opened).map_or(opened.clone(), |p| p.display().to_string());
            let within = Path::new(&real).starts_with(&place.inside) && !real.contains("/..");
            assert!(within, "{uri:?} opened {opened}");
            opens += 1;
        }
        if uris.len() == 1000 {
            break;
        }
    }
    figures(&format!(
        "1000 uris: {loaded} loaded, {opens} opens, none outside"
    ));
    assert!(loaded > 0 && opens >= 1000, "{loaded} {opens}");
}
