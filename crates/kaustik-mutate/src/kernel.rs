//! The mutations of this crate as kernels of chains.

use kaustik_mcmc::{Draws, Kernel, Move};

use crate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, TimeMutation, WavelengthMutation,
};

/// The same for each: a method that makes the proposal and returns the ratio of its densities back and there,
/// or nothing where there is none to be made. It sees the space at the time of the path that it starts from.
macro_rules! kernels {
    ($($mutation:ident by $propose:ident,)*) => {
        $(impl Kernel<()> for $mutation<'_> {
            type Value = Path;

            fn propose<D: Draws + ?Sized>(
                &self,
                (): &mut (),
                current: &Path,
                proposed: &mut Path,
                draws: &mut D,
            ) -> Move {
                let found = self.space.at(current.time, |space| {
                    // The same kernel, for as long as that space is there.
                    let mut here: $mutation<'_> = *self;
                    here.space = space;
                    here.$propose(current, proposed, draws)
                });
                // Of whatever kind: a `Mixture` of these tells its parts apart itself, from 0 on.
                Move::new(0, ratio(found))
            }
        })*
    };
}

kernels! {
    BidirectionalMutation by mutate,
    CausticPerturbation by perturb,
    EveryPerturbation by perturb,
    LensMutation by mutate,
    LensPerturbation by perturb,
    TimeMutation by redraw,
    WavelengthMutation by redraw,
}

/// A ratio that is infinite or not a number belongs to a step that rounding made impossible:
/// it is rejected, as are all whose way back does not exist, and is no defect of a value.
fn ratio(found: Option<f64>) -> f64 {
    found.filter(|ratio| ratio.is_finite()).unwrap_or(0.0)
}
