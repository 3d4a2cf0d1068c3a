//! Light as faint and as bright as single precision holds: pictures without an infinity.

use std::path::Path;

use kaustik::film::{Keep, Limits, read};

use crate::words::{kaustik, path};

/// A room with a lamp of this radiance, as glTF: a floor that faces a lamp above it; all of it so many times as large.
pub(crate) fn room(radiance: &str, times: f64) -> String {
    let (height, distance) = (0.5 * times, 2.0 * times);
    let numbers =
        |numbers: &[f32]| -> Vec<u8> { numbers.iter().flat_map(|v| v.to_le_bytes()).collect() };
    // two squares, the lower one facing up, the upper one down
    let mut bytes = numbers(&[-1., 0., 1., 1., 0., 1., 1., 0., -1., -1., 0., -1.]);
    bytes.extend(numbers(&[
        -0.3, 1., -0.3, 0.3, 1., -0.3, 0.3, 1., 0.3, -0.3, 1., 0.3,
    ]));
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    let list: Vec<String> = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    let uri = format!("data:application/octet-stream,{}", list.concat());
    format!(
        r#"{{"asset": {{"version": "2.0"}},
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0, "scenes": [{{"nodes": [0, 1, 2]}}],
        "nodes": [{{"mesh": 0, "scale": [{times}, {times}, {times}]}}, {{"mesh": 1, "scale": [{times}, {times}, {times}]}},
            {{"camera": 0, "translation": [0, {height}, {distance}]}}],
        "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1.2, "znear": 0.01}}}}],
        "materials": [
            {{"pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}}},
            {{"emissiveFactor": [1, 1, 1], "doubleSided": true,
              "extensions": {{"KHR_materials_emissive_strength": {{"emissiveStrength": {radiance}}}}}}}],
        "meshes": [
            {{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 2, "material": 0}}]}},
            {{"primitives": [{{"attributes": {{"POSITION": 1}}, "indices": 2, "material": 1}}]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-1, 0, -1], "max": [1, 0, 1]}},
            {{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-0.3, 1, -0.3], "max": [0.3, 1, 0.3]}},
            {{"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
        "bufferViews": [
            {{"buffer": 0, "byteOffset": 0, "byteLength": 48}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 48}},
            {{"buffer": 0, "byteOffset": 96, "byteLength": 12}}],
        "buffers": [{{"byteLength": 108, "uri": "{uri}"}}]}}"#
    )
}

/// The sum of a picture, found finite in every pixel and layer.
fn sum(file: &str) -> f64 {
    let image = read(Path::new(file), &Limits::default(), Keep::All).expect("a picture");
    for layer in image.layers() {
        for channel in &layer.channels {
            let finite = channel.samples.iter().all(|v| v.is_finite());
            assert!(finite, "{file}: {} {}", layer.name, channel.name);
        }
    }
    let planes = image.rgb();
    planes
        .iter()
        .flat_map(|plane| plane.iter())
        .map(|&v| f64::from(v))
        .sum()
}

/// Pictures of a faint and of a bright lamp are that of a lamp of radiance 1, but for the unit.
#[test]
fn faint_and_bright_lamps() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let methods = [
        "path", "light", "bdpt", "pssmlt", "mmlt", "relt", "mlt", "erpt", "sppm",
    ];
    for method in methods {
        let render = |radiance: &str| {
            let (scene, exr, png) = (file("room.gltf"), file("a.exr"), file("a.png"));
            std::fs::write(&scene, room(radiance, 1.0)).expect("a file");
            let mut words = vec!["render", &scene, "--method", method, "--width", "16"];
            words.extend(["--height", "16", "--spp", "8", "--max-depth", "5"]);
            match method {
                "pssmlt" | "mmlt" | "mlt" => words.extend(["--set", "pilot=5000"]),
                "relt" => words.extend(["--set", "particles=1000"]),
                "sppm" => words.extend(["--set", "photons=2000"]),
                _ => {}
            }
            words.extend(["-o", &exr, "--png", &png]);
            let output = kaustik(&words);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{method} {radiance}: {said}");
            assert!(!said.contains("left out"), "{method} {radiance}: {said}");
            assert!(!said.contains("black"), "{method} {radiance}: {said}");
            let shown = std::fs::read(&png).expect("a picture");
            (sum(&exr), shown)
        };
        let (one, _) = render("1.0");
        assert!(one > 0.0, "{method}");
        for (radiance, times) in [("1e-30", 1e-30), ("1e30", 1e30)] {
            let (found, shown) = render(radiance);
            assert!(found > 0.0, "{method} {radiance}");
            // Chains take other ways where the last bit of a density decides; independent samples do not.
            let share = match method {
                "path" | "light" | "bdpt" => 1e-3,
                _ => 0.5,
            };
            let off = (found / times / one - 1.0).abs();
            assert!(off < share, "{method} {radiance}: {found:e} for {one:e}");
            assert!(shown.starts_with(b"\x89PNG"), "{method} {radiance}");
        }
    }
}

/// The sky as well, as bright as a scene may say, and a lamp so large that the light of its walks overflows: it is counted, and
/// the file has no infinity.
#[test]
fn a_sky_at_the_end_of_single_precision() {
    let folder = tempfile::tempdir().expect("a folder");
    let (exr, png) = (path(folder.path(), "a.exr"), path(folder.path(), "a.png"));
    let large = path(folder.path(), "large.gltf");
    std::fs::write(&large, room("1e30", 1e5)).expect("a file");
    let sky = |radiance: &'static str| ["builtin:cornell", "--environment", radiance];
    let (bright, faint) = (sky("1e30"), sky("1e-30"));
    for (method, scene) in [
        ("path", &bright[..]),
        ("bdpt", &bright),
        ("pssmlt", &bright),
        ("bdpt", &faint),
        ("light", &[&large]),
        ("bdpt", &[&large]),
        ("mmlt", &[&large]),
    ] {
        let mut words = [&["render"], scene].concat();
        words.extend(["--method", method, "--width", "16", "--height", "16"]);
        words.extend(["--spp", "8", "--max-depth", "5", "-o", &exr, "--png", &png]);
        let output = kaustik(&words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{method} {scene:?}: {said}");
        // `sum` has looked at each of them
        if scene == [&large] {
            assert!(said.contains("left out"), "{method}: {said}");
        } else {
            assert!(sum(&exr) > 0.0, "{method} {scene:?}");
        }
    }
}
