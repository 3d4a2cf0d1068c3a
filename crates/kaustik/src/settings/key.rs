//! The settings of methods by name.

use crate::settings::method::Method;
use crate::settings::photon_options;

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

impl Key {
    /// Some words are for some methods alone, though one setting holds what all of them mean: is this one for those
    /// of this key?
    pub(super) fn knows(&self, value: &str) -> bool {
        let is_shared = matches!(self.name, "normaliser" | "direct");
        !is_shared || self.range.split('|').any(|word| word == value)
    }
}

const EVERY: &[Method] = &Method::ALL;
const WALKS: &[Method] = &[Method::Pssmlt, Method::ErptPss, Method::PssmltMultistage];
const SINGLE: &[Method] = &[Method::Pssmlt, Method::ErptPss];
const SMALL_STEPS: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::ErptPss,
    Method::PssmltMultistage,
];
const LARGE_STEPS: &[Method] = &[Method::Pssmlt, Method::Mmlt, Method::PssmltMultistage];
const REDISTRIBUTION: &[Method] = &[Method::ErptPss, Method::Erpt];
const ENERGY: &[Method] = &[Method::Erpt];
const CHAINS: &[Method] = &[Method::Pssmlt, Method::Mmlt];
/// Chains whose light can be measured beside them.
const METERED: &[Method] = &[Method::Pssmlt, Method::Mmlt, Method::Relt, Method::Mlt];

const NORMALISED: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::Mlt,
    Method::MltMultistage,
    Method::PssmltMultistage,
];
const STAGED: &[Method] = &[Method::MltMultistage, Method::PssmltMultistage];
const DIRECT: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::Relt,
    Method::ErptPss,
    Method::Erpt,
    Method::Mlt,
];
const METROPOLIS: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::Relt,
    Method::ErptPss,
    Method::Annealing,
    Method::Mlt,
    Method::Erpt,
    Method::MltMultistage,
    Method::PssmltMultistage,
];
/// Methods whose start may be shortened.
const STARTED: &[Method] = &[
    Method::Pssmlt,
    Method::Mmlt,
    Method::Relt,
    Method::ErptPss,
    Method::Mlt,
    Method::Erpt,
];
const MULTIPLEXED: &[Method] = &[Method::Mmlt];
const EXCHANGE: &[Method] = &[Method::Relt];
const REPLICAS: &[Method] = &[Method::Relt, Method::Annealing];
const VEACH: &[Method] = &[Method::Mlt, Method::MltMultistage];
const PATHS: &[Method] = &[Method::Mlt, Method::Erpt, Method::MltMultistage];

