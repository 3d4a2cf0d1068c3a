//! The mutations that are asked for, as one kernel.

use glam::DVec2;
use kaustik_mcmc::{Kernel, Mixture, Move};
use kaustik_mutate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, PathSpace, Radii, TimeMutation, WavelengthMutation,
};

use crate::{Jitter, MutationKind, Options};

const _: () = assert!(MutationKind::COUNT <= Move::KINDS);

/// How often a kind is made where it suits, for once of the others. A fresh subpath from the lens takes a path to where no
/// perturbation does, but is seldom accepted, and fresh wavelengths change little: they come by now and then.
/// A fresh time costs a whole path and is accepted less than a perturbation: half as often.
const fn share(kind: MutationKind) -> f64 {
    match kind {
        MutationKind::Subpath | MutationKind::Wavelengths => 0.25,
        MutationKind::Time => 0.5,
        _ => 1.0,
    }
}

/// Of all mutations of the options that suit a path one is made, by their [`share`]; `size` is the image's, in pixels.
pub(super) fn mixture<'s>(
    space: &'s PathSpace<'s>,
    options: &Options,
    size: DVec2,
) -> impl Kernel<(), Value = Path> + use<'s> {
    let radii = options.jitter.radii(size, Jitter::Veach);
    let [least, most] = options.angles;
    let [single, multiple] = LensPerturbation::runs(space, radii, Radii { least, most });
    let caustic = CausticPerturbation { space, radii };
    let (subpath, wavelengths) = (LensMutation { space }, WavelengthMutation { space });
    let time = TimeMutation { space };
    let made = options.mutations;
    let every = EveryPerturbation {
        space,
        fraction: made.fraction,
    };
    let suits = move |path: &Path| {
        MutationKind::ALL.map(|kind| {
            let suits = made.holds(kind)
                && match kind {
                    MutationKind::Bidirectional => true,
                    MutationKind::Lens => single.suits(path),
                    MutationKind::Multichain => multiple.suits(path),
                    MutationKind::Caustic => caustic.suits(path),
                    MutationKind::Subpath => subpath.suits(path),
                    MutationKind::Wavelengths => wavelengths.suits(path),
                    MutationKind::Time => time.suits(path),
                    MutationKind::Every => every.suits(path),
                };
            if suits { share(kind) } else { 0.0 }
        })
    };
    // In the order of `MutationKind::ALL`.
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
    Mixture::<_, _, { MutationKind::COUNT }>::new(kernels, suits)
}
