//! What is seen first, as layers: albedo, normal, depth.

use std::time::{Duration, Instant};

use kaustik_film::Layer;
use kaustik_path::{Features, features};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::RenderSettings;

/// Samples a pixel along each axis.
const GRID: u32 = 2;

/// The layers `albedo` (linear Rec.709), `normal` (world, averaged), `depth` (distance from the
/// lens; 0 where nothing is seen). `None` if they take longer than there is `patience`.
pub(crate) fn layers(
    scene: &Scene,
    settings: &RenderSettings,
    patience: Duration,
) -> Option<Vec<Layer>> {
    let start = Instant::now();
    let crop = settings.layout().crop;
    let (width, height) = (crop.width() as usize, crop.height() as usize);
    let mut planes: [Vec<f32>; 7] = std::array::from_fn(|_| vec![0.0; width * height]);
    let rows: Option<Vec<[Vec<f32>; 7]>> = (crop.y0..crop.y1)
        .into_par_iter()
        .map(|y| {
            let in_time = start.elapsed() <= patience;
            in_time.then(|| row(scene, settings, y, crop.x0..crop.x1))
        })
        .collect();
    for (y, row) in rows?.iter().enumerate() {
        for (plane, values) in planes.iter_mut().zip(row) {
            plane[y * width..(y + 1) * width].copy_from_slice(values);
        }
    }
    let [r, g, b, x, y, z, depth] = planes;
    Some(vec![
        Layer::new("albedo", vec![("R", r), ("G", g), ("B", b)]),
        Layer::new("normal", vec![("X", x), ("Y", y), ("Z", z)]),
        Layer::new("depth", vec![("Z", depth)]),
    ])
}

fn row(
    scene: &Scene,
    settings: &RenderSettings,
    y: u32,
    columns: std::ops::Range<u32>,
) -> [Vec<f32>; 7] {
    let mut planes: [Vec<f32>; 7] = Default::default();
    for x in columns {
        let mut sum = [0.0_f32; 7];
        for sample in 0..GRID * GRID {
            let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(GRID);
            let raster = glam::DVec2::new(
                (f64::from(x) + offset(sample % GRID)) / f64::from(settings.width),
                (f64::from(y) + offset(sample / GRID)) / f64::from(settings.height),
            );
            let wavelength = offset(sample % GRID) * 0.25 + f64::from(sample / GRID) * 0.0625;
            let Features {
                albedo,
                normal,
                depth,
                ..
            } = features(scene, raster, wavelength);
            let values = [
                albedo[0], albedo[1], albedo[2], normal.x, normal.y, normal.z, depth,
            ];
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += value;
            }
        }
        for (plane, sum) in planes.iter_mut().zip(sum) {
            plane.push(sum / (GRID * GRID) as f32);
        }
    }
    planes
}
