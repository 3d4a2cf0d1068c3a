use std::sync::Arc;

use glam::Quat;

use super::ImageData;

/// Light from infinitely far away.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentDescription {
    /// The same radiance from everywhere: linear Rec.709, uplifted against D65.
    Constant([f32; 3]),
    /// An equirectangular picture of radiance, linear Rec.709: the top row is straight up
    /// (+y), the middle column looks along -z, +x lies to the right of it.
    Image {
        /// The picture.
        image: Arc<ImageData>,
        /// Multiplies every value.
        strength: f32,
        /// Turns the picture into the world.
        rotation: Quat,
    },
}
