//! The methods and their settings by name.

use std::fmt;
use std::str::FromStr;

use crate::photon_options;

/// A way to compute the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Path tracing from the camera.
    Path,
    /// Light tracing to the camera.
    Light,
    /// Bidirectional path tracing.
    Bdpt,
    /// Primary sample space Metropolis light transport (Kelemen 2002).
    #[default]
    Pssmlt,
    /// Multiplexed Metropolis light transport (Hachisuka 2014).
    Mmlt,
    /// Replica exchange light transport (Kitaoka 2009).
    Relt,
    /// Energy redistribution on primary samples (Cline 2005; spec: erpt.md 6).
    ErptPss,
    /// Population annealing alone (Kitaoka 2009, section 6).
    Annealing,
    /// Metropolis light transport on paths (Veach and Guibas 1997).
    Mlt,
    /// Stochastic progressive photon mapping (Hachisuka and Jensen 2009).
    Sppm,
    /// Photons of chains that follow visibility (Hachisuka and Jensen 2011).
    PhotonVisibility,
    /// Photons of chains that follow the inverse of a pilot's density (Chen 2011).
    PhotonDensity,
    /// Photons of chains that follow the spatial target function (Gruson 2016).
    PhotonSpatial,
    /// The same with regions of the image.
    PhotonImage,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 14] = [
        Self::Path,
        Self::Light,
        Self::Bdpt,
        Self::Pssmlt,
        Self::Mmlt,
        Self::Relt,
        Self::ErptPss,
        Self::Annealing,
        Self::Mlt,
        Self::Sppm,
        Self::PhotonVisibility,
        Self::PhotonDensity,
        Self::PhotonSpatial,
        Self::PhotonImage,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Light => "light",
            Self::Bdpt => "bdpt",
            Self::Pssmlt => "pssmlt",
            Self::Mmlt => "mmlt",
            Self::Relt => "relt",
            Self::ErptPss => "erpt-pss",
            Self::Annealing => "annealing",
            Self::Mlt => "mlt",
            Self::Sppm => "sppm",
            Self::PhotonVisibility => "photon-visibility",
            Self::PhotonDensity => "photon-density",
            Self::PhotonSpatial => "photon-spatial",
            Self::PhotonImage => "photon-image",
        }
    }

    /// One line about it.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Path => {
                "path tracing with next-event estimation and multiple importance sampling"
            }
            Self::Light => {
                "light tracing: walks from the emitters, every vertex joined to the lens"
            }
            Self::Bdpt => {
                "bidirectional path tracing: walks from emitters and camera, joined in every way (Veach 1997)"
            }
            Self::Pssmlt => {
                "Metropolis light transport on primary samples (Kelemen, Szirmay-Kalos 2002)"
            }
            Self::Mmlt => {
                "Metropolis light transport over one strategy of bidirectional paths at a time (Hachisuka et al. 2014)"
            }
            Self::Relt => {
                "replica exchange: chains of rising difficulty that swap states (Kitaoka et al. 2009)"
            }
            Self::ErptPss => {
                "energy redistribution: path samples spread over their neighbours by short chains (Cline et al. 2005)"
            }
            Self::Annealing => {
                "population annealing: fresh populations climb from easy to hard paths (Kitaoka et al. 2009, 6)"
            }
            Self::Mlt => {
                "Metropolis light transport on paths: mutations trace what they change alone (Veach, Guibas 1997)"
            }
            Self::Sppm => {
                "photon mapping: photons counted at points that the camera sees, new ones an iteration (Hachisuka, Jensen 2009)"
            }
            Self::PhotonVisibility => {
                "photon mapping with chains that follow what the camera sees (Hachisuka, Jensen 2011)"
            }
            Self::PhotonDensity => {
                "photon mapping with chains that go where a pilot found few photons (Chen, Wang, Yong 2011)"
            }
            Self::PhotonSpatial => {
                "photon mapping with chains that even out the relative error, by regions of space (Gruson et al. 2016)"
            }
            Self::PhotonImage => "the same with regions of the image (Gruson et al. 2016)",
        }
    }

    /// The settings that it reads.
    pub fn keys(self) -> impl Iterator<Item = &'static Key> {
        KEYS.iter().filter(move |key| key.methods.contains(&self))
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no method '{wanted}'; known are: {}", Method::ALL.map(Method::name).join(", "))]
pub struct UnknownMethod {
    /// The name.
    pub wanted: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        Self::ALL
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| UnknownMethod {
                wanted: name.to_owned(),
            })
    }
}

