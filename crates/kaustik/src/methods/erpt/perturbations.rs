//! How paths move along a chain: what of each kind suits, chosen by the string of scatterings.

use glam::DVec2;
use kaustik_mcmc::{Kernel, Mixture, Suitability};
use kaustik_mutate::{
    CausticPerturbation, LensPerturbation, Path, PathSpace, Radii, RuleFive, WavelengthMutation,
};

use crate::{Caustics, Jitter, MutationKind, Mutations, Options};

/// Kinds of moves: the four of the settings, and caustic perturbations as printed.
pub(crate) const KINDS: usize = 5;

/// Names in the statistics.
pub(crate) const NAMES: [&str; KINDS] = [
    "lens",
    "multichain",
    "caustic",
    "caustic, printed",
    "wavelengths",
];

/// How often fresh wavelengths are chosen beside a perturbation: they trace nothing, and need to come by
/// only now and then.
const FRESH_WAVELENGTHS: f64 = 0.25;

/// Lens or multi-chain perturbation, whichever the string allows, and the caustic one where it does, each as
/// often as the other (Batty sec. 4.1).
#[derive(Clone, Copy)]
pub(crate) struct Perturbations<'a> {
    single: LensPerturbation<'a>,
    multiple: LensPerturbation<'a>,
    caustic: CausticPerturbation<'a>,
    wavelengths: WavelengthMutation<'a>,
    /// Which of them are made.
    made: Mutations,
    printed: bool,
}

impl<'a> Perturbations<'a> {
    pub(crate) fn new(space: &'a PathSpace<'a>, options: &Options, size: DVec2) -> Self {
        let radii = options.jitter.radii(size, Jitter::Local);
        let [least, most] = options.angles;
        let [single, multiple] = LensPerturbation::runs(space, radii, Radii { least, most });
        Self {
            single,
            multiple,
            caustic: CausticPerturbation { space, radii },
            wavelengths: WavelengthMutation { space },
            made: options.perturbations,
            printed: options.caustic == Caustics::Printed,
        }
    }

    /// The same in another space of the same scene: at the time of a path.
    pub(crate) fn within(mut self, space: &'a PathSpace<'a>) -> Self {
        self.single.space = space;
        self.multiple.space = space;
        self.caustic.space = space;
        self.wavelengths.space = space;
        self
    }

    /// Can any of them move the path?
    pub(crate) fn suit(&self, path: &Path) -> bool {
        self.weights(path).iter().any(|&weight| weight > 0.0)
    }

    /// The kernel that chooses among them.
    pub(crate) fn kernel(self) -> impl Kernel<(), Value = Path> + 'a {
        let Self {
            single,
            multiple,
            caustic,
            wavelengths,
            ..
        } = self;
        let kernels = (single, multiple, caustic, RuleFive(caustic), wavelengths);
        Mixture::<_, _, KINDS>::new(kernels, self)
    }
}

impl Suitability<Path, KINDS> for Perturbations<'_> {
    fn weights(&self, path: &Path) -> [f64; KINDS] {
        let made = |kind| self.made.holds(kind);
        // Cline and Batty perturb caustics alone in this way: a Dirac scattering before what is seen.
        let edges = path.edges();
        let caustic = made(MutationKind::Caustic)
            && edges > 2
            && path.is_specular(edges - 2)
            && self.caustic.suits(path);
        let weight = |suits: bool| f64::from(u8::from(suits));
        [
            weight(made(MutationKind::Lens) && self.single.suits(path)),
            weight(made(MutationKind::Multichain) && self.multiple.suits(path)),
            weight(caustic && !self.printed),
            weight(caustic && self.printed),
            FRESH_WAVELENGTHS
                * weight(made(MutationKind::Wavelengths) && self.wavelengths.suits(path)),
        ]
    }
}
