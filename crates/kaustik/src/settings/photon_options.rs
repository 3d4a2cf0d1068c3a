//! The settings of photon methods.

use kaustik_estimate::{Combine, Refinement, Witnesses};

use crate::settings::key::Key;
use crate::settings::method::Method;
use crate::settings::options::setting::{
    AnySetting, by, finite, number, optional, optional_integer, switch, word,
};

/// Settings that only photon methods read. Each is named as its key, or as said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonOptions {
    /// Light paths of an iteration, 10 to 100,000,000; `None`: 250,000, or two a pixel where that is more.
    pub photons: Option<u64>,
    /// Lobes of this GGX roughness or more show the light of photons, in [0, 1].
    pub roughness: f64,
    /// Radius within which a photon counts, in widths of a square as large as the pixel's footprint on the surface, in [0.01, 100].
    pub radius: f64,
    /// Shrinks the squared radius by (i + alpha) / (i + 1) in iteration i; `None`: the radius stays.
    pub reduction: Option<f64>,
    /// Path tracing of what photons cannot carry.
    pub remainder: bool,
    /// Acceptance that the sizes of small steps are driven to, in [0.01, 0.99].
    pub acceptance: f64,
    /// `burnin`: steps of each chain that are discarded at the start of an iteration, up to 100,000; `None`: 64, and where targets go by the points
    /// at least a sixteenth of those that the last chain takes.
    pub burn_in: Option<u64>,
    /// How the chains of a ladder make one picture.
    pub combine: Combine,
    /// Chains of a ladder.
    pub levels: LadderSize,
    /// How often each of them takes a step.
    pub pace: Pace,
    /// `tf`: what the last of the chains follows.
    pub target_function: TargetFunction,
    /// Whose visits tell how dense photons are.
    pub psi: Witnesses,
    /// How regions are divided.
    pub refinement: Refinement,
    /// Do small regions tell orientations apart?
    pub orientation: bool,
    /// How visible light paths are scaled.
    pub normalisation: Normalisation,
    /// Layers of the target and of how often points were touched.
    pub maps: bool,
}

/// What the last of the chains follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TargetFunction {
    /// The inverse density of photons in a region times the inverse size of the kernel (G Eq. 11).
    #[default]
    Full,
    /// The second factor alone.
    InverseKernel,
    /// The full one, with the spread of fluxes in each region as well (G Eq. 3).
    SecondMoment,
}

/// How many chains a ladder has, and so which targets they follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LadderSize {
    /// Uniform and full target.
    Two,
    /// Uniform, inverse kernel size, full target.
    Three,
    /// With visibility, as published (G sec. 4.4).
    #[default]
    Four,
}

/// How often each chain of a ladder takes a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// By how many uniform light paths are seen: where many are, the first chain takes most steps.
    #[default]
    Auto,
    /// A step in every n-th sweep (1 to 64), in the order uniform, visibility, inverse kernel size, full
    /// target. Entries for levels that the ladder lacks are ignored.
    Periods([u32; 4]),
}

/// How the normaliser of visibility is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normalisation {
    /// From all uniform light paths so far: biased where visibility goes with an iteration's wavelengths or points.
    Progressive,
    /// From those of each iteration, for it alone.
    #[default]
    Iteration,
}

impl Default for PhotonOptions {
    fn default() -> Self {
        Self {
            photons: None,
            roughness: 0.39,
            radius: 1.0,
            reduction: Some(0.8),
            remainder: true,
            acceptance: 0.234,
            burn_in: None,
            combine: Combine::Balance,
            levels: LadderSize::Four,
            pace: Pace::Auto,
            target_function: TargetFunction::Full,
            psi: Witnesses::All,
            refinement: Refinement::SHRUNK,
            orientation: false,
            normalisation: Normalisation::Iteration,
            maps: false,
        }
    }
}

