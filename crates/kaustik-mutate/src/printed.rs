//! What a report printed, to show what it does.

use kaustik_mcmc::{Draws, Kernel, Move};

use crate::caustic::pivot;
use crate::{CausticPerturbation, Path};

/// The caustic perturbation with the density change of Batty's report: rule 5 alone, which leaves out
/// rule 2 where the light departs (Batty sec. 4.2).
///
/// **Wrong**: the ratio of the cosines there is missing, and light drifts to where it leaves at grazing
/// angles. For comparison alone.
#[derive(Clone, Copy, Debug)]
pub struct RuleFive<'a>(pub CausticPerturbation<'a>);

#[deny(clippy::missing_trait_methods)]
impl Kernel<()> for RuleFive<'_> {
    type Value = Path;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut (),
        current: &Path,
        proposed: &mut Path,
        draws: &mut D,
    ) -> Move {
        let mut proposal = self.0.propose(state, current, proposed, draws);
        if let (Some(pivot), true) = (pivot(current), proposal.ratio > 0.0) {
            proposal.ratio *= current.at(pivot).cos_eye / proposed.at(pivot).cos_eye;
        }
        proposal
    }

    fn accept(&self, state: &mut ()) {
        self.0.accept(state);
    }

    fn reject(&self, state: &mut ()) {
        self.0.reject(state);
    }

    fn enter<D: Draws + ?Sized>(&self, state: &mut (), draws: &mut D) {
        self.0.enter(state, draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut (), b: &mut (), draws: &mut D) {
        self.0.exchange(a, b, draws);
    }

    fn accept_move(&self, state: &mut (), proposal: &Move) {
        self.0.accept_move(state, proposal);
    }

    fn reject_move(&self, state: &mut (), proposal: &Move) {
        self.0.reject_move(state, proposal);
    }
}
