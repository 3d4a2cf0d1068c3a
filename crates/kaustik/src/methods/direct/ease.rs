//! Is direct light easy to find for independent samples?

use kaustik_mcmc::{Independent, Mean, SampleGenerators};
use kaustik_path::{Contributions, PathBuilder};
use kaustik_scene::Scene;
use rayon::prelude::*;

use super::{MOST_EDGES, can_be_apart, direct_paths};
use crate::sampling::cells::Cells;
use crate::sampling::stratified::mix;
use crate::sampling::streams;
use crate::{Direct, Method, RenderSettings};

/// Samples a pixel of the look.
const SAMPLES: u64 = 4;
/// About so many pixels are looked at, evenly.
const PIXELS: u64 = 8192;
/// Pixels in a tile, in the mean: fewer would not tell how bright it is.
const IN_A_TILE: f64 = 32.0;
/// Where the relative variance of a sample is at most this, samples of its own show direct light better than chains do. (Measured: 1 to 8 on
/// scenes that gain, 80 to 110 in rooms that are lit through openings, which lose.)
const EASY: f64 = 16.0;
/// Less than this share of the image is not worth the time.
const LIT: f64 = 0.125;
/// The look's own seed: all shares of a render decide alike, whatever seeds they have.
const SEED: u64 = 0x0D1E_C70F_EA5E;

/// Which light is rendered beside the chains where that is left open ([`Direct::Auto`]). Costs some hundredths of a second.
pub(crate) fn choice(scene: &Scene, settings: &RenderSettings) -> Direct {
    // The even samples of `relt` do the same.
    let chains = can_be_apart(settings.method) && settings.method != Method::Relt;
    // Of no more edges nothing is left to chains.
    if !chains || settings.max_depth <= MOST_EDGES || shows_other_light(scene, settings) {
        return Direct::Lamps;
    }
    let Ease { noise, lit } = Ease::look(scene, settings);
    if noise <= EASY && lit >= LIT {
        Direct::Apart
    } else {
        Direct::Lamps
    }
}

/// Would chains show other light of two edges than the samples in their place? Those see no point light in a mirror, which walks from the
/// light join to a lens that has area; and walks that are never joined to an emitter see no point light at all.
fn shows_other_light(scene: &Scene, settings: &RenderSettings) -> bool {
    scene.has_punctual_lights() && (scene.camera().has_aperture() || !settings.options.next_event)
}

/// What a look at direct light tells.
struct Ease {
    /// The relative variance of samples within pixels, in the mean over the tiles of the image that have some light.
    noise: f64,
    /// Share of these tiles.
    lit: f64,
}

/// Samples of one pixel, X + Y + Z.
struct Pixel {
    cell: u64,
    mean: f64,
    variance: f64,
}

impl Ease {
    fn look(scene: &Scene, settings: &RenderSettings) -> Self {
        let cells = Cells::new(settings);
        let seen = pixels(scene, settings, &cells);
        let side = (seen.len() as f64 / IN_A_TILE).sqrt().max(1.0) as u64;
        let mut tiles = vec![(Mean::new(), Mean::new()); (side * side) as usize];
        for pixel in seen {
            let (x, y) = (pixel.cell % cells.columns(), pixel.cell / cells.columns());
            let tile = y * side / cells.rows() * side + x * side / cells.columns();
            let (light, variance) = &mut tiles[tile as usize];
            light.push(pixel.mean);
            variance.push(pixel.variance);
        }
        let lit = tiles.iter().filter(|(light, _)| light.mean() > 0.0);
        let noise: Mean = lit
            .map(|(light, variance)| variance.mean() / light.mean().powi(2))
            .collect();
        Self {
            noise: noise.mean(),
            lit: noise.count() as f64 / tiles.len() as f64,
        }
    }
}

