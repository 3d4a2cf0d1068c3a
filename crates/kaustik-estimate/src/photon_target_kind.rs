/// A target that chains of light paths can follow (G sec. 4.4, Fig. 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotonTargetKind {
    /// 1 everywhere.
    Uniform,
    /// 1 where the path touches a measurement point (Hachisuka and Jensen 2011).
    Visibility,
    /// The inverse size of the kernel, largest over the points touched; or what stands in its
    /// place, such as the inverse density of photons on the image (Chen et al. 2011).
    InverseKernel,
    /// The spatial target: that times the inverse density of photons (G Eq. 11).
    Full,
}

impl PhotonTargetKind {
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// All; `kind as usize` is the place of a kind.
    pub const ALL: [Self; 4] = [
        Self::Uniform,
        Self::Visibility,
        Self::InverseKernel,
        Self::Full,
    ];

    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Visibility => "visibility",
            Self::InverseKernel => "inverse-kernel",
            Self::Full => "full",
        }
    }

    /// Does it ask for more of a point than whether it is touched?
    pub const fn asks_of_points(self) -> bool {
        matches!(self, Self::InverseKernel | Self::Full)
    }
}