/// Methods that trace photons.
pub(super) const PHOTONS: &[Method] = &[
    Method::Sppm,
    Method::PhotonVisibility,
    Method::PhotonDensity,
    Method::PhotonSpatial,
    Method::PhotonImage,
];
/// Those of them that run chains.
const CHAINS: &[Method] = &[
    Method::PhotonVisibility,
    Method::PhotonDensity,
    Method::PhotonSpatial,
    Method::PhotonImage,
];
/// Those that may have one of visibility.
const VISIBILITY: &[Method] = &[
    Method::PhotonVisibility,
    Method::PhotonSpatial,
    Method::PhotonImage,
];
/// Those whose target goes by regions.
const REGIONS: &[Method] = &[Method::PhotonSpatial, Method::PhotonImage];

/// Light paths of an iteration.
pub(crate) const LIGHT_PATHS: Key = Key {
    name: "photons",
    default: "auto",
    range: "auto|10 to 100000000",
    meaning: "light paths of an iteration; each iteration sees the scene from new points and with new wavelengths (the \
                  paper on the spatial target function: 10 million). auto: 250,000, or two for each pixel where that is more",
    methods: PHOTONS,
};
/// Where measurement points stand.
pub(crate) const ROUGHNESS: Key = Key {
    name: "roughness",
    default: "0.39",
    range: "0 <= alpha <= 1",
    meaning: "lobes of this GGX roughness or more show the light of photons; narrower ones are followed further from the \
                  camera, down to the first that is not (the paper: 0.39, and 0.05)",
    methods: PHOTONS,
};
/// Their size.
pub(crate) const RADIUS: Key = Key {
    name: "radius",
    default: "1",
    range: "0.01 <= widths <= 100",
    meaning: "radius within which a photon counts, in widths of a square as large as the pixel's footprint on the surface",
    methods: PHOTONS,
};
/// How that changes.
pub(crate) const REDUCTION: Key = Key {
    name: "reduction",
    default: "0.8",
    range: "off|0 < alpha < 1",
    meaning: "shrinks the radius from iteration to iteration, so that its error vanishes in the end: its square by (i + \
                  alpha) / (i + 1) after the i-th; 0.7 is usual; off: it stays (as in the paper on the spatial target function)",
    methods: PHOTONS,
};
/// What they cannot carry.
pub(crate) const REMAINDER: Key = Key {
    name: "remainder",
    default: "on",
    range: "on|off",
    meaning: "path tracing of what photons cannot carry: light that reaches the camera by mirrors, glass and narrow lobes \
                  alone, two samples a pixel and iteration; off: emitters seen directly are all that is left of it",
    methods: PHOTONS,
};

