//! The pilot of `photon-density` (Chen, Wang and Yong 2011).

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use kaustik_estimate::DensityTarget;
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::PhotonPath;
use kaustik_scene::Scene;
use rayon::prelude::*;

use super::stage::Stage;
use crate::RenderSettings;
use crate::sampling::streams;

/// Passes of uniform light paths.
const PASSES: u64 = 4;
/// Light paths a pass at most: nothing stops a pilot, and a map that is blurred over pixels has enough of these.
const MOST_PATHS: u64 = 1 << 18;
/// Or for each pixel, whose disc is nine times as large here: in a small picture each photon meets many.
const PATHS_A_PIXEL: u64 = 8;
/// But so many.
const LEAST_PATHS: u64 = 1 << 14;
/// So many times the radius.
const WIDER: f64 = 3.0;
/// Light paths that one thread traces at a time.
const CHUNK: u64 = 1024;

/// Counts photons in each pixel, an area.
pub(super) fn pilot(scene: &Scene, settings: &RenderSettings) -> DensityTarget {
    let mut settings = settings.clone();
    settings.options.photon.radius *= WIDER;
    let mut stage = Stage::new(scene, &settings);
    let window = settings.layout().crop;
    let (columns, rows) = (window.width() as usize, window.height() as usize);
    let counts: Vec<AtomicU64> = (0..columns * rows).map(|_| AtomicU64::new(0)).collect();
    let mut areas = vec![0.0; columns * rows];
    let generators = SampleGenerators::new(settings.seed, streams::DENSITY);
    let of_pixels = PATHS_A_PIXEL * settings.pixels();
    let paths = (stage.photons).min(of_pixels.clamp(LEAST_PATHS, MOST_PATHS));
    for pass in 0..PASSES {
        stage.begin(None);
        let map = stage.map();
        let points = map.points.points();
        let pixel = |index: usize| {
            let raster = points[index].raster;
            let at = |u: f64, whole: u32, first: u32, count: usize| {
                let from = u * f64::from(whole) - f64::from(first);
                (from.max(0.0) as usize).min(count - 1)
            };
            let row = at(raster.y, settings.height, window.y0, rows);
            row * columns + at(raster.x, settings.width, window.x0, columns)
        };
        for index in 0..points.len() {
            areas[pixel(index)] += map.points.area(index);
        }
        let chunk = |path: &mut PhotonPath, chunk: u64| {
            for number in chunk * CHUNK..((chunk + 1) * CHUNK).min(paths) {
                let mut u = Independent::new(generators.at(pass * paths + number));
                (stage.tracing).build(stage.scene(), stage.wavelengths(), &mut u, path);
                for photon in path.photons() {
                    map.meetings(photon, |index| {
                        counts[pixel(index)].fetch_add(1, Relaxed);
                    });
                }
            }
        };
        let chunks = (0..paths.div_ceil(CHUNK)).into_par_iter();
        chunks.for_each_init(PhotonPath::default, chunk);
    }
    let density = |(count, area): (&AtomicU64, &f64)| {
        if *area > 0.0 {
            count.load(Relaxed) as f64 / area
        } else {
            0.0
        }
    };
    let densities: Vec<f64> = counts.iter().zip(&areas).map(density).collect();
    let [low, sides] = super::window(&settings);
    DensityTarget::new(columns, rows, &densities).of_window(low, sides)
}
