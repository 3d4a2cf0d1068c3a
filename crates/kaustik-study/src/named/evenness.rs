//! How evenly errors lie over a picture.

use kaustik::film::Image;

use super::checks::{method, scene};
use crate::chart::number;
use crate::parts::luminances;
use crate::{Finding, Results};

/// Pixels of a tile's side.
const TILE: usize = 8;
/// Of a tile's light, the share that may have come otherwise than by photons.
const MOST_REMAINDER: f64 = 0.01;

/// The 95th over the 5th percentile over tiles of the relative error of `better`, `|x - r| / r` in the mean
/// over a tile's pixels and the seeds (the error map of Gruson et al. 2016), is at most `factor` times that of `worse`.
///
/// Tiles in which more than a hundredth of the light does not come from photons (layer `remainder` of either)
/// are left out: that light is as noisy with every method.
pub(super) fn evener(
    results: &Results,
    place: &str,
    better: &str,
    worse: &str,
    factor: f64,
) -> Finding {
    let Some(scene) = scene(results, place) else {
        return Finding::open("not rendered");
    };
    let shown = |name: &str| {
        let mut shown = scene.shown.iter();
        shown.find(|s| Some(s.method) == method(results, name))
    };
    let (Some(ours), Some(theirs)) = (shown(better), shown(worse)) else {
        return Finding::open("not rendered");
    };
    let reference = &scene.reference.image;
    let counts: Vec<bool> = is_of_photons(&ours.image)
        .into_iter()
        .zip(is_of_photons(&theirs.image))
        .map(|(a, b)| a && b)
        .collect();
    let spread = |errors: &[f32]| spread(&tile_errors(errors, reference, &counts));
    match (spread(&ours.error), spread(&theirs.error)) {
        (Some(ours), Some(theirs)) => Finding::new(
            format!(
                "{place}, 95th over 5th percentile of tiles: {better} {}, {worse} {} (ratio {:.2})",
                number(ours),
                number(theirs),
                ours / theirs
            ),
            ours <= factor * theirs,
        ),
        _ => Finding::open("no tile to measure"),
    }
}

/// The tile of each pixel, and how many there are.
fn tiles(image: &Image) -> (impl Iterator<Item = usize> + use<>, usize) {
    let (width, pixels) = (image.width() as usize, image.pixels());
    let across = width.div_ceil(TILE);
    let of = move |pixel| pixel / width / TILE * across + pixel % width / TILE;
    (
        (0..pixels).map(of),
        across * (image.height() as usize).div_ceil(TILE),
    )
}

/// Of each tile: is nearly all of its light photons'?
fn is_of_photons(image: &Image) -> Vec<bool> {
    let (tile, count) = tiles(image);
    let mut sums = vec![[0.0_f64; 2]; count];
    let all = luminances(image.rgb());
    let channel = |name| image.layer("remainder")?.channel(name);
    let rest = match [channel("R"), channel("G"), channel("B")] {
        [Some(r), Some(g), Some(b)] => luminances([r, g, b]),
        _ => vec![0.0; all.len()],
    };
    for (tile, (all, rest)) in tile.zip(all.iter().zip(&rest)) {
        sums[tile] = [sums[tile][0] + all, sums[tile][1] + rest];
    }
    let is = |[all, rest]: &[f64; 2]| *rest <= MOST_REMAINDER * all;
    sums.iter().map(is).collect()
}

/// The mean error over the lit pixels of each tile that counts.
fn tile_errors(errors: &[f32], reference: &Image, counts: &[bool]) -> Vec<f64> {
    let (tile, count) = tiles(reference);
    let mut sums = vec![(0.0, 0.0); count];
    for (tile, (error, r)) in tile.zip(errors.iter().zip(luminances(reference.rgb()))) {
        if r > 0.0 && error.is_finite() {
            sums[tile] = (sums[tile].0 + f64::from(*error), sums[tile].1 + 1.0);
        }
    }
    let known = sums.iter().zip(counts);
    let known = known.filter(|((_, lit), counts)| **counts && *lit > 0.0);
    known.map(|((sum, lit), _)| sum / lit).collect()
}

/// The 95th over the 5th percentile.
fn spread(errors: &[f64]) -> Option<f64> {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |q: f64| sorted.get((q * sorted.len() as f64) as usize).copied();
    Some(at(0.95)? / at(0.05)?).filter(|ratio| ratio.is_finite())
}

#[cfg(test)]
mod tests {
    use kaustik::film::Layer;

    use super::*;

    fn grey(values: impl Fn(usize) -> f32) -> Image {
        let plane: Vec<f32> = (0..16 * 16).map(values).collect();
        Image::from_rgb(16, 16, [plane.clone(), plane.clone(), plane]).expect("an image")
    }

    /// Four tiles: errors of 10, 20, 30 and 40 %; the last is a mirror's and does not count. A black row has no error.
    #[test]
    fn errors_are_relative_and_of_photons() {
        let at = |pixel: usize| pixel / 16 / 8 * 2 + pixel % 16 / 8;
        let reference = grey(|pixel| {
            if pixel < 16 {
                0.0
            } else {
                1.0 + at(pixel) as f32
            }
        });
        let errors: Vec<f32> = (0..256)
            .map(|pixel| 0.1 * (1.0 + at(pixel) as f32))
            .collect();
        let mut image = grey(|pixel| 1.0 + at(pixel) as f32);
        let rest: Vec<f32> = (0..256)
            .map(|p| if at(p) == 3 { 1.0 } else { 0.0 })
            .collect();
        let channels = vec![("R", rest.clone()), ("G", rest.clone()), ("B", rest)];
        image
            .push_layer(Layer::new("remainder", channels))
            .expect("a layer");
        let counts = is_of_photons(&image);
        assert_eq!(counts, [true, true, true, false]);
        let errors = tile_errors(&errors, &reference, &counts);
        for (found, wanted) in errors.iter().zip([0.1, 0.2, 0.3]) {
            assert!((found - wanted).abs() < 1e-5, "{errors:?}");
        }
        assert!((spread(&errors).expect("a ratio") - 3.0).abs() < 1e-4);
        assert_eq!(spread(&[]), None);
    }
}
