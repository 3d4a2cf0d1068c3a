//! What settings can be chosen from.

/// How small steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SmallStep {
    /// Kelemen's: size between the two, its logarithm uniform.
    Kelemen(f64, f64),
    /// Uniform within this fraction of the domain.
    Uniform(f64),
}

/// How paths are made under a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// A walk from the camera, joined to emitters at every vertex.
    #[default]
    Unidirectional,
    /// A walk from the camera, joined at its end only.
    Endpoint,
    /// Walks from a light and from the camera, joined at their ends.
    Simple,
    /// Walks from a light and from the camera, joined everywhere.
    Bidirectional,
}

/// Which estimate of `b` scales the image, or of its parts the replicas' films.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normaliser {
    /// All independent samples, those before the chains and among their steps: consistent, and better all
    /// the time.
    #[default]
    Running,
    /// Those before the chains alone: exactly unbiased (`relt`: but for exchanges).
    Initial,
    /// What chains tell about the next: RELT eq. 10, `relt` alone.
    Exchange,
}

impl Normaliser {
    /// The word for it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Initial => "initial",
            Self::Exchange => "exchange",
        }
    }
}

/// How often `mmlt` tries the strategies of a length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategies {
    /// By the light that each brings to a pilot.
    #[default]
    Learned,
    /// All alike.
    Even,
}

/// Which paths independent samples beside the chains see to; chains leave these out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direct {
    /// Paths of one edge: emitters and surroundings seen directly. (`erpt-pss`, whose chains start in every
    /// pixel, has nothing of this.)
    #[default]
    Lamps,
    /// None.
    Together,
    /// Paths of at most two edges: light that was scattered once as well.
    Apart,
}

/// Sizes of small steps of `relt`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Steps {
    /// Those that RELT 5.1.3 prints, but for the specific replica Kelemen's.
    #[default]
    Fine,
    /// Kelemen's for all.
    Kelemen,
    /// Those that RELT 5.1.3 prints.
    Paper,
    /// Adapted by each ladder.
    Adapted,
}
