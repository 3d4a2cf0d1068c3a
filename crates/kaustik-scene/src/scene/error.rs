use crate::camera::CameraError;
use crate::texture::TextureError;
use kaustik_geometry::WorldError;

/// A description that cannot become a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Geometry that the ray tracer refuses.
    #[error("geometry: {0}")]
    World(#[from] WorldError),
    /// A camera that cannot be built.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// An image that does not hold what it says.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// An environment that cannot be used.
    #[error("environment: {0}")]
    Environment(String),
    /// An index that leads nowhere.
    #[error("{what} refers to {kind} {index}, but there are only {count}")]
    Reference {
        /// What refers.
        what: String,
        /// What it refers to.
        kind: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A spectrum that is no spectrum.
    #[error("material '{material}', {key}: {reason}")]
    Spectrum {
        /// The material's name.
        material: String,
        /// Key of `extras.kaustik`.
        key: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A motion that cannot be followed.
    #[error("animation of '{joint}': {reason}")]
    Animation {
        /// Name of the node.
        joint: String,
        /// What is wrong.
        reason: &'static str,
    },
    /// More emissive triangles than can be held.
    #[error("{found} emissive triangles (each instance's counted), expected at most {most}")]
    Emitters {
        /// How many there are.
        found: u64,
        /// How many there may be.
        most: u64,
    },
    /// There is no camera of the wanted name or index.
    #[error("there is no camera '{wanted}'; there are: {known}")]
    NoSuchCamera {
        /// The name asked for.
        wanted: String,
        /// Indices and names of the cameras.
        known: String,
    },
}
