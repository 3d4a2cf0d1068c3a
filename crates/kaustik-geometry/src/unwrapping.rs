use glam::DMat2;

/// How a texture lies on a surface, as far as a frame that follows it asks: by which coordinates, and how
/// they are turned and scaled for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unwrapping {
    /// Set of texture coordinates, 0 or 1.
    pub set: usize,
    /// From the set's coordinates to the texture's, but for a shift.
    pub turned: DMat2,
}

impl Default for Unwrapping {
    /// The first set as it is.
    fn default() -> Self {
        Self {
            set: 0,
            turned: DMat2::IDENTITY,
        }
    }
}
