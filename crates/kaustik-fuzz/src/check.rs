//! The child: from one file to a verdict.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use kaustik::film::{self, Keep, Limits};
use kaustik::scene::description::{Description, EnvironmentDescription, ImageData, Pixels};
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
    let bytes = fs::read(file).map_err(|e| e.to_string())?;
    rendered(&loaded.description, also(&bytes))
}

/// The method by which this file is rendered besides, any of them.
fn also(bytes: &[u8]) -> Method {
    // FNV-1a: a few changed bytes are another method.
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix);
    Method::ALL[(hash >> 32) as usize % Method::ALL.len()]
}

/// The picture as the texture of a triangle.
fn textured(file: &Path) -> Result<(), String> {
    let bytes = fs::read(file).map_err(|e| e.to_string())?;
    let model = model::textured(&bytes);
    let options = gltf::LoadOptions::default();
    let loaded = gltf::load_bytes(&model.glb(), "model.glb", &options);
    let description = loaded.map_err(|e| e.to_string())?.description;
    rendered(&description, also(&bytes))
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

/// Compiles the scene and renders it, by path tracing and by another method; every pixel must be finite.
fn rendered(description: &Description, also: Method) -> Result<(), String> {
    let options = SceneOptions {
        width: SIDE,
        height: SIDE,
        ..SceneOptions::default()
    };
    let scene = Scene::new(description, &options).map_err(|e| e.to_string())?;
    for method in [Method::Path, also] {
        let image = render(&scene, &short(method), &mut Control::default());
        let image = image.map_err(|e| e.to_string())?.image;
        for channel in image.rgb() {
            assert!(
                channel.iter().all(|value| value.is_finite()),
                "a pixel that is not finite by {method}"
            );
        }
    }
    Ok(())
}

/// A sample or two a pixel, whatever a method begins with.
fn short(method: Method) -> RenderSettings {
    let mut settings = RenderSettings {
        method,
        width: SIDE,
        height: SIDE,
        budget: Budget::PerPixel(2),
        threads: 1,
        max_depth: 8,
        features: false,
        ..RenderSettings::default()
    };
    let options = &mut settings.options;
    (options.ladders, options.pilot, options.particles) = (2, 50, 20);
    options.length = 8;
    options.photon.photons = Some(50);
    settings
}
