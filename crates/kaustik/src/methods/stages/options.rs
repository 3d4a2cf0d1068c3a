/// How multi-stage methods lay out their stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageOptions {
    /// Mutations a pixel that the stages are laid out for; those beyond go on at full width.
    pub budget: u64,
    /// Which maps they go by.
    pub ladder: StageLadder,
    /// What a pixel counts as at least, as a share of the mean, in (0, 1].
    pub floor: f64,
}

/// Which maps stages go by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StageLadder {
    /// Ever wider ones, up to the image's own width (Hoberock and Hart 2010).
    #[default]
    Widths,
    /// One, after a short stage without any (Veach 1997).
    Two,
}

impl Default for StageOptions {
    fn default() -> Self {
        Self {
            budget: 64,
            ladder: StageLadder::default(),
            floor: 0.01,
        }
    }
}