/// How often small steps are to be accepted.
pub(crate) const ACCEPTANCE: Key = Key {
    name: "acceptance",
    default: "0.234",
    range: "0.01 <= rate <= 0.99",
    meaning: "acceptance of small steps that their sizes are driven to between iterations, for each kind of chain by \
                  itself (the authors' code: 0.5)",
    methods: CHAINS,
};
/// What does not count.
pub(crate) const BURN_IN: Key = Key {
    name: "burnin",
    default: "auto",
    range: "auto|0 to 100000",
    meaning: "steps of each chain at the start of an iteration that are discarded, because the targets have just changed \
                  (the paper: 10,000, of one ladder and 10 million paths). auto: 64; of all but photon-visibility a sixteenth of \
                  the steps that the last chain takes, if that is more",
    methods: CHAINS,
};
/// How chains make one picture.
pub(crate) const COMBINE: Key = Key {
    name: "combine",
    default: "balance",
    range: "balance|average|samples",
    meaning: "how the chains of a ladder make one picture: by the balance heuristic over all of them, the plain mean, or \
                  the mean weighted by the samples that each took (the paper's Figure 6)",
    methods: CHAINS,
};
/// Which chains.
pub(crate) const LEVELS: Key = Key {
    name: "levels",
    default: "4",
    range: "2|3|4",
    meaning: "chains of a ladder: uniform, visibility, inverse kernel size and the full target; without visibility; \
                  uniform and full alone",
    methods: REGIONS,
};
/// How often they step.
pub(crate) const PACE: Key = Key {
    name: "pace",
    default: "auto",
    range: "auto|a:b:c:d, 1 to 64 each",
    meaning: "the uniform chain and those of visibility, inverse kernel size and full target take a step in every a-th, \
                  b-th, c-th, d-th sweep; entries for chains that a ladder does not have are ignored. 4:4:4:1: the last takes \
                  four steps to one of each other. auto: 1:64:64:64 where two in five uniform light paths are seen, else \
                  1:2:2:1 as in the authors' code; 1:1:1:1 without a full target",
    methods: CHAINS,
};
/// What the last one follows.
pub(crate) const TARGET_FUNCTION: Key = Key {
    name: "tf",
    default: "full",
    range: "full|inverse-kernel|second-moment",
    meaning: "the target function: inverse density of photons in the region times inverse kernel size; the second alone; \
                  the first times the spread of fluxes in the region as well (Eq. 3)",
    methods: REGIONS,
};
/// Whose visits tell about regions.
pub(crate) const PSI: Key = Key {
    name: "psi",
    default: "all",
    range: "all|authors|visibility",
    meaning: "whose visits tell how dense photons are: those of all chains; of all but the last, as in the authors' code; \
                  of the chain of visibility (levels=4; a ladder that has no such chain goes by authors)",
    methods: REGIONS,
};
/// When regions are divided.
pub(crate) const REFINEMENT: Key = Key {
    name: "refinement",
    default: "shrunk",
    range: "shrunk|early|adaptive|iterations|off",
    meaning: "how regions are divided. shrunk: every leaf is one, and its density is drawn towards that of the region \
                  around it until some 20 light paths have touched it. early: a region is divided where the halves of its \
                  statistics differ by less than 30 % and 200 light paths have touched both parts; adaptive: by less than 5 %, \
                  and 10,000 (the paper's); iterations: once an iteration; off: never",
    methods: REGIONS,
};

/// How regions are told apart.
pub(crate) const ORIENTATION: Key = Key {
    name: "orientation",
    default: "off",
    range: "on|off",
    meaning: "small regions also part surfaces that face different ways",
    methods: &[Method::PhotonSpatial],
};
/// How visibility's integral is found.
pub(crate) const NORMALISATION: Key = Key {
    name: "normalisation",
    default: "iteration",
    range: "iteration|progressive",
    meaning: "how visible light paths are scaled. iteration: by the share of the iteration's own uniform light paths that are \
                  visible, as in the paper and wherever something moves; progressive: by the share over all iterations so far, \
                  which is biased if the share depends on the wavelengths (where a chain of visibility stands on the uniform \
                  one, with reduction=off; elsewhere as iteration)",
    methods: VISIBILITY,
};
/// Layers.
pub(crate) const MAPS: Key = Key {
    name: "maps",
    default: "off",
    range: "on|off",
    meaning: "layers: the target of the last iteration (target: full, kernel, density, region), and how often points were \
                  touched (contributions); photon-visibility has these counts alone",
    methods: CHAINS,
};

const COMBINES: &[(&str, Combine)] = &[
    ("balance", Combine::Balance),
    ("average", Combine::Average),
    ("samples", Combine::Samples),
];
const LADDER_SIZES: &[(&str, LadderSize)] = &[
    ("2", LadderSize::Two),
    ("3", LadderSize::Three),
    ("4", LadderSize::Four),
];
const TARGET_FUNCTIONS: &[(&str, TargetFunction)] = &[
    ("full", TargetFunction::Full),
    ("inverse-kernel", TargetFunction::InverseKernel),
    ("second-moment", TargetFunction::SecondMoment),
];
const PSIS: &[(&str, Witnesses)] = &[
    ("all", Witnesses::All),
    ("authors", Witnesses::Others),
    ("visibility", Witnesses::Visibility),
];
const REFINEMENTS: &[(&str, Refinement)] = &[
    ("shrunk", Refinement::SHRUNK),
    ("early", Refinement::EARLY),
    ("adaptive", Refinement::PUBLISHED),
    ("iterations", Refinement::Iterations),
    ("off", Refinement::Off),
];
const NORMALISATIONS: &[(&str, Normalisation)] = &[
    ("progressive", Normalisation::Progressive),
    ("iteration", Normalisation::Iteration),
];

