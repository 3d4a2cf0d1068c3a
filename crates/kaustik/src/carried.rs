//! What rounding has left over of chains, cell by cell.

use kaustik_mcmc::{Draws, SampleGenerators};
use serde::{Deserialize, Serialize};

use crate::RenderSettings;
use crate::sampling::cells::Cells;
use crate::sampling::streams;
use crate::state::StateError;

/// Steps between cells side by side and one below the other, the reciprocal of the plastic number and its square: the
/// shares of any block of cells fill the unit interval evenly (M. Roberts 2018, the sequence R2).
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// One share in [0, 1) a cell of a ladder: what its samples so far were owed of a chain and did not get
/// ([`kaustik_mcmc::Redistributor::carry`]).
///
/// So the samples of a cell have as many chains as they should over all passes, to within one. And since cells
/// near each other begin with shares far from each other, so have those of any block of cells, long before
/// each cell has had its own. The chains of a sample are right in the mean, as the shares are all turned by one uniform
/// number.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Carried(Vec<f64>);

impl Carried {
    /// Before the first pass.
    pub(crate) fn new(settings: &RenderSettings, ladder: u32) -> Self {
        let cells = Cells::new(settings);
        let turn = SampleGenerators::new(settings.seed, streams::CARRIED)
            .at(0)
            .uniform();
        let [first, end] = cells.of_ladder(ladder);
        let share = |cell: u64| {
            let corner = [cell % cells.columns(), cell / cells.columns()];
            let [x, y] = corner.map(|at| at as f64);
            let sum = turn + x * PLASTIC[0] + y * PLASTIC[1];
            sum - sum.floor()
        };
        Self((first..end).map(share).collect())
    }

    /// That of the cell which a step of the ladder visits.
    #[inline]
    pub(crate) fn at(&mut self, step: u64) -> Option<&mut f64> {
        let cell = step.checked_rem(self.0.len() as u64)?;
        self.0.get_mut(cell as usize)
    }

    /// As these shares were written down; refuses what no rounding in as many cells leaves over.
    pub(crate) fn checked(&self, kept: Self) -> Result<Self, StateError> {
        let sound = kept.0.iter().all(|share| (0.0..1.0).contains(share));
        if kept.0.len() != self.0.len() || !sound {
            return Err(StateError::damaged(
                "what is left over of chains is impossible",
            ));
        }
        Ok(kept)
    }
}
