//! The mutations that are asked for, as one kernel.

use glam::DVec2;
use kaustik_mcmc::{Kernel, Mixture, Move};
use kaustik_mutate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, PathSpace, Radii, Run, TimeMutation, WavelengthMutation,
};

use crate::{Jitter, Mutations, Options};

/// How many kinds of mutations there are.
const KINDS: usize = Mutations::NAMES.len();

/// How often each is made where it suits, in the order of their names: the two that trace no part that a
/// perturbation keeps, and the one that traces nothing, need to come by only now and then.
const SHARES: [f64; KINDS] = [1.0, 1.0, 1.0, 1.0, 0.25, 0.25, 0.5, 1.0];

const _: () = assert!(KINDS <= Move::KINDS);

/// Of all mutations of the options that suit a path one is made, by their [`SHARES`]; `size` is the image's, in pixels.
pub(super) fn mixture<'s>(
    space: &'s PathSpace<'s>,
    options: &Options,
    size: DVec2,
) -> impl Kernel<(), Value = Path> + use<'s> {
    let radii = options.jitter.radii(size, Jitter::Veach);
    let [least, most] = options.angles;
    let angles = Radii { least, most };
    let lens = |run| LensPerturbation {
        space,
        radii,
        angles,
        run,
    };
    let (single, multiple) = (lens(Run::Single), lens(Run::Multiple));
    let caustic = CausticPerturbation { space, radii };
    let (subpath, wavelengths) = (LensMutation { space }, WavelengthMutation { space });
    let time = TimeMutation { space };
    let made = options.mutations;
    let every = EveryPerturbation {
        space,
        fraction: made.fraction,
    };
    let suits = move |path: &Path| {
        let suited = [
            true,
            made.holds(1) && single.suits(path),
            made.holds(2) && multiple.suits(path),
            made.holds(3) && caustic.suits(path),
            made.holds(4) && subpath.suits(path),
            made.holds(5) && wavelengths.suits(path),
            made.holds(6) && time.suits(path),
            made.holds(Mutations::EVERY) && every.suits(path),
        ];
        std::array::from_fn(|i| {
            if suited[i] && made.holds(i) {
                SHARES[i]
            } else {
                0.0
            }
        })
    };
    let kernels = (
        BidirectionalMutation { space },
        single,
        multiple,
        caustic,
        subpath,
        wavelengths,
        time,
        every,
    );
    Mixture::<_, _, KINDS>::new(kernels, suits)
}
