//! Pictures of what chains follow and of how often they come: G figures 2 to 4.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use kaustik_estimate::TOUCH;
use kaustik_film::{Layer, Window};
use kaustik_path::MeasurementPoint;

use super::stage::Stage;
use super::targets::Targets;
use crate::RenderSettings;

/// Counts at the points of an iteration, gathered by pixel.
pub(super) struct Maps {
    size: [u32; 2],
    crop: Window,
    /// Of each point of the iteration.
    touches: Vec<AtomicU64>,
    /// Of each pixel, over iterations: visits of paths that touched a point, and points.
    sums: Vec<[f64; 2]>,
}

impl Maps {
    pub(super) fn new(settings: &RenderSettings) -> Self {
        let layout = settings.layout();
        Self {
            size: [layout.width, layout.height],
            crop: layout.crop,
            touches: Vec::new(),
            sums: vec![[0.0; 2]; layout.crop.area() as usize],
        }
    }

    /// For the points that the stage has made.
    pub(super) fn begin(&mut self, stage: &Stage<'_>) {
        self.touches.clear();
        let points = stage.map().points.points().len();
        self.touches.resize_with(points, AtomicU64::default);
    }

    pub(super) fn touches(&self) -> &[AtomicU64] {
        &self.touches
    }

    /// Gathers what the iteration has counted.
    pub(super) fn end(&mut self, stage: &Stage<'_>) {
        for (point, touches) in stage.map().points.points().iter().zip(&self.touches) {
            if let Some(pixel) = self.pixel(point) {
                let count = touches.load(Relaxed) as f64 / TOUCH as f64;
                let [visits, points] = self.sums[pixel];
                self.sums[pixel] = [visits + count, points + 1.0];
            }
        }
    }

    /// What is to be kept of it between two iterations.
    pub(super) fn sums(&self) -> &[[f64; 2]] {
        &self.sums
    }

    pub(super) fn sums_mut(&mut self) -> &mut [[f64; 2]] {
        &mut self.sums
    }

    /// The pixel that a point was made for, if it is shown.
    fn pixel(&self, point: &MeasurementPoint) -> Option<usize> {
        let [width, height] = self.size;
        let x = (point.raster.x * f64::from(width)).floor();
        let y = (point.raster.y * f64::from(height)).floor();
        if x < 0.0 || y < 0.0 {
            return None;
        }
        let (x, y, crop) = (x as u32, y as u32, self.crop);
        let inside = (crop.x0..crop.x1).contains(&x) && (crop.y0..crop.y1).contains(&y);
        inside.then(|| ((y - crop.y0) * crop.width() + x - crop.x0) as usize)
    }

    /// `target`: the full target of the last iteration's points and its two factors, means a pixel, and the
    /// number of the region in the cut. `contributions`: visits that touched a point, an iteration and point.
    pub(super) fn layers<const K: usize>(
        &self,
        stage: &Stage<'_>,
        targets: &Targets<K>,
    ) -> Vec<Layer> {
        let mut layers = Vec::new();
        let of_points = targets.of_points();
        if !of_points.is_empty() {
            let mut sums = vec![[0.0_f64; 3]; self.sums.len()];
            let mut regions = vec![0.0_f32; self.sums.len()];
            let points = stage.map().points;
            let both = points.discs().iter().zip(points.points());
            for ((disc, point), [kernel, full]) in both.zip(of_points) {
                let Some(pixel) = self.pixel(point) else {
                    continue;
                };
                let [a, b, c] = sums[pixel];
                sums[pixel] = [a + f64::from(*full), b + f64::from(*kernel), c + 1.0];
                regions[pixel] = targets
                    .region(disc, point)
                    .map_or(0.0, |region| region as f32);
            }
            let share = |a: f64, b: f64| if b > 0.0 { (a / b) as f32 } else { 0.0 };
            let plane = |of: fn(&[f64; 3]) -> [f64; 2]| {
                let values = sums.iter().map(of);
                values.map(|[a, b]| share(a, b)).collect::<Vec<f32>>()
            };
            layers.push(Layer::new(
                "target",
                vec![
                    ("full", plane(|s| [s[0], s[2]])),
                    ("kernel", plane(|s| [s[1], s[2]])),
                    ("density", plane(|s| [s[0], s[1]])),
                    ("region", regions),
                ],
            ));
        }
        let touched = self.sums.iter().map(|[visits, points]| {
            let mean = visits / points.max(1.0);
            mean as f32
        });
        layers.push(Layer::new("contributions", vec![("Y", touched.collect())]));
        layers
    }
}
