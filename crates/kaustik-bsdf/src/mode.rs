/// Which way a walk goes against the flow of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// The walk comes from the camera: `wo` points to the eye, light flows from `wi` to `wo`.
    Radiance,
    /// The walk comes from a light: `wo` points to the light, light flows from `wo` to `wi`.
    Importance,
}
