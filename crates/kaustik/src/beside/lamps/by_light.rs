//! Emitters that fill a small part of a pixel, found from their own side.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{
    BuilderSettings, Contributions, LightTracing, PathBuilder, PureSpecular, Splat,
};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::sampling::cells::Cells;

/// Samples of the first look that are summed one after the other, so that the sum has the same bits for any
/// number of threads.
const CHUNK: u64 = 4096;

/// Points of emitters joined to the lens: strategy (1, 1).
///
/// A camera ray meets a lamp as often as the lamp fills the pixel; a point of the lamp is always seen, if
/// nothing is in between. Each cell of the image shows emitters in one of the two ways alone, which a first look decides.
pub(super) struct ByLight {
    builder: LightTracing,
    cells: Cells,
    generators: SampleGenerators,
    /// The cells that show emitters so; empty if there are none.
    theirs: Vec<bool>,
}

/// What a first look has found.
pub(super) struct Found {
    /// Samples that were seen in each cell, of as many as there are cells.
    pub(super) often: Vec<u32>,
    /// Mean of X + Y + Z.
    pub(super) mean: f64,
}

impl ByLight {
    /// Has no cells yet. Where emitters seen directly are not wanted ([`BuilderSettings::min_edges`]) it finds none.
    pub(super) fn new(
        settings: BuilderSettings,
        cells: Cells,
        generators: SampleGenerators,
    ) -> Self {
        let settings = BuilderSettings {
            max_edges: 1,
            pure_specular: PureSpecular::Kept,
            ..settings
        };
        Self {
            builder: LightTracing { settings },
            cells,
            generators,
            theirs: Vec::new(),
        }
    }

    /// Samples of a pass.
    pub(super) fn each(&self) -> u64 {
        if self.theirs.is_empty() {
            0
        } else {
            self.cells.count()
        }
    }

    /// Does this cell show emitters so?
    #[inline]
    pub(super) fn has(&self, cell: u64) -> bool {
        self.theirs.get(cell as usize).is_some_and(|&theirs| theirs)
    }

    /// Gives it the cells that are to show emitters so, in place of others.
    pub(super) fn take(&mut self, theirs: Vec<bool>) {
        let some = theirs.contains(&true);
        self.theirs = if some { theirs } else { Vec::new() };
    }

    /// Where samples of emitters are seen; the first has this number.
    pub(super) fn look(&self, scene: &Scene, first: u64) -> Found {
        let often: Vec<AtomicU32> = (0..self.cells.count()).map(|_| AtomicU32::new(0)).collect();
        let count = self.cells.count();
        let sum_of = |value: &mut Contributions, chunk: u64| {
            let samples = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            let light = samples.map(|i| {
                self.build(scene, first + i, value);
                let seen = value.splats().iter().filter(|splat| splat.xyz.sum() > 0.0);
                seen.map(|splat| {
                    often[self.cell(splat) as usize].fetch_add(1, Relaxed);
                    f64::from(splat.xyz.sum())
                })
                .sum::<f64>()
            });
            light.sum()
        };
        let sums: Vec<f64> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map_init(Contributions::default, sum_of)
            .collect();
        Found {
            often: often.into_iter().map(AtomicU32::into_inner).collect(),
            mean: sums.iter().sum::<f64>() / count as f64,
        }
    }

    /// The sample of this number.
    pub(super) fn build(&self, scene: &Scene, number: u64, value: &mut Contributions) {
        let mut coordinates = Independent::new(self.generators.at(number));
        self.builder.build(scene, &mut coordinates, value);
    }

    /// What of a sample counts: it makes one splat at most.
    pub(super) fn counts(&self, value: &Contributions) -> bool {
        let mut splats = value.splats().iter();
        splats.all(|splat| self.has(self.cell(splat)))
    }

    /// The cell in which a splat lies.
    fn cell(&self, splat: &Splat) -> u64 {
        self.cells.at(self.builder.settings.window(splat.raster))
    }
}
