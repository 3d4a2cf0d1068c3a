//! Meshes placed in the world, and what can be wrong with a world.

use glam::Affine3A;

use crate::MeshError;

/// A mesh placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into the world's meshes.
    pub mesh: u32,
    /// Object to world. Finite and invertible; it may mirror, which leaves the front side where glTF puts it.
    pub transform: Affine3A,
}

/// Why a world cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A mesh breaks its own rules.
    #[error("mesh {mesh}: {source}")]
    Mesh {
        /// Which mesh.
        mesh: usize,
        /// What is wrong with it.
        source: MeshError,
    },
    /// An instance names a mesh that does not exist.
    #[error("instance {instance} names mesh {mesh}, but there are only {meshes}")]
    NoSuchMesh {
        /// Which instance.
        instance: usize,
        /// The mesh that it names.
        mesh: u32,
        /// How many meshes there are.
        meshes: usize,
    },
    /// A transform has a component that is not finite, or moves its mesh beyond what `f32` holds.
    #[error("the transform of instance {instance} leaves the finite numbers")]
    NonFinite {
        /// Which instance.
        instance: usize,
    },
    /// A transform flattens its mesh.
    #[error("the transform of instance {instance} has no inverse")]
    Singular {
        /// Which instance.
        instance: usize,
    },
    /// A motion of an instance that does not exist, a second one of the same instance, or one that leaves the finite
    /// numbers.
    #[error(
        "the motion of instance {instance} is not of one of {instances}, not its only one, or not finite"
    )]
    Motion {
        /// Which instance.
        instance: usize,
        /// How many instances there are.
        instances: usize,
    },
    /// More instances or triangles than the tree has room for.
    #[error("{count} {what}: more than 2^27")]
    TooLarge {
        /// "instances" or "triangles".
        what: &'static str,
        /// How many.
        count: usize,
    },
}
