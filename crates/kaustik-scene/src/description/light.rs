use glam::Affine3A;

/// The shape of a punctual light (`KHR_lights_punctual`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Radiates alike in all directions; intensity in radiant units per steradian.
    Point,
    /// A cone along the local -z; intensity per steradian, angles from the axis.
    Spot {
        /// Full intensity within this angle, in radians.
        inner: f32,
        /// No light outside this angle, in radians.
        outer: f32,
    },
    /// Parallel light along the local -z; `intensity` is irradiance on a facing surface.
    Directional,
}

/// A punctual light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDescription {
    /// Name, for messages.
    pub name: String,
    /// Shape.
    pub kind: LightKind,
    /// Linear Rec.709 colour, uplifted against D65.
    pub color: [f32; 3],
    /// Multiplies the colour; taken 1:1 as radiant.
    pub intensity: f32,
    /// Distance at which the light has faded to nothing; `None` is for ever.
    pub range: Option<f32>,
    /// Light to world; scale is ignored.
    pub transform: Affine3A,
}
