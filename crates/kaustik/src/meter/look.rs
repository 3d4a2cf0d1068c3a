//! A first look at where implicit specular light comes from.

use kaustik_path::{Beginning, Sighting};
use rayon::prelude::*;

use super::samples::{At, Samples, Scratch};

/// Scouts of a look in each cell.
const EACH: u64 = 32;
/// Who has met light less often does not know how much it varies.
const ENOUGH: usize = 30;

/// What scouts saw that are used for nothing else, so that where one looks more closely does not depend on what is found
/// there.
pub(super) struct Look {
    /// For each cell the share of walks from the camera that a Dirac surface scatters first.
    dirac: Vec<f64>,
    /// Mean square of implicit specular light over the image, what it adds to the second moment of a method's own samples;
    /// `None` where too few scouts met any.
    pub(super) second_moment: Option<f64>,
    /// Share of scouts in the image that met any.
    found: f64,
}

impl Look {
    /// `None` where all surfaces that are seen scatter otherwise.
    pub(super) fn new(samples: &Samples<'_>) -> Option<Self> {
        let cells = samples.grid.count();
        let look = |scratch: &mut Scratch, cell: usize| {
            let (mut dirac, mut found) = (0.0, Vec::new());
            for index in 0..EACH {
                let at = At {
                    step: cell as u64 * EACH + index,
                    pass: 0,
                    cell,
                    index,
                };
                let (sighting, light) = samples.scout(at, Beginning::Dirac, scratch);
                dirac += f64::from(u8::from(sighting >= Sighting::Specular));
                found.extend(Some(light * light).filter(|square| *square > 0.0));
            }
            (dirac / EACH as f64, found)
        };
        let seen: Vec<(f64, Vec<f64>)> = (0..cells)
            .into_par_iter()
            .with_min_len(16)
            .map_init(Scratch::default, look)
            .collect();
        let found: Vec<f64> = seen.iter().flat_map(|(_, found)| found).copied().collect();
        let known = found.len() >= ENOUGH;
        let sent = (cells as u64 * EACH) as f64;
        let dirac: Vec<f64> = seen.iter().map(|(dirac, _)| *dirac).collect();
        dirac.iter().any(|share| *share > 0.0).then(|| Self {
            second_moment: known.then(|| found.iter().sum::<f64>() / sent),
            found: found.len() as f64 / sent,
            dirac,
        })
    }

    /// How many scouts go out in each cell in a pass, `each` in the mean: as many for all of the Dirac surfaces that are seen.
    /// Neighbours share, as few scouts know little of a cell; one at least, so that no light is left out. A find is evaluated, for
    /// much more than a look costs: fewer go out where more than `finds` a cell were to be expected.
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
