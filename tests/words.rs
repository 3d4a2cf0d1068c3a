//! The command as a user meets it: right words, wrong words, wrong files, signals.

use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn kaustik(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .output()
        .expect("the command runs")
}

/// Runs and expects status 2 with a message that holds all of `expected`.
pub(crate) fn refused(words: &[&str], expected: &[&str]) {
    let output = kaustik(words);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{words:?}: {message}");
    for word in expected {
        assert!(
            message.contains(word),
            "{words:?}: no '{word}' in: {message}"
        );
    }
    assert!(output.stdout.is_empty());
}

/// The names in a folder, sorted.
pub(crate) fn files(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = names
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

pub(crate) fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a plain path").to_owned()
}

#[test]
fn renders_and_compares() {
    let folder = tempfile::tempdir().expect("a folder");
    let (exr, png, json) = (
        path(folder.path(), "a.exr"),
        path(folder.path(), "a.png"),
        path(folder.path(), "a.json"),
    );
    let output = kaustik(&[
        "render",
        "builtin:cornell",
        "--method",
        "pssmlt",
        "--width",
        "16",
        "--spp",
        "2",
        "-o",
        &exr,
        "--png",
        &png,
        "--stats",
        &json,
        "--set",
        "pilot=2000",
        "--set",
        "direct=lamps",
        "--crop",
        "2,2,14,15",
        "--filter",
        "mitchell",
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(output.stdout.is_empty(), "standard output stays clean");
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&json).expect("statistics")).expect("JSON");
    assert_eq!(stats["statistics"]["steps"], 2 * 12 * 13);
    let output = kaustik(&["compare", &exr, &exr, "--json"]);
    assert!(output.status.success());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(report["images"][0]["raw"]["rmse"].as_f64() < Some(1e-12));
}

#[test]
fn wrong_words() {
    refused(&["render"], &["SCENE"]);
    refused(&["render", "builtin:nowhere"], &["nowhere", "cornell"]);
    refused(
        &["render", "builtin:cornell", "--method", "magic"],
        &["magic", "pssmlt"],
    );
    refused(
        &[
            "render",
            "builtin:cornell",
            "--method",
            "pssmlt",
            "--set",
            "plarge=2",
        ],
        &["plarge", "0 < p <= 1"],
    );
    refused(
        &["render", "builtin:cornell", "--set", "colour=red"],
        &["colour", "ladders"],
    );
    refused(
        &["render", "builtin:cornell", "--time", "soon"],
        &["soon", "30s"],
    );
    refused(
        &["render", "builtin:cornell", "--spp", "1", "--time", "1s"],
        &["--time"],
    );
    refused(
        &[
            "render",
            "builtin:cornell",
            "--crop",
            "0,0,9999,9999",
            "--spp",
            "1",
        ],
        &["crop"],
    );
    // before a point, a sample or a byte is made for each of its pixels
    for method in ["sppm", "pssmlt", "photon-density"] {
        let crop = ["--crop", "0,0,4294967295,4294967295", "--spp", "1"];
        let words = ["render", "builtin:cornell", "--method", method];
        refused(&[words.as_slice(), &crop].concat(), &["crop"]);
    }
    refused(
        &["render", "builtin:cornell", "--variant", "beach"],
        &["beach", "have none"],
    );
    refused(
        &["render", "builtin:cornell", "--max-memory", "100"],
        &["needs", "allows 100"],
    );
    refused(
        &["render", "builtin:cornell", "--camera", "1"],
        &["'1'", "0 (camera)"],
    );
    refused(
        &["render", "builtin:cornell", "--camera", "none"],
        &["none"],
    );
    refused(
        &["render", "builtin:cornell", "--environment=-1"],
        &["environment"],
    );
    refused(
        &["render", "builtin:cornell", "--wavelengths", "3"],
        &["1", "4"],
    );
    refused(
        &[
            "render",
            "builtin:cornell",
            "--ladders",
            "60..70",
            "--spp",
            "1",
        ],
        &["ladders"],
    );
    refused(&["scenes", "cornell"], &["--export"]);
    refused(&["dance"], &["dance"]);
}

#[test]
fn outputs_are_tried_before_the_first_ray() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = path(folder.path(), "nowhere/out.exr");
    refused(
        &["render", "builtin:cornell", "--time", "1h", "-o", &missing],
        &["nowhere"],
    );
    let folder_itself = folder.path().to_str().expect("a plain path");
    refused(
        &[
            "render",
            "builtin:cornell",
            "--time",
            "1h",
            "--png",
            folder_itself,
        ],
        &[folder_itself],
    );
}

