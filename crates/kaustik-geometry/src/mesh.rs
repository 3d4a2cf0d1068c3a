//! Indexed triangle meshes.
//!
//! The fields are public, because loaders fill them and lights read them. What holds for a checked mesh is therefore
//! checked again by [`World::build`](crate::World::build), once, so that no query needs to.

use glam::{Vec2, Vec3, Vec4};

use crate::Aabb;

/// Triangles over shared vertices, in the mesh's own space. Counter-clockwise seen from the front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, finite.
    pub positions: Vec<Vec3>,
    /// Three vertices a triangle.
    pub indices: Vec<[u32; 3]>,
    /// Shading normals, one a vertex, or empty. Need not be unit; where the interpolated normal is zero or not finite
    /// the geometric one is used.
    pub normals: Vec<Vec3>,
    /// Tangents with the sign of the bitangent in `w` (glTF: `bitangent = cross(normal, tangent) * w`), or empty.
    pub tangents: Vec<Vec4>,
    /// Two sets of texture coordinates, each one a vertex, or empty. Finite.
    pub uv: [Vec<Vec2>; 2],
    /// Linear RGBA, one a vertex, or empty (then white, opaque). Finite.
    pub colors: Vec<[f32; 4]>,
}

/// What is wrong with a mesh, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A value is infinite or not a number.
    #[error("{attribute} of vertex {vertex} is not finite")]
    NonFinite {
        /// Name of the attribute.
        attribute: &'static str,
        /// Which vertex.
        vertex: usize,
    },
    /// An attribute has neither no values nor one a vertex.
    #[error("{found} values of {attribute} for {vertices} vertices")]
    Length {
        /// Name of the attribute.
        attribute: &'static str,
        /// How many values it has.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More vertices or triangles than 32 bits count.
    #[error("{count} {what}: more than 2^31")]
    TooLarge {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many.
        count: usize,
    },
}

impl Mesh {
    /// A mesh of positions and triangles alone; attributes are added by the `with_` methods.
    ///
    /// # Errors
    /// An index out of range, or a position that is not finite.
    pub fn new(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        Mesh {
            positions,
            indices,
            ..Mesh::default()
        }
        .checked()
    }

    /// The same mesh with these shading normals.
    ///
    /// # Errors
    /// [`MeshError::Length`].
    pub fn with_normals(self, normals: Vec<Vec3>) -> Result<Mesh, MeshError> {
        Mesh { normals, ..self }.checked()
    }

    /// The same mesh with these tangents.
    ///
    /// # Errors
    /// [`MeshError::Length`].
    pub fn with_tangents(self, tangents: Vec<Vec4>) -> Result<Mesh, MeshError> {
        Mesh { tangents, ..self }.checked()
    }

    /// The same mesh with these two sets of texture coordinates (either may be empty).
    ///
    /// # Errors
    /// [`MeshError::Length`], [`MeshError::NonFinite`].
    pub fn with_uv(self, uv: [Vec<Vec2>; 2]) -> Result<Mesh, MeshError> {
        Mesh { uv, ..self }.checked()
    }

    /// The same mesh with these linear vertex colours.
    ///
    /// # Errors
    /// [`MeshError::Length`], [`MeshError::NonFinite`].
    pub fn with_colors(self, colors: Vec<[f32; 4]>) -> Result<Mesh, MeshError> {
        Mesh { colors, ..self }.checked()
    }

    /// Itself, if [`Mesh::check`] finds nothing.
    ///
    /// # Errors
    /// As [`Mesh::check`].
    pub fn checked(self) -> Result<Mesh, MeshError> {
        self.check()?;
        Ok(self)
    }

    /// Whether lengths agree, indices are in range, and positions, texture coordinates and colours are finite.
    /// Degenerate triangles are no error: no ray ever meets them.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        count("vertices", vertices)?;
        count("triangles", self.indices.len())?;
        length("normals", self.normals.len(), vertices)?;
        length("tangents", self.tangents.len(), vertices)?;
        length("uv 0", self.uv[0].len(), vertices)?;
        length("uv 1", self.uv[1].len(), vertices)?;
        length("colors", self.colors.len(), vertices)?;
        finite("position", &self.positions, |p| p.is_finite())?;
        finite("uv 0", &self.uv[0], |p| p.is_finite())?;
        finite("uv 1", &self.uv[1], |p| p.is_finite())?;
        finite("color", &self.colors, |c| c.iter().all(|x| x.is_finite()))?;
        for (triangle, corners) in self.indices.iter().enumerate() {
            for &vertex in corners {
                if vertex as usize >= vertices {
                    return Err(MeshError::IndexOutOfRange {
                        triangle,
                        vertex,
                        vertices,
                    });
                }
            }
        }
        Ok(())
    }

    /// No attributes: positions and triangles alone?
    pub(crate) fn is_bare(&self) -> bool {
        self.normals.is_empty()
            && self.tangents.is_empty()
            && self.uv.iter().all(Vec::is_empty)
            && self.colors.is_empty()
    }

    /// How many triangles it has.
    pub fn triangle_count(&self) -> usize {
        self.indices.len()
    }

    /// The corners of a triangle, in the mesh's own space.
    ///
    /// # Panics
    /// Where `primitive` is not below [`Mesh::triangle_count`].
    #[inline]
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        self.indices[primitive as usize].map(|i| self.positions[i as usize])
    }

    /// The box around all positions that a triangle names.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(
            self.indices
                .iter()
                .flatten()
                .map(|&i| self.positions[i as usize]),
        )
    }

    /// Bytes that the arrays take.
    pub fn memory(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.indices[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.tangents[..])
            + size_of_val(&self.uv[0][..])
            + size_of_val(&self.uv[1][..])
            + size_of_val(&self.colors[..])
    }
}

fn count(what: &'static str, count: usize) -> Result<(), MeshError> {
    if count >= 1 << 31 {
        return Err(MeshError::TooLarge { what, count });
    }
    Ok(())
}

fn length(attribute: &'static str, found: usize, vertices: usize) -> Result<(), MeshError> {
    if found != 0 && found != vertices {
        return Err(MeshError::Length {
            attribute,
            found,
            vertices,
        });
    }
    Ok(())
}

fn finite<T>(
    attribute: &'static str,
    values: &[T],
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), MeshError> {
    match values.iter().position(|v| !is_finite(v)) {
        Some(vertex) => Err(MeshError::NonFinite { attribute, vertex }),
        None => Ok(()),
    }
}
