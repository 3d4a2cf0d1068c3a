//! A first look at where implicit specular light that nothing else finds comes from.

use kaustik_path::Sighting;
use rayon::prelude::*;

use super::samples::{At, Samples, Scratch};

/// Scouts of a look in each cell.
const EACH: u64 = 16;
/// With fewer finds, their variance is not known well enough to go by.
const ENOUGH: u64 = 30;

/// What scouts saw that are used for nothing else, so that where one looks more closely does not depend on
/// what is found there.
pub(super) struct Look {
    /// For each cell the share of walks from the camera that a Dirac surface scatters first.
    dirac: Vec<f64>,
    /// Mean square of implicit specular light over the image, by stretches of paths: about what it adds to
    /// the second moment of a method's own samples. `None` where too few scouts met any.
    pub(super) second_moment: Option<f64>,
    /// Paths for each scout in the image that brought any.
    found: f64,
}

impl Look {
    /// `None` where all surfaces that are seen scatter otherwise.
    pub(super) fn new(samples: &Samples<'_>) -> Option<Self> {
        let cells = samples.grid.count();
        let look = |scratch: &mut Scratch, cell: usize| {
            let (mut dirac, mut finds, mut squares) = (0.0, 0, 0.0);
            for index in 0..EACH {
                let at = At {
                    step: cell as u64 * EACH + index,
                    pass: 0,
                    cell,
                    index,
                };
                let seen = samples.scout(at, scratch);
                dirac += f64::from(u8::from(seen.sighting >= Sighting::Specular));
                finds += seen.finds;
                squares += seen.square;
            }
            (dirac / EACH as f64, finds, squares)
        };
        let seen: Vec<(f64, u32, f64)> = (0..cells)
            .into_par_iter()
            .with_min_len(16)
            .map_init(Scratch::default, look)
            .collect();
        let found: u64 = seen.iter().map(|(_, finds, _)| u64::from(*finds)).sum();
        let squares: f64 = seen.iter().map(|(.., squares)| squares).sum();
        let sent = (cells as u64 * EACH) as f64;
        let dirac: Vec<f64> = seen.iter().map(|(dirac, ..)| *dirac).collect();
        dirac.iter().any(|share| *share > 0.0).then(|| Self {
            second_moment: (found >= ENOUGH).then_some(squares / sent),
            found: found as f64 / sent,
            dirac,
        })
    }

    /// How many walks from anywhere in the image know as much of what Dirac surfaces scatter first as so many
    /// in each cell.
    pub(super) fn equivalent_walks(&self, scouts: &[u64]) -> f64 {
        let shares = self.dirac.iter().sum::<f64>();
        let variances = self.dirac.iter().zip(scouts);
        let variances: f64 = variances
            .map(|(share, &scouts)| share / scouts as f64)
            .sum();
        self.dirac.len() as f64 * shares / variances
    }

    /// How many scouts go out in each cell in a pass, `each` in the mean: in proportion to how much
    /// of the cell shows Dirac surfaces. Counts are blurred over neighbours, since a few scouts know
    /// little of one cell; each has one at least, so that no light is left out. A find is evaluated,
    /// which costs much more than a look: fewer go out where more than `finds` a cell would be
    /// expected.
    pub(super) fn often(&self, samples: &Samples<'_>, each: u64, finds: u64) -> Vec<u64> {
        let shares = samples.grid.blurred(&self.dirac);
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        // of scouts that go where Dirac surfaces are
        let expected = each as f64 * self.found / mean;
        let each = each as f64 * (finds as f64 / expected).min(1.0);
        let often = |share: &f64| ((each * share / mean).round() as u64).max(1);
        shares.iter().map(often).collect()
    }
}
