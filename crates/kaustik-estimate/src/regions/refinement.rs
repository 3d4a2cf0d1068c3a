/// When regions are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refinement {
    /// Where both halves of the statistics agree and there are enough of them.
    Adaptive {
        /// Light paths that have touched each half of a region.
        least: u32,
        /// Percent by which the halves of its statistics may differ.
        percent: u32,
    },
    /// Always down to the leaves, but each region's estimate is [shrunk
    /// towards](super::Regions::shrunk_densities) its parent's until many more than `paths` light paths
    /// have touched it.
    Shrunk {
        /// Light paths that what is known of the larger region counts for.
        paths: u32,
    },
    /// All, once an iteration.
    Iterations,
    /// Never.
    Off,
}

impl Refinement {
    /// G sec. 4.2: 10,000 light paths, and halves that differ by less than 5 %.
    pub const PUBLISHED: Self = Self::Adaptive {
        least: 10_000,
        percent: 5,
    };
    /// Sooner: a target that is off by a fifth costs a tenth of the noise at most, one that knows nothing of
    /// where light is seldom costs all.
    pub const EARLY: Self = Self::Adaptive {
        least: 200,
        percent: 30,
    };
    /// At once. What is around a region counts for 20 light paths: those of a chain resemble each other, and
    /// tell less than as many that were drawn apart.
    pub const SHRUNK: Self = Self::Shrunk { paths: 20 };
}