/// A few samples in each of some pixels, one in so many.
fn pixels(scene: &Scene, settings: &RenderSettings, cells: &Cells) -> Vec<Pixel> {
    let paths = direct_paths(settings);
    let generators = SampleGenerators::new(SEED, streams::DIRECT_LOOK);
    let stride = cells.count().div_ceil(PIXELS).max(1);
    let look = |value: &mut Contributions, number: u64| {
        // Any of those that it stands for: a fixed one would be a pattern.
        let cell = (number * stride + mix(number) % stride) % cells.count();
        let light = (0..SAMPLES).map(|index| {
            let inner = Independent::new(generators.at(number * SAMPLES + index));
            let mut u = cells.confine((cell, index), mix(SEED), inner);
            paths.build(scene, &mut u, value);
            value.splats().iter().map(|s| f64::from(s.xyz.sum())).sum()
        });
        let light: Mean = light.collect();
        Pixel {
            cell,
            mean: light.mean(),
            variance: light.variance(),
        }
    };
    let numbers = 0..cells.count().div_ceil(stride) as usize;
    (numbers.into_par_iter().with_min_len(256))
        .map_init(Contributions::default, |value, number| {
            look(value, number as u64)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use kaustik_scene::builtin;
    use kaustik_scene::description::{Description, Lens, LightDescription, LightKind};

    use super::*;
    use crate::methods::settled::settled;

    fn decides(words: &str, method: Method, max_depth: u32, seed: u64) -> Direct {
        let description = builtin::load(words).expect("a scene");
        decides_of(&description, method, max_depth, seed)
    }

    fn decides_of(description: &Description, method: Method, max_depth: u32, seed: u64) -> Direct {
        let mut settings = RenderSettings {
            method,
            width: 64,
            height: 48,
            max_depth,
            seed,
            ..RenderSettings::default()
        };
        let scene = Scene::new(description, &settings.scene_options()).expect("a scene");
        let decided = settled(&scene, &settings, None).options.direct;
        // What is said is done.
        for direct in [Direct::Lamps, Direct::Together, Direct::Apart] {
            settings.options.direct = direct;
            assert_eq!(settled(&scene, &settings, None).options.direct, direct);
        }
        decided
    }

    /// Lamps in a box are met by every second shadow ray; a room behind a door, or water between eye and sun, is another thing. No seed
    /// changes that: shares of a render go one way.
    #[test]
    fn samples_take_the_light_that_they_find_easily() {
        for seed in 0..3 {
            assert_eq!(decides("cornell", Method::Mlt, 16, seed), Direct::Apart);
            assert_eq!(decides("dinner-hall", Method::Mlt, 16, seed), Direct::Lamps);
        }
        assert_eq!(decides("canyon", Method::Erpt, 16, 0), Direct::Apart);
        assert_eq!(decides("cornell", Method::ErptPss, 16, 0), Direct::Apart);
        assert_eq!(decides("underwater", Method::Mmlt, 16, 0), Direct::Lamps);
        // nothing would be left to chains
        assert_eq!(decides("cornell", Method::Pssmlt, 2, 0), Direct::Lamps);
        // whose even samples do the same
        assert_eq!(decides("cornell", Method::Relt, 16, 0), Direct::Lamps);
    }

    /// A point light in a mirror shows itself to a lens that has area by walks from the light alone, which only chains make.
    #[test]
    fn what_only_chains_show_is_left_to_them() {
        let mut description = builtin::load("cornell").expect("a scene");
        description.lights.push(LightDescription {
            name: "a point".to_owned(),
            kind: LightKind::Point,
            color: [1.0; 3],
            intensity: 0.1,
            range: None,
            transform: Affine3A::from_translation(Vec3::new(0.0, 0.5, 0.0)),
        });
        assert_eq!(decides_of(&description, Method::Mmlt, 16, 0), Direct::Apart);
        description.cameras[0].lens = Some(Lens {
            aperture: 0.05,
            focus: 3.0,
            blades: None,
        });
        assert_eq!(decides_of(&description, Method::Mmlt, 16, 0), Direct::Lamps);
        description.lights.clear();
        assert_eq!(decides_of(&description, Method::Mmlt, 16, 0), Direct::Apart);
    }
}
