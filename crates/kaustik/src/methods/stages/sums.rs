//! Pictures of stages, added up.

use std::io;

use kaustik_estimate::{RasterMap, ScalarTarget};
use kaustik_film::{Image, ImageError, Layout};
use kaustik_spectrum::{Rgb, Xyz};

use super::plan::Stage;
use crate::state::{Reader, StateError, Writer};

/// Linear RGB of each pixel, times mutations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sums {
    planes: [Vec<f64>; 3],
    mutations: u64,
}

impl Sums {
    /// Of no stage.
    pub(super) fn black(layout: &Layout) -> Self {
        let pixels = layout.crop.area() as usize;
        Self {
            planes: [(); 3].map(|()| vec![0.0; pixels]),
            mutations: 0,
        }
    }

    /// With a picture of so many mutations.
    pub(super) fn with(&self, image: &Image, mutations: u64) -> Self {
        let planes = self.planes.iter().zip(image.rgb());
        let weight = mutations as f64;
        let mut sums = planes.map(|(sums, plane)| {
            let plane = plane.iter().map(|v| f64::from(*v) * weight);
            sums.iter().zip(plane).map(|(a, b)| a + b).collect()
        });
        Self {
            planes: std::array::from_fn(|_| sums.next().unwrap_or_default()),
            mutations: self.mutations + mutations,
        }
    }

    /// The mean picture, in the place of the layout's window.
    pub(super) fn image(&self, layout: &Layout) -> Result<Image, ImageError> {
        let crop = layout.crop;
        let scale = 1.0 / self.mutations.max(1) as f64;
        let planes = [0, 1, 2].map(|channel| {
            let sums: &Vec<f64> = &self.planes[channel];
            sums.iter().map(|sum| (sum * scale) as f32).collect()
        });
        let image = Image::from_rgb(crop.width(), crop.height(), planes)?;
        let origin = [crop.x0 as i32, crop.y0 as i32];
        Ok(image.placed(origin, [layout.width, layout.height]))
    }

    /// The weights that a stage goes by after these; 1 everywhere before any.
    pub(super) fn map(
        &self,
        layout: &Layout,
        stage: Stage,
        target: ScalarTarget,
        floor: f64,
    ) -> RasterMap {
        if self.mutations == 0 {
            return RasterMap::even();
        }
        let scale = 1.0 / self.mutations as f64;
        let scalar = |pixel| {
            let rgb: [f32; 3] = std::array::from_fn(|c| (self.planes[c][pixel] * scale) as f32);
            target.of(Xyz::from(Rgb(rgb)))
        };
        let pixels = self.planes[0].len();
        let scalars: Vec<f64> = (0..pixels).map(scalar).collect();
        RasterMap::evening(layout, &scalars, stage.width, floor)
    }

    pub(super) fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        self.planes
            .iter()
            .try_for_each(|plane| out.numbers(plane.iter()))
    }

    /// What was written, of so many mutations.
    pub(super) fn read(
        layout: &Layout,
        mutations: u64,
        from: &mut Reader<'_>,
    ) -> Result<Self, StateError> {
        let mut sums = Self::black(layout);
        for plane in &mut sums.planes {
            from.numbers(plane)?;
            if plane.iter().any(|sum| !sum.is_finite()) {
                return Err(StateError::damaged("a sum of pictures is not finite"));
            }
        }
        sums.mutations = mutations;
        Ok(sums)
    }
}