/// What a picture is made from is not written over.
#[test]
fn inputs_are_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| path(folder.path(), name);
    let (scene, state) = (at("a.glb"), at("a.state"));
    assert!(
        kaustik(&["scenes", "cornell", "--export", &scene])
            .status
            .success()
    );
    let small = ["--width", "8", "--height", "8", "--spp", "1", "-q"];
    let render = |scene: &str, more: &[&str]| {
        let words = [&["render", scene, "--method", "path"], &small[..], more].concat();
        words.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let words = render(&scene, &["--checkpoint", &state, "--ladders", "0..32"]);
    assert!(
        kaustik(&words.iter().map(String::as_str).collect::<Vec<_>>())
            .status
            .success()
    );
    let kept = [&scene, &state].map(|file| std::fs::read(file).expect("a file"));
    for output in ["-o", "--png", "--stats", "--checkpoint"] {
        let words = render(&scene, &[output, &scene]);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        refused(&words, &["a.glb", "which is read"]);
    }
    for output in ["-o", "--png", "--stats", "--state"] {
        refused(
            &["merge", &state, output, &state],
            &["a.state", "which is read"],
        );
    }
    for output in ["--stats", "--state"] {
        refused(
            &["merge", &state, output, &scene],
            &["a.glb", "which is read"],
        );
    }
    for (words, output, named) in [
        (&[&scene[..], "--at", "0:0"][..], &scene, "a.glb"),
        (&[&state[..], "--at", "0:0"], &state, "a.state"),
        (&[&state[..], "--at", "0:0"], &scene, "a.glb"),
    ] {
        let words = [&["replay"], words, &["--gltf", output]].concat();
        refused(&words, &[named, "which is read"]);
    }
    assert_eq!(
        kept,
        [&scene, &state].map(|file| std::fs::read(file).expect("a file"))
    );
    // Half of the ladders make half of a picture.
    let merged = kaustik(&[
        "merge",
        &state,
        "-o",
        &at("half.exr"),
        "--stats",
        &at("half.json"),
    ]);
    let message = String::from_utf8_lossy(&merged.stderr);
    assert!(
        merged.status.success() && message.contains("ladders 0..32 of 0..64"),
        "{message}"
    );
    let statistics = std::fs::read_to_string(at("half.json")).expect("statistics");
    let statistics: serde_json::Value = serde_json::from_str(&statistics).expect("JSON");
    assert!(statistics["budget"].is_null(), "{statistics}");
}

/// A kind of file that is not the one that is written is a slip.
#[test]
fn kinds_of_files_are_what_they_say() {
    let start = ["render", "builtin:cornell", "--spp", "1"];
    refused(
        &[&start[..], &["-o", "x.png"]].concat(),
        &["--png", "expected .exr"],
    );
    refused(
        &[&start[..], &["--png", "x.exr"]].concat(),
        &["-o", "expected .png"],
    );
    refused(
        &[&start[..], &["--png", "x.jpg"]].concat(),
        &[".jpg", "expected .png"],
    );
    refused(
        &[&start[..], &["--environment", "nowhere.hdr"]].concat(),
        &["nowhere.hdr", "No such file"],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_told() {
    let full = std::fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("the device");
    let output = Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(["info", "builtin:cornell"])
        .stdout(full)
        .output()
        .expect("the command runs");
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("standard output"));
}

#[test]
fn wrong_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = path(folder.path(), "missing.glb");
    refused(&["render", &missing], &["missing.glb"]);
    let cut = path(folder.path(), "cut.glb");
    let whole = path(folder.path(), "whole.glb");
    assert!(
        kaustik(&["scenes", "cornell", "--export", &whole])
            .status
            .success()
    );
    let bytes = std::fs::read(&whole).expect("the export");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("a file");
    refused(&["render", &cut], &["cut.glb"]);
    let extension = path(folder.path(), "extension.gltf");
    let text = r#"{"asset":{"version":"2.0"},"extensionsRequired":["ACME_magic"],"extensionsUsed":["ACME_magic"]}"#;
    std::fs::write(&extension, text).expect("a file");
    refused(&["info", &extension], &["ACME_magic"]);
    let away = path(folder.path(), "away.gltf");
    let text = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"../secret.bin","byteLength":4}],
        "bufferViews":[{"buffer":0,"byteLength":4}],"accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"SCALAR"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]}"#;
    std::fs::write(&away, text).expect("a file");
    refused(&["render", &away], &["/buffers/0"]);
}

