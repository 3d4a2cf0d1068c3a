//! All integration tests in one binary.
#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may panic, and compares bits"
)]

/// Oracles, meshes, rays.
mod support;

/// Against a loop in double precision and against obvhs' own tree.
mod agreement;
/// Layers at equal distance, filters.
mod layers;
/// What `Mesh` and `World` refuse, and what they must survive.
mod limits;
/// What moves, against worlds that stand still.
mod motion;
/// What lies near a ball, without a ray.
mod near;
/// Rays that leave surfaces, and rays between two.
mod spawning;
/// Surfaces: normals, tangents, mirrored instances.
mod surfaces;
/// No ray leaves a closed mesh.
mod watertight;
