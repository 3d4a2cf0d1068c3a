//! The child: from one file to a verdict.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use kaustik::film::{self, Keep, Limits};
use kaustik::scene::description::{EnvironmentDescription, ImageData, Pixels};
use kaustik::scene::environment::{Environment, load_hdr};
use kaustik::scene::{Scene, SceneOptions, gltf};
use kaustik::{Budget, Control, Method, RenderSettings, render};

use crate::kind::Kind;
use crate::model;

/// Edge of the pictures that are rendered.
const SIDE: u32 = 4;

/// What the child says on success, before the figures.
pub(crate) const PICTURE: &str = "picture";
/// What it says of a file that it refuses.
pub(crate) const REFUSED: &str = "refused";

/// Status 0 with a line `verdict|milliseconds|kilobytes|message`; anything else is a fault.
pub(crate) fn run(kind: Kind, file: &Path) -> ExitCode {
    let start = Instant::now();
    let verdict = verdict(kind, file);
    let milliseconds = start.elapsed().as_secs_f64() * 1e3;
    let (word, message) = match verdict {
        Ok(()) => (PICTURE, String::new()),
        Err(message) => (REFUSED, message.replace(['\n', '|'], " ")),
    };
    let line = format!("{word}|{milliseconds}|{}|{message}\n", peak());
    match io::stdout().lock().write_all(line.as_bytes()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::from(3),
    }
}

/// The most memory that was resident at a time, in kilobytes; 0 where the system does not say.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().nth(1));
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// Loads a file and renders what it holds; a refusal is an error.
///
/// # Panics
///
/// If a pixel is not finite, and wherever there is a fault to be found.
pub fn verdict(kind: Kind, file: &Path) -> Result<(), String> {
    match kind {
        Kind::Model => scene(file),
        Kind::Png | Kind::Jpeg | Kind::Webp => textured(file),
        Kind::Hdr => {
            let decoded = load_hdr(file).map_err(|e| e.to_string())?;
            environment(decoded.image)
        }
        Kind::Exr => {
            let image = film::read(file, &Limits::default(), Keep::Main);
            let image = image.map_err(|e| e.to_string())?;
            let [r, g, b] = image.rgb();
            let clean = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
            let pixels = r.iter().zip(g).zip(b);
            let pixels = pixels.flat_map(|((r, g), b)| [*r, *g, *b].map(clean));
            environment(ImageData {
                name: "exr".to_owned(),
                width: image.width(),
                height: image.height(),
                pixels: Pixels::RgbF32(pixels.collect()),
                encoded: Vec::new(),
            })
        }
        Kind::PlantedPanic => panic!("planted"),
        Kind::PlantedAbort => std::process::abort(),
        Kind::PlantedHang => loop {
            std::thread::sleep(Duration::from_secs(1));
        },
        Kind::PlantedHunger => {
            let hoard = std::hint::black_box(vec![0_u8; 3 << 30]);
            Err(format!("{} bytes were to be had", hoard.len()))
        }
    }
}

fn scene(file: &Path) -> Result<(), String> {
    let loaded = gltf::load(file, &gltf::LoadOptions::default()).map_err(|e| e.to_string())?;
    rendered(&loaded.description)
}

/// The picture as the texture of a triangle.
fn textured(file: &Path) -> Result<(), String> {
    let bytes = fs::read(file).map_err(|e| e.to_string())?;
    let model = model::textured(&bytes);
    let options = gltf::LoadOptions::default();
    let loaded = gltf::load_bytes(&model.glb(), "model.glb", &options);
    rendered(&loaded.map_err(|e| e.to_string())?.description)
}

fn environment(image: ImageData) -> Result<(), String> {
    Environment::new(&EnvironmentDescription::Image {
        image: Arc::new(image),
        strength: 1.0,
        rotation: glam::Quat::IDENTITY,
    })
    .map(|_| ())
    .map_err(|e| e.to_string())
}

/// Compiles the scene and renders it; every pixel must be finite.
fn rendered(description: &kaustik::scene::Description) -> Result<(), String> {
    let options = SceneOptions {
        width: SIDE,
        height: SIDE,
        ..SceneOptions::default()
    };
    let scene = Scene::new(description, &options).map_err(|e| e.to_string())?;
    let settings = RenderSettings {
        method: Method::Path,
        width: SIDE,
        height: SIDE,
        budget: Budget::PerPixel(1),
        threads: 1,
        max_depth: 8,
        features: false,
        ..RenderSettings::default()
    };
    let rendered = render(&scene, &settings, &mut Control::default()).map_err(|e| e.to_string())?;
    for channel in rendered.image.rgb() {
        assert!(
            channel.iter().all(|value| value.is_finite()),
            "a pixel that is not finite"
        );
    }
    Ok(())
}