/// A `--set` key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// Its default, as one would write it.
    pub default: &'static str,
    /// What it may be.
    pub range: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// The methods that read it.
    pub methods: &'static [Method],
}

const EVERY: &[Method] = &Method::ALL;
const WALKS: &[Method] = &[Method::Pssmlt, Method::ErptPss];
const SMALL_STEPS: &[Method] = &[Method::Pssmlt, Method::Mmlt, Method::ErptPss];
const REDISTRIBUTION: &[Method] = &[Method::ErptPss];
const CHAINS: &[Method] = &[Method::Pssmlt, Method::Mmlt];
const DIRECT: &[Method] = &[Method::Pssmlt, Method::Mmlt, Method::Relt, Method::ErptPss];
const METROPOLIS: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::Relt,
    Method::ErptPss,
    Method::Annealing,
    Method::Mlt,
];
const MULTIPLEXED: &[Method] = &[Method::Mmlt];
const EXCHANGE: &[Method] = &[Method::Relt];
const REPLICAS: &[Method] = &[Method::Relt, Method::Annealing];
const PATHS: &[Method] = &[Method::Mlt];

/// All keys.
pub const KEYS: &[Key] = &[
    Key {
        name: "ladders",
        default: "64",
        range: "1..=4096",
        meaning: "independent chains or streams of samples; part of the result, unlike --threads",
        methods: EVERY,
    },
    Key {
        name: "wavelengths",
        default: "hero",
        range: "hero|uniform",
        meaning: "four wavelengths importance-sampled over 360-830 nm, or one uniform over 400-700 nm \
                  (RELT 5.1.1; the same as --wavelengths 1)",
        methods: EVERY,
    },
    Key {
        name: "compensation",
        default: "on",
        range: "on|off",
        meaning: "give back the light that scatters between the facets of rough surfaces",
        methods: EVERY,
    },
    Key {
        name: "pilot",
        default: "100000",
        range: "1..=10000000",
        meaning: "independent samples at the start: they choose the chains' first states, estimate the \
                  normalisation and fix the film's quantum (path, light, bdpt: a hundredth of it)",
        methods: &[
            Method::Path,
            Method::Light,
            Method::Bdpt,
            Method::Pssmlt,
            Method::Mmlt,
            Method::ErptPss,
            Method::Mlt,
            Method::Sppm,
            Method::PhotonVisibility,
            Method::PhotonDensity,
            Method::PhotonSpatial,
            Method::PhotonImage,
        ],
    },
    Key {
        name: "nextevent",
        default: "on",
        range: "on|off",
        meaning: "join every vertex to an emitter; off: emitters are found by running into them",
        methods: &[Method::Path, Method::Pssmlt, Method::ErptPss],
    },
    Key {
        name: "builder",
        default: "unidirectional",
        range: "unidirectional|endpoint|simple|bidirectional",
        meaning: "how paths are made: a walk joined to emitters at every vertex, or at its end only; \
                  walks from both sides joined at their ends, or everywhere (Kelemen sec. 2)",
        methods: WALKS,
    },
    Key {
        name: "heuristic",
        default: "power",
        range: "power|balance|maximum",
        meaning: "how the strategies of bidirectional paths share one path (Veach 1997, 9.2); pssmlt: \
                  builders simple and bidirectional",
        methods: &[
            Method::Bdpt,
            Method::Pssmlt,
            Method::Mmlt,
            Method::Relt,
            Method::ErptPss,
            Method::Annealing,
        ],
    },
    Key {
        name: "strategies",
        default: "learned",
        range: "learned|even",
        meaning: "how often the strategies of a length are tried: by the light that each brings to a \
                  pilot, with a quarter for all alike; or all alike (Hachisuka 2014)",
        methods: MULTIPLEXED,
    },
    Key {
        name: "target",
        default: "xyz",
        range: "xyz|luminance",
        meaning: "the scalar that the chain follows: X+Y+Z, or luminance (which starves dispersion)",
        methods: METROPOLIS,
    },
    Key {
        name: "contribution",
        default: "sum",
        range: "sum|maximum",
        meaning: "how what one point contributes makes one scalar: the sum, or the largest single path",
        methods: WALKS,
    },
    Key {
        name: "plarge",
        default: "0.3",
        range: "0 < p <= 1",
        meaning: "probability of a large step (Kelemen reports about 0.5 as best)",
        methods: CHAINS,
    },
    Key {
        name: "mutation",
        default: "kelemen",
        range: "kelemen|kelemen:S1:S2|uniform:FRACTION",
        meaning: "small steps: exponential between S1 and S2 (1/1024 and 1/64), or uniform within a \
                  fraction of the domain",
        methods: SMALL_STEPS,
    },
    Key {
        name: "mis",
        default: "split",
        range: "split|printed|off",
        meaning: "large steps as independent samples: on a film of their own (unbiased), with the \
                  paper's weights, or not at all",
        methods: CHAINS,
    },
    Key {
        name: "normaliser",
        default: "running",
        range: "running|initial",
        meaning: "the scale of the image: from the pilot and all large steps; the same by Bennett's acceptance \
                  ratio with the chains; from the pilot alone (exactly unbiased)",
        methods: CHAINS,
    },
    Key {
        name: "direct",
        default: "lamps",
        range: "lamps|together|apart",
        meaning: "what independent samples beside the chains see to: emitters and surroundings seen directly \
                  (erpt-pss: nothing), nothing, or all paths of at most two edges",
        methods: DIRECT,
    },
    Key {
        name: "normaliser",
        default: "running",
        range: "running|exchange|initial",
        meaning: "what scales the replicas' films: all independent samples so far; what each replica tells \
                  about the next (RELT eq. 10, which is blind to what no chain has found); the annealing's \
                  own constants",
        methods: EXCHANGE,
    },
    Key {
        name: "replicas",
        default: "standard",
        range: "standard|uniform;D0,D1,D2,D3,D4,D5;...",
        meaning: "what the chains of a ladder follow: the paper's four, or 2 to 8 of one's own, each \
                  the weights of the six classes of paths (no class that the one before leaves out)",
        methods: REPLICAS,
    },
    Key {
        name: "delta",
        default: "0.05",
        range: "0 < delta <= 1",
        meaning: "share of joined paths in the last of the standard replicas: lets it exchange",
        methods: REPLICAS,
    },
    Key {
        name: "beta",
        default: "2",
        range: "1 <= beta <= 8",
        meaning: "exponent of the heuristic that combines the replicas",
        methods: REPLICAS,
    },
    Key {
        name: "exchange",
        default: "full",
        range: "full|pair|alternating|gibbs|none",
        meaning: "exchanges after each sweep: even and odd pairs, one random pair (the paper), even and \
                  odd by turns, a permutation of all (at most 5 replicas), none",
        methods: EXCHANGE,
    },
    Key {
        name: "steps",
        default: "fine",
        range: "fine|paper|adapted",
        meaning: "small steps: 1/61 and 1/61 up to 16 times as much, for the specific replica 1/1024 up to \
                  1/64; or 1/96 up to 1/6 (RELT 5.1.3); or these times factors that every ladder of relt \
                  adapts to an acceptance of 0.234",
        methods: REPLICAS,
    },
    Key {
        name: "particles",
        default: "10000",
        range: "1000..=1000000",
        meaning: "particles of the population annealing at the start (first states and constants of \
                  the weights), and of each round of annealing",
        methods: REPLICAS,
    },
    Key {
        name: "length",
        default: "100",
        range: "1..=100000",
        meaning: "steps of each chain that spreads the light of a sample (Batty: 100 to 1000)",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "chains",
        default: "1",
        range: "0.01 <= mean <= 100",
        meaning: "chains a sample in the mean; how many a sample has goes with the light that it brings",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "consecutive",
        default: "off",
        range: "off|1..=100000",
        meaning: "Cline's filter: a chain that stayed in one place for more proposals than this leaves \
                  nothing for its staying. Biased: light is lost (the report uses 10 and 20)",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "mutations",
        default: "bidirectional,lens,multichain,caustic,subpath,wavelengths",
        range: "a list of bidirectional|lens|multichain|caustic|subpath|wavelengths",
        meaning: "what may change a path; bidirectional alone reaches every path",
        methods: PATHS,
    },
    Key {
        name: "jitter",
        default: "veach",
        range: "veach|R1:R2",
        meaning: "pixels by which lens, multichain and caustic move what is seen: a tenth up to the radius of a \
                  twentieth of the image, or 0 < R1 < R2",
        methods: PATHS,
    },
    Key {
        name: "angles",
        default: "0.0001:0.1",
        range: "T1:T2",
        meaning: "radians by which multichain turns directions within the path, 0 < T1 < T2 <= 3",
        methods: PATHS,
    },
    photon_options::LIGHT_PATHS,
    photon_options::ROUGHNESS,
    photon_options::RADIUS,
    photon_options::REDUCTION,
    photon_options::REMAINDER,
    photon_options::ACCEPTANCE,
    photon_options::BURN_IN,
    photon_options::COMBINE,
    photon_options::LEVELS,
    photon_options::TARGET_FUNCTION,
    photon_options::PSI,
    photon_options::REFINEMENT,
];
