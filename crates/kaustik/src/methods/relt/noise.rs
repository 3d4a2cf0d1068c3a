//! How noisy the picture of independent samples is, by parts of its light.
//!
//! Noise is the relative variance of a pixel for one sample in each, in the mean over the pixels. What it tells is whether a part of the
//! light is worth a replica of its own: to leave alone what is a small part of all noise costs nothing.

use kaustik_estimate::SpecularSplit;
use kaustik_mcmc::Mean;

use super::climb::effective;
use super::start::PoolSample;

/// Samples in a tile of the image, in the mean: fewer would not tell how they differ.
const IN_A_TILE: f64 = 64.0;
/// The most tiles along a side.
const MOST_TILES: f64 = 16.0;
/// With so many effective finds their light is known to a fifth.
const KNOWN: f64 = 25.0;

/// Light of samples, by tile of the image.
fn tiles(pool: &[PoolSample], light: impl Fn(&SpecularSplit) -> f64) -> Vec<Mean> {
    let side = (pool.len() as f64 / IN_A_TILE)
        .sqrt()
        .clamp(1.0, MOST_TILES) as usize;
    let mut tiles = vec![Mean::new(); side * side];
    for sample in pool {
        let [x, y] = (sample.raster).map(|at| ((at * side as f64) as usize).min(side - 1));
        tiles[y * side + x].push(light(&sample.light));
    }
    tiles
}

/// Share of the image where samples have met light, lamps seen directly aside: where an object stands before a sky, that of the object.
/// 1 where there is none. Samples outside tell nothing about how hard light is to find within.
pub(super) fn lit(pool: &[PoolSample]) -> f64 {
    let tiles = tiles(pool, |light| light.whole());
    let lit = tiles.iter().filter(|tile| tile.mean() > 0.0).count();
    match lit {
        0 => 1.0,
        lit => lit as f64 / tiles.len() as f64,
    }
}

/// Noise of all light but the implicit specular one, by independent samples that tell pixels apart by tiles alone: the mean over
/// the tiles where there is light of the samples' relative variance. 0 where there is none.
pub(super) fn of_samples(pool: &[PoolSample]) -> f64 {
    let tiles = tiles(pool, |light| light.other);
    let lit = tiles
        .iter()
        .filter(|tile| tile.count() > 1 && tile.mean() > 0.0);
    let noise: Mean = lit
        .map(|tile| tile.variance() / tile.mean().powi(2))
        .collect();
    noise.mean()
}

/// The same of implicit specular light, `share` of all, by what walks found of it, of so many in the [lit] part of the image; `None` if
/// these are too few to tell.
///
/// Where `r` of the samples are effective ones, their mean has the relative variance `1 / r` a sample. Of a part of the lit pixels alone
/// the light is a greater share of theirs, and more of the samples that fall there are effective; with pixels alike otherwise
/// the mean over all of them is the same.
pub(super) fn of_finds(finds: &[f64], sent: f64, share: f64) -> Option<f64> {
    let found = effective(finds.iter().copied());
    (found >= KNOWN).then(|| share * share * sent / found)
}

#[cfg(test)]
mod tests {
    use kaustik_mcmc::{Draws, generator};

    use super::*;

    /// Samples of a picture whose left half is as bright as given, and whose right half is black; one sample in `rare` has
    /// all of its light.
    fn pool(brightness: f64, rare: f64) -> Vec<PoolSample> {
        let mut draws = generator(3, 0);
        let sample = |_| {
            let raster = [draws.uniform(), draws.uniform()];
            let lit = raster[0] < 0.5 && draws.uniform() * rare < 1.0;
            PoolSample {
                densities: Default::default(),
                light: SpecularSplit {
                    specular: 0.0,
                    other: if lit { brightness * rare } else { 0.0 },
                },
                raster,
            }
        };
        (0..20_000).map(sample).collect()
    }

    /// Dark halves do not count, nor does brightness; what one sample in ten knows has a variance of nine.
    #[test]
    fn noise_is_that_within_tiles() {
        for brightness in [1e-3, 5.0] {
            assert!(of_samples(&pool(brightness, 1.0)) < 1e-9);
            let noise = of_samples(&pool(brightness, 10.0));
            // rather too large, as a tile of these has eight finds
            assert!((9.0..13.0).contains(&noise), "{noise}");
        }
        assert!(of_samples(&pool(0.0, 1.0)) <= 0.0);
        assert!(of_samples(&[]) <= 0.0);
    }

    /// Half of the image, however rare what lights it is; all of it where nothing is known.
    #[test]
    fn dark_parts_are_told_from_lit_ones() {
        for rare in [1.0, 10.0] {
            let share = lit(&pool(1.0, rare));
            assert!((share - 0.5).abs() < 0.05, "{share}");
        }
        assert!(lit(&pool(0.0, 1.0)) >= 1.0);
        assert!(lit(&[]) >= 1.0);
    }

    /// A part that is a fifth of the light, and that one walk in a thousand finds.
    #[test]
    fn rare_light_is_noise() {
        let noise = of_finds(&[2.0; 100], 1e5, 0.2).expect("enough");
        assert!((noise - 0.04 * 1000.0).abs() < 1e-9, "{noise}");
        assert_eq!(of_finds(&[2.0; 24], 1e5, 0.2), None);
        let mut uneven = vec![1.0; 100];
        uneven[0] = 1e6;
        assert_eq!(of_finds(&uneven, 1e5, 0.2), None);
        assert_eq!(of_finds(&[], 0.0, 0.2), None);
    }
}
