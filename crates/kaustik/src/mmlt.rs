//! Multiplexed Metropolis light transport (Hachisuka, Kaplanyan and Dachsbacher 2014):
//! a chain of [`PssmltEngine`](crate::pssmlt::PssmltEngine) over [`Multiplexed`] paths.

use kaustik_estimate::ScalarContribution;
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{Bidirectional, Contributions, Form, Multiplexed, TechniqueShares, Techniques};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::render::builder_settings;
use crate::streams;
use crate::{RenderError, RenderSettings, Strategies};

/// The probabilities need to be no better than roughly right.
const MOST_SAMPLES: u64 = 200_000;

/// The builder, with probabilities by the light that its own samples saw.
pub(crate) fn builder(
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<Multiplexed, RenderError> {
    if settings.max_depth > Techniques::MOST_EDGES {
        return Err(RenderError::Setting {
            what: "max-depth",
            found: settings.max_depth.to_string(),
            expected: format!("at most {} for {}", Techniques::MOST_EDGES, settings.method),
        });
    }
    let paths = Bidirectional {
        settings: builder_settings(settings),
        form: Form::Full,
        heuristic: settings.options.heuristic,
    };
    let lens = scene.camera().has_aperture();
    let even = Techniques::even(paths.settings.min_edges, settings.max_depth, lens);
    let first = Multiplexed::new(paths, even);
    let shares = shares(scene, &first, settings);
    let strategies = settings.options.strategies == Strategies::Learned;
    let learned = first.techniques().learned(&shares, strategies);
    Ok(Multiplexed::new(paths, learned))
}

/// The light that each strategy brings, summed in the order of the samples.
fn shares(scene: &Scene, builder: &Multiplexed, settings: &RenderSettings) -> TechniqueShares {
    let family = ScalarContribution {
        target: settings.options.target,
        ..ScalarContribution::default()
    };
    let generators = SampleGenerators::new(settings.seed, streams::TECHNIQUES);
    let seen: Vec<Option<(u32, u32, f64)>> = (0..settings.options.pilot.min(MOST_SAMPLES) as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(Contributions::default, |value, index| {
            let mut u = Independent::new(generators.at(index as u64));
            let technique = builder.techniques().draw(&mut u)?;
            builder.build_one(scene, technique, &mut u, value);
            let light = family.of(value);
            (light > 0.0).then_some((technique.s, technique.t, light))
        })
        .collect();
    let mut shares = TechniqueShares::default();
    for (s, t, light) in seen.into_iter().flatten() {
        shares.add(s, t, light);
    }
    shares
}
