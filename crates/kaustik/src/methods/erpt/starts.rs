//! Where chains start.

use glam::DVec2;
use kaustik_mcmc::{Draws, SampleGenerators};
use kaustik_mutate::{Path, PathSpace, Seeds, Tracer};
use rayon::prelude::*;

use super::perturbations::Perturbations;
use crate::sampling::streams;
use crate::{Options, RenderSettings, Starts};

/// Makes the starts of samples; holds their memory.
pub(crate) struct Starter<'a> {
    space: &'a PathSpace<'a>,
    next_event: bool,
    tracer: Tracer,
    seeds: Option<Seeds<'a>>,
    path: Path,
}

impl<'a> Starter<'a> {
    pub(crate) fn new(space: &'a PathSpace<'a>, options: &Options) -> Self {
        Self {
            space,
            next_event: options.next_event,
            tracer: Tracer::new(),
            seeds: (options.seeds == Starts::Bidirectional).then(|| Seeds::new(space)),
            path: Path::default(),
        }
    }

    /// A sample at a point of the window (its unit square) and of the wavelengths, which walks from
    /// both sides choose for themselves. Tells `found` of its paths and their weights.
    pub(crate) fn sample<D: Draws>(
        &mut self,
        (at, wavelength_u): (DVec2, f64),
        draws: &mut D,
        found: &mut impl FnMut(&Path, f64),
    ) {
        let settings = &self.space.settings;
        match &mut self.seeds {
            None => {
                let start = (settings.raster(at), wavelength_u);
                (self.tracer).sample(self.space, start, self.next_event, draws, found);
            }
            Some(seeds) => {
                let weight = seeds.sample(&mut self.path, draws);
                // A weight that is no number comes without a path, and is to be counted.
                if weight > 0.0 || !weight.is_finite() {
                    found(&self.path, weight);
                }
            }
        }
    }
}

/// Light of the samples of a pilot: what is spread, and all.
pub(crate) fn pilot(
    space: &PathSpace<'_>,
    perturbations: &Perturbations<'_>,
    settings: &RenderSettings,
) -> Vec<[f64; 2]> {
    let options = &settings.options;
    let generators = SampleGenerators::new(settings.seed, streams::PILOT);
    let sample = |starter: &mut Starter<'_>, index: usize| {
        let mut draws = generators.at(index as u64);
        let at = DVec2::new(draws.uniform(), draws.uniform());
        let wavelength_u = draws.uniform();
        let mut light = [0.0; 2];
        starter.sample((at, wavelength_u), &mut draws, &mut |path, weight| {
            if weight.is_finite() {
                light[1] += weight;
                if perturbations.suit(path) {
                    light[0] += weight;
                }
            }
        });
        light
    };
    (0..settings.pilot() as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(|| Starter::new(space, options), sample)
        .collect()
}