/// All keys.
pub const KEYS: &[Key] = &[
    Key {
        name: "ladders",
        default: "64",
        range: "1 to 4096",
        meaning: "independent chains or streams of samples; part of the result, unlike --threads (photon chains: fewer, if an \
                  iteration would not give each of their chains 31,250 steps in the mean)",
        methods: EVERY,
    },
    Key {
        name: "wavelengths",
        default: "hero",
        range: "hero|uniform",
        meaning: "four, importance-sampled over 360-830 nm; or one, uniform over 400-700 nm (the replica exchange paper's own; \
                  the same as --wavelengths 1)",
        methods: EVERY,
    },
    Key {
        name: "compensation",
        default: "on",
        range: "on|off",
        meaning: "gives back the light that scatters between the facets of rough surfaces",
        methods: EVERY,
    },
    Key {
        name: "pilot",
        default: "100000",
        range: "1 to 10000000",
        meaning: "number of independent samples at the start: they provide the first states, estimate the normalisation constant and \
                  set the film's quantum (path, light, bdpt, and the remainder of photon methods: a hundredth of it; mmlt: up to \
                  as many bidirectional samples in addition, at most 200,000, decide how often strategies are tried; \
                  multi-stage methods: as many again, shared by the stages after the first)",
        methods: &[
            Method::Path,
            Method::Light,
            Method::Bdpt,
            Method::Pssmlt,
            Method::Mmlt,
            Method::ErptPss,
            Method::Mlt,
            Method::Erpt,
            Method::Sppm,
            Method::PhotonVisibility,
            Method::PhotonDensity,
            Method::PhotonSpatial,
            Method::PhotonImage,
            Method::MltMultistage,
            Method::PssmltMultistage,
        ],
    },
    Key {
        name: "start",
        default: "auto",
        range: "auto|whole|1/2|1/4|... to 1/1024",
        meaning: "share of pilot, or of particles, that is made. auto: all, but where --time is set and a look finds that the start \
                  would take more than a third of it (on two cores), a share that does not (not of a render of some --ladders \
                  alone, nor with normaliser=initial or mis=printed)",
        methods: STARTED,
    },
    Key {
        name: "nextevent",
        default: "on",
        range: "on|off",
        meaning: "connects every vertex to an emitter; off: emitters are found only when a path hits one (only with \
                  builder=unidirectional and seeds=path)",
        methods: &[
            Method::Path,
            Method::Pssmlt,
            Method::ErptPss,
            Method::Erpt,
            Method::PssmltMultistage,
        ],
    },
    Key {
        name: "builder",
        default: "unidirectional",
        range: "unidirectional|endpoint|simple|bidirectional",
        meaning: "how a point becomes paths. unidirectional: a walk from the camera, connected to emitters at every vertex; \
                  endpoint: connected at its end only; simple: walks from light and camera, connected at their ends; \
                  bidirectional: connected everywhere",
        methods: WALKS,
    },
    Key {
        name: "heuristic",
        default: "power",
        range: "power|balance|maximum",
        meaning: "how the strategies of bidirectional paths share one path; maximum traces the fewest shadow rays (pssmlt: \
                  builders simple and bidirectional)",
        methods: &[
            Method::Bdpt,
            Method::Pssmlt,
            Method::Mmlt,
            Method::Relt,
            Method::ErptPss,
            Method::Annealing,
            Method::PssmltMultistage,
        ],
    },
    Key {
        name: "strategies",
        default: "learned",
        range: "learned|even",
        meaning: "how often the strategies of a length are tried: by the spread of what each brings to a pilot, with a quarter \
                  for all alike; or all alike",
        methods: MULTIPLEXED,
    },
    Key {
        name: "target",
        default: "xyz",
        range: "xyz|luminance",
        meaning: "scalar that the chain follows: X + Y + Z, or luminance, which starves dispersion",
        methods: METROPOLIS,
    },
    Key {
        name: "contribution",
        default: "sum",
        range: "sum|maximum",
        meaning: "how what one point contributes makes one scalar: all of it, or the largest single path",
        methods: SINGLE,
    },
    Key {
        name: "plarge",
        default: "0.3",
        range: "0 < p <= 1",
        meaning: "probability of a large step; the paper reports about 0.5 as best",
        methods: LARGE_STEPS,
    },
    Key {
        name: "mutation",
        default: "kelemen",
        range: "kelemen|kelemen:S1:S2|uniform:FRACTION",
        meaning: "small steps: exponential between S1 and S2 (1/1024 and 1/64; 0 < S1 < S2 <= 0.5), or uniform within a \
                  fraction of the domain (above 0, at most 1)",
        methods: SMALL_STEPS,
    },
    Key {
        name: "mis",
        default: "split",
        range: "split|printed|off",
        meaning: "large steps as independent samples. split: on a film of their own (unbiased); printed: with the \
                  paper's weights; off: not at all",
        methods: CHAINS,
    },
    Key {
        name: "normaliser",
        default: "running",
        range: "running|initial",
        meaning: "scale of the image. running: from the pilot and all large steps (mlt: one more bidirectional sample for \
                  every 64 mutations; where a meter runs, its passes take the pilot's place); initial: from the pilot alone \
                  (exactly unbiased; what mis=printed always does, as its weights have that constant in them)",
        methods: NORMALISED,
    },
    Key {
        name: "meter",
        default: "on",
        range: "on|off",
        meaning: "where light arrives by way of smooth glass, mirrors or water, extra samples beside the chains also estimate the \
                  scale of the image (relt: of the specific replica's part), if they estimate it better (with \
                  normaliser=running; not with contribution=maximum or mis=printed)",
        methods: METERED,
    },
    Key {
        name: "direct",
        default: "auto",
        range: "auto|lamps|together|apart",
        meaning: "which light is rendered by independent samples instead of the chains. lamps: emitters and environment seen \
                  directly (mlt, erpt: also those seen by way of mirrors and smooth glass alone; erpt-pss: none); together: \
                  none, as in the papers; apart: all paths of at most two edges; auto: lamps for relt, for the others apart \
                  where a look at the scene finds such light easily, else lamps",
        methods: DIRECT,
    },
    Key {
        name: "direct",
        default: "auto",
        range: "auto|lamps|together",
        meaning: "which light is rendered by independent samples instead of the stages. auto and lamps: emitters and environment seen \
                  directly (mlt-multistage: also those seen by way of mirrors and smooth glass alone); together: none",
        methods: STAGED,
    },
    Key {
        name: "stages",
        default: "widths",
        range: "widths|two",
        meaning: "resolution of the maps that weight the stages. widths: maps of widths 1, 2, 4, ... for a quarter of the budget, \
                  then of ten widths from half of the image's to all of it; two: a single map, of a quarter of the image's \
                  width, after a sixteenth of the budget",
        methods: STAGED,
    },
    Key {
        name: "budget",
        default: "64",
        range: "1 to 1000000",
        meaning: "mutations per pixel for which the stages are laid out, however long the render is: beyond it, a new stage of \
                  the full width begins each time the mutations have doubled",
        methods: STAGED,
    },
    Key {
        name: "floor",
        default: "0.01",
        range: "0 < floor <= 1",
        meaning: "lower bound on a pixel's value in a stage's map, as a fraction of the image's mean",
        methods: STAGED,
    },
    Key {
        name: "normaliser",
        default: "running",
        range: "running|exchange|initial",
        meaning: "what scales the replicas' films. running: all independent samples so far; exchange: what each replica tells \
                  about the next (eq. 10 of the paper, which is blind to what no chain has found); initial: the annealing's \
                  own constants",
        methods: EXCHANGE,
    },
    Key {
        name: "replicas",
        default: "standard",
        range: "standard|paper|sides|uniform;D0,D1,D2,D3,D4,D5;...",
        meaning: "targets of the chains of a ladder. Three sets have a name. standard: the paper's four, with scouts, and with \
                  tours for the specific one; paper: the same without these, as printed, except that of implicit specular \
                  light only what cannot be connected is left to the specific one; sides: path tracing and light tracing side \
                  by side. Or 2 to 8 of your own: the weights of the six classes of paths, *N for N steps a sweep, ~T for \
                  tours of T steps, @B for the replica that it stands on; uniform+N sends N scouts a sweep",
        methods: REPLICAS,
    },
    Key {
        name: "delta",
        default: "0.05",
        range: "0 < delta <= 1",
        meaning: "share of joined paths in the last of the standard replicas, which lets it exchange; the paper gives no \
                  number",
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
        range: "full|pair|alternating|matching|gibbs|none",
        meaning: "exchanges after each sweep. full: the even pairs, then the odd ones; pair: one random pair (the paper's \
                  own); alternating: even and odd pairs by turns; matching: even or odd pairs by chance; gibbs: a permutation of \
                  all (at most 5 replicas); none",
        methods: EXCHANGE,
    },
    Key {
        name: "even",
        default: "auto",
        range: "auto|0 to 256",
        meaning: "independent samples a sweep beside the chains, spread evenly over the image. auto: 8 to 256, more where \
                  light is easy to find, fewer where the specific replica alone shows much of it; a number: so many (the paper \
                  has none)",
        methods: EXCHANGE,
    },
    Key {
        name: "steps",
        default: "fine",
        range: "fine|kelemen|paper|adapted",
        meaning: "small steps. fine: 1/1024 to 16/61, of the specific replica 1/1024 to 1/64; kelemen: 1/1024 to 1/64 for all; \
                  paper: 1/61 to 16/61, of the specific replica 1/96 to 16/96; adapted: those of paper times factors that \
                  every ladder of relt adapts to an acceptance of 0.234",
        methods: REPLICAS,
    },
    Key {
        name: "particles",
        default: "10000",
        range: "10 to 1000000",
        meaning: "particles of the population annealing at the start: they choose, with what scouts find, the first states and fix the \
                  constants of the weights and the film's quantum; and of each round of annealing",
        methods: REPLICAS,
    },
    Key {
        name: "length",
        default: "300",
        range: "1 to 100000",
        meaning: "steps of each chain that spreads the light of a sample; the report tries 100 to 1000",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "chains",
        default: "auto",
        range: "auto, or 0.01 <= mean <= 100",
        meaning: "mean number of chains per sample (the report: 1, of 100 steps); brighter samples have more. auto: 0.03 where \
                  light is spread evenly over the pilot's samples, else 0.01",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "consecutive",
        default: "off",
        range: "off|1 to 100000",
        meaning: "Cline's filter: a chain that stayed in one place for more proposals than this leaves nothing for its \
                  staying; biased, light is lost (the report uses 10 and 20)",
        methods: REDISTRIBUTION,
    },
    Key {
        name: "proposed",
        default: "off",
        range: "off|1 <= kappa <= 1000000",
        meaning: "Cline's other filter, as we read it: a pixel holds at most kappa times the light of as many deposits as \
                  there were proposals into it; biased, light is lost",
        methods: ENERGY,
    },
    Key {
        name: "seeds",
        default: "path",
        range: "path|bidirectional",
        meaning: "where chains start: at all the paths of a path tracer's samples in every pixel, each with its own weight; or \
                  at one path of each sample of walks from both sides",
        methods: ENERGY,
    },
    Key {
        name: "energy",
        default: "pilot",
        range: "pilot|passes",
        meaning: "what fixes the light of a deposit: a pilot (the report's Algorithm 1), or for each pass over the image the \
                  passes of the same ladder before it",
        methods: ENERGY,
    },
    Key {
        name: "perturbations",
        default: "lens,multichain,caustic,wavelengths",
        range: "a list of lens|multichain|caustic|wavelengths",
        meaning: "what moves a path along its chain; what none of them can move stays where it was sampled",
        methods: ENERGY,
    },
    Key {
        name: "deposit",
        default: "current",
        range: "current|printed",
        meaning: "colour of a deposit: that of the path it falls on, or that of the chain's start (the report's Algorithm 2 as \
                  printed: wrong, for comparison)",
        methods: ENERGY,
    },
    Key {
        name: "caustic",
        default: "exact",
        range: "exact|printed",
        meaning: "density change of caustic perturbations: Cline's rules 2 and 5, or 5 alone (the report's section 4.2 as \
                  printed: wrong, for comparison)",
        methods: ENERGY,
    },
    Key {
        name: "mutations",
        default: "bidirectional,lens,multichain,caustic,subpath,wavelengths,time",
        range: "a list of bidirectional|lens|multichain|caustic|subpath|wavelengths|time|every[:FRACTION]",
        meaning: "what may change a path; bidirectional alone reaches every path, the others alone do not. time has a say \
                  where something moves. every moves all variables of a path by up to FRACTION (0.2; above 0, at most 1) of \
                  their domains",
        methods: VEACH,
    },
    Key {
        name: "jitter",
        default: "standard",
        range: "standard|veach|local|R1:R2",
        meaning: "pixels by which lens, multichain and caustic move what is seen: a tenth up to the radius of a twentieth of \
                  the image (veach; standard of mlt), up to a twentieth of the shorter side (local; standard of erpt), or R1 \
                  up to R2",
        methods: PATHS,
    },
    Key {
        name: "angles",
        default: "0.0001:0.1",
        range: "T1:T2",
        meaning: "radians by which multichain turns directions within the path, at most 3",
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
    photon_options::PACE,
    photon_options::TARGET_FUNCTION,
    photon_options::PSI,
    photon_options::REFINEMENT,
    photon_options::ORIENTATION,
    photon_options::NORMALISATION,
    photon_options::MAPS,
];
