/// Which way a walk goes against the flow of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// The walk comes from the camera: `wo` points to the eye, light flows from `wi` to `wo`.
    Radiance,
    /// The walk comes from a light: `wo` points to the light, light flows from `wo` to `wi`.
    Importance,
}

impl Mode {
    /// That of a walk the other way.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}