impl PhotonOptions {
    /// The setting of a key; `None` if photons have no such key.
    pub(crate) fn setting(&mut self, key: &str) -> Option<AnySetting<'_>> {
        Some(match key {
            "photons" => optional_integer(&mut self.photons, "auto", 10..=100_000_000),
            "roughness" => number(&mut self.roughness, |alpha| (0.0..=1.0).contains(&alpha)),
            "radius" => number(&mut self.radius, |widths| (0.01..=100.0).contains(&widths)),
            "reduction" => optional(&mut self.reduction, "off", |text| {
                finite(text).filter(|alpha| *alpha > 0.0 && *alpha < 1.0)
            }),
            "remainder" => switch(&mut self.remainder),
            "acceptance" => number(&mut self.acceptance, |rate| (0.01..=0.99).contains(&rate)),
            "burnin" => optional_integer(&mut self.burn_in, "auto", 0..=100_000),
            "combine" => word(&mut self.combine, COMBINES),
            "levels" => word(&mut self.levels, LADDER_SIZES),
            "pace" => by(&mut self.pace, Pace::parse, Pace::text),
            "tf" => word(&mut self.target_function, TARGET_FUNCTIONS),
            "psi" => word(&mut self.psi, PSIS),
            "refinement" => word(&mut self.refinement, REFINEMENTS),
            "orientation" => switch(&mut self.orientation),
            "normalisation" => word(&mut self.normalisation, NORMALISATIONS),
            "maps" => switch(&mut self.maps),
            _ => return None,
        })
    }
}

impl Pace {
    fn text(&self) -> String {
        match self {
            Self::Auto => "auto".to_owned(),
            Self::Periods(periods) => periods.map(|n| n.to_string()).join(":"),
        }
    }

    fn parse(text: &str) -> Option<Self> {
        if text == "auto" {
            return Some(Self::Auto);
        }
        let period = |text: &str| text.parse().ok().filter(|n| (1..=64).contains(n));
        let periods: Option<Vec<u32>> = text.split(':').map(period).collect();
        Some(Self::Periods(periods?.try_into().ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    #[test]
    fn what_is_written_of_photons_is_what_was_set() {
        let mut options = Options::default();
        for text in [
            "photons=5000",
            "roughness=0.05",
            "radius=2.5",
            "reduction=0.7",
            "remainder=off",
            "acceptance=0.5",
            "burnin=100",
            "combine=samples",
            "levels=3",
            "pace=2:4:1:1",
            "tf=inverse-kernel",
            "psi=visibility",
            "refinement=adaptive",
            "orientation=on",
            "normalisation=iteration",
            "maps=on",
        ] {
            options.set(Method::PhotonSpatial, text).unwrap();
        }
        let mut again = Options::default();
        for (key, value) in options.entries(Method::PhotonSpatial) {
            again
                .set(Method::PhotonSpatial, &format!("{key}={value}"))
                .unwrap();
        }
        assert_eq!(again, options);
        assert_ne!(options.photon, PhotonOptions::default());
        for wrong in [
            "photons=9",
            "photons=many",
            "roughness=2",
            "radius=0",
            "reduction=1",
            "remainder=some",
            "acceptance=1",
            "levels=5",
            "pace=1:1:1",
            "pace=1:1:1:0",
            "pace=1:1:1:65",
            "pace=fast",
            "burnin=100001",
            "tf=half",
            "refinement=soon",
        ] {
            assert!(again.set(Method::PhotonSpatial, wrong).is_err(), "{wrong}");
        }
        assert_eq!(again, options);
    }
}