#[test]
fn a_black_scene_is_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let png = path(folder.path(), "black.png");
    let exr = path(folder.path(), "black.exr");
    for method in ["path", "light", "pssmlt"] {
        // A lamp that no camera ray and no bounce ever meets: an environment of radiance 0.
        let output = kaustik(&[
            "render",
            "builtin:furnace?kind=glass",
            "--environment",
            "0",
            "--method",
            method,
            "--width",
            "8",
            "--time",
            "1h",
            "--png",
            &png,
            "-o",
            &exr,
        ]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{message}");
        assert!(message.contains("black"), "{message}");
    }
}

#[test]
fn a_start_that_is_shortened_or_takes_most_of_the_time_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let png = path(folder.path(), "short.png");
    let told = |method, time, more: &[&str]| {
        let scene = "builtin:cornell";
        let mut words = vec!["render", scene, "--method", method, "--width", "8"];
        words.extend(["--time", time, "--png", &png]);
        words.extend(more);
        let output = kaustik(&words);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{message}");
        let start = message.lines().find(|line| line.contains("the start"));
        start.unwrap_or_default().to_owned()
    };
    let whole = ["--set", "start=whole"];
    assert!(told("mlt", "1ms", &whole).contains("--set pilot (now 100000)"));
    assert!(told("relt", "1ms", &whole).contains("--set particles (now 10000)"));
    for method in ["relt", "pssmlt", "mlt"] {
        let note = told(method, "1ms", &[]);
        assert!(note.contains("--set start=1/1024"), "{note}");
    }
    assert_eq!(told("path", "1s", &[]), "");
}

#[cfg(unix)]
#[test]
fn a_signal_writes_what_there_is() {
    use std::time::{Duration, Instant};
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        let folder = tempfile::tempdir().expect("a folder");
        let png = path(folder.path(), "part.png");
        let mut child = Command::new(env!("CARGO_BIN_EXE_kaustik"))
            .args([
                "render",
                "builtin:cornell",
                "--method",
                "path",
                "--width",
                "64",
                "--time",
                "1h",
                "--png",
                &png,
            ])
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("the command runs");
        std::thread::sleep(Duration::from_millis(1500));
        let kill = Command::new("kill")
            .args(["-s", signal, &child.id().to_string()])
            .status();
        assert!(kill.expect("kill runs").success());
        let sent = Instant::now();
        assert_eq!(child.wait().expect("it ends").code(), Some(status));
        assert!(sent.elapsed() < Duration::from_secs(10));
        assert!(std::fs::metadata(&png).expect("a picture").len() > 100);
    }
}

#[test]
fn lists_are_printed() {
    for (words, word) in [
        (&["scenes"][..], "water-cornell"),
        (&["methods"], "pssmlt"),
        (&["methods", "pssmlt"], "plarge"),
        (&["info", "builtin:cornell"], "triangles"),
        (&["info", "builtin:cornell"], "MB for tracing rays"),
        (&["info", "builtin:cornell"], "0 camera (pinhole)"),
    ] {
        let output = kaustik(words);
        assert!(output.status.success());
        assert!(
            String::from_utf8_lossy(&output.stdout).contains(word),
            "{words:?}"
        );
    }
}

#[test]
fn studies_are_rendered_and_resumed() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = path(folder.path(), "small.toml");
    let out = path(folder.path(), "out");
    let words = r#"
        title = "small"
        width = 8
        height = 8
        seeds = [1]
        budget = { per_pixel = [2] }
        reference = { method = "path", per_pixel = 8, error = 0.9, most = 2 }
        scene = [{ scene = "builtin:cornell" }]
        method = [{ method = "path" }, { method = "light" }]
    "#;
    std::fs::write(&file, words).expect("a file");
    for _ in 0..2 {
        let output = kaustik(&["study", &file, "-o", &out, "-q"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{message}");
        assert!(message.contains("index.html"), "{message}");
    }
    let page = std::fs::read_to_string(path(folder.path(), "out/index.html")).expect("a page");
    assert!(page.contains("builtin:cornell") && page.contains("<svg"));
    let rows = std::fs::read_to_string(path(folder.path(), "out/study-cells.csv")).expect("rows");
    assert_eq!(rows.lines().count(), 3);

    std::fs::write(&file, words.replace("seeds", "sedes")).expect("a file");
    refused(&["study", &file, "-o", &out], &["small.toml:5:9", "sedes"]);
    refused(&["study", "mlt"], &["pssmlt, relt", ".toml"]);
    refused(&["study", &file, "--quick"], &["not for files"]);
    refused(
        &["study", "relt", "--figure", "3", "-o", &out],
        &["4, 5, 6, 7, 8"],
    );
    refused(
        &["study", "relt", "--quick", "--as-published"],
        &["cannot be used with"],
    );
}
