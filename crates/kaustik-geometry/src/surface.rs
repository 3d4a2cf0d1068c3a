//! The geometry at a hit, and how rays leave it.
//!
//! # Leaving a surface
//! A position is interpolated in double precision from exactly the corners that the traversal sees and rounded once, so
//! it is off the plane of its triangle by at most half an ulp in each coordinate. [`offset_origin`] moves it along the
//! geometric normal by that bound and rounds away from the surface (in the manner of PBRT 6.8): the new origin is
//! strictly on the wanted side, by one or two ulps. The bound is relative to the coordinates, so that nothing depends
//! on the scale of the scene. That is enough because the traversal decides in double precision on which side of a
//! triangle a ray begins and ends whenever single precision is in doubt.

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::standing::Pose;
use crate::{Mesh, Unwrapping};

/// The geometry of a triangle at one point, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point.
    pub position: Vec3,
    /// Bound on the rounding error of `position`, not negative, for each coordinate.
    pub position_error: Vec3,
    /// Unit normal of the triangle on its front side: the one from which glTF sees its corners counter-clockwise,
    /// also where the instance mirrors. `Z` for a degenerate triangle.
    pub geometric_normal: Vec3,
    /// Unit interpolated normal, as the mesh gives it: not turned towards the ray or the geometric normal.
    /// The geometric normal where the mesh has none.
    pub shading_normal: Vec3,
    /// Both sets of texture coordinates; zero where the mesh has none.
    pub uv: [Vec2; 2],
    /// Linear RGBA of the vertices; ones where the mesh has none.
    pub color: [f32; 4],
    /// Whether the ray came from the front side. True without a ray.
    pub front: bool,
}

impl Surface {
    /// A bare point of a plane: a position rounded once to single precision, with its bound, and the plane's unit
    /// normal; no attributes.
    #[inline]
    pub fn bare(position: Vec3, normal: Vec3) -> Self {
        Self {
            position,
            position_error: rounding(position),
            geometric_normal: normal,
            shading_normal: normal,
            uv: [Vec2::ZERO; 2],
            color: [1.0; 4],
            front: true,
        }
    }
}

/// The surface's point moved off it to the side into which `direction` points, by as little as is certain to be on that
/// side (one or two ulps of the coordinates). The scale of the scene and the length of `direction` do not matter.
#[inline]
pub fn offset_origin(surface: &Surface, direction: Vec3) -> Vec3 {
    let error = surface.position_error;
    offset_point(surface.position, error, surface.geometric_normal, direction)
}

/// The same of a point with this error on a plane with this normal.
#[inline]
pub(crate) fn offset_point(position: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    // By a factor, because the side is a matter of chance.
    let side = if normal.dot(direction) < 0.0 {
        -1.0
    } else {
        1.0
    };
    let n = normal * side;
    let moved = position + n * n.abs().dot(error);
    Vec3::new(away(moved.x, n.x), away(moved.y, n.y), away(moved.z, n.z))
}

/// The neighbour of `x` in the direction of `n`: as `next_up` or `next_down`, by selects instead of jumps.
#[inline]
fn away(x: f32, n: f32) -> f32 {
    let step = i32::from(n > 0.0) - i32::from(n < 0.0);
    // The bits of a float grow with its size, whatever its sign.
    let outward = if x < 0.0 { -step } else { step };
    let moved = f32::from_bits((x.to_bits() as i32).wrapping_add(outward) as u32);
    if x == 0.0 {
        step as f32 * f32::from_bits(1)
    } else {
        moved
    }
}

/// A triangle's corners in world space, and the mesh and the pose that they come from.
pub(crate) struct Corners<'a> {
    pub(crate) mesh: &'a Mesh,
    /// The mesh has positions alone.
    pub(crate) bare: bool,
    pub(crate) pose: &'a Pose,
    pub(crate) primitive: u32,
    /// World space, exactly as the traversal sees them.
    pub(crate) positions: [DVec3; 3],
}

impl Corners<'_> {
    /// The surface at barycentric weights `u`, `v`, seen along `direction` (zero: from the front).
    ///
    /// Always inlined, and into the caller's slot: the fields go where they stay instead of through a copy on the
    /// stack, which waits for stores of other sizes. For the same reason its position, geometric and shading normal
    /// are returned as well.
    #[inline(always)]
    pub(crate) fn write_surface(
        &self,
        u: f32,
        v: f32,
        direction: Vec3,
        surface: &mut Surface,
    ) -> [Vec3; 3] {
        let weights = [
            1.0 - f64::from(u) - f64::from(v),
            f64::from(u),
            f64::from(v),
        ];
        let [p0, p1, p2] = self.positions;
        let edges = [p1 - p0, p2 - p0];
        let normal = edges[0].cross(edges[1]) * self.pose.handedness;
        let double_area = normal.length();
        let geometric = unit(normal, double_area).unwrap_or(DVec3::Z);
        let inner = if self.is_inner(weights, edges, double_area) {
            weights
        } else {
            self.off_edges(weights, double_area)
        };
        let position = (p0 * inner[0] + p1 * inner[1] + p2 * inner[2]).as_vec3();
        let normal = geometric.as_vec3();
        *surface = Surface::bare(position, normal);
        surface.front = geometric.dot(direction.as_dvec3()) <= 0.0;
        if self.bare {
            return [position, normal, normal];
        }
        self.write_attributes(weights, surface);
        [position, normal, surface.shading_normal]
    }

    /// What the mesh gives besides positions. Apart, so that bare meshes do not carry its code along.
    #[inline(never)]
    fn write_attributes(&self, weights: [f64; 3], surface: &mut Surface) {
        if let Some(normal) = self.shading_normal(weights) {
            surface.shading_normal = normal.as_vec3();
        }
        surface.uv = [self.uv(0, weights), self.uv(1, weights)];
        surface.color = self.color(weights);
    }

    /// See [`World::tangent`](crate::World::tangent).
    pub(crate) fn tangent(&self, u: f32, v: f32, normal: Vec3, along: &Unwrapping) -> Option<Vec4> {
        let weights = [
            1.0 - f64::from(u) - f64::from(v),
            f64::from(u),
            f64::from(v),
        ];
        let corner = self.mesh.indices[self.primitive as usize].map(|i| i as usize);
        let normal = normal.as_dvec3();
        self.given_tangent(weights, normal)
            .or_else(|| self.derived_tangent(corner, normal, along))
    }

    /// Certainly so far from all edges that [`Self::off_edges`] changes nothing? Most points are. Nothing is
    /// compared but bounds: the instance's on the reach, and no edge is longer than the sum of the first two.
    #[inline]
    fn is_inner(&self, weights: [f64; 3], edges: [DVec3; 2], double_area: f64) -> bool {
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let smallest = least(least(weights[0], weights[1]), weights[2]);
        let distance = smallest * double_area;
        let reach = self.pose.reach * EDGE;
        let longest = 2.0001 * (edges[0].length_squared() + edges[1].length_squared());
        smallest > 0.0 && distance * distance >= reach * reach * longest
    }

    /// The weights, moved so that the point keeps some ulps from each edge. Next to an edge, rounding could otherwise
    /// put it behind the neighbouring triangle, where two walls meet, and a ray that leaves it would be outside.
    #[cold]
    fn off_edges(&self, weights: [f64; 3], double_area: f64) -> [f64; 3] {
        let [a, b, c] = self.positions;
        let edges = [
            b.distance_squared(c),
            c.distance_squared(a),
            a.distance_squared(b),
        ];
        let longest = edges[0].max(edges[1]).max(edges[2]);
        // A weight is the distance from an edge in units of the height above it.
        let reach = self.reach() * EDGE;
        let smallest = weights[0].min(weights[1]).min(weights[2]);
        let distance = smallest * double_area;
        if smallest > 0.0 && distance * distance >= reach * reach * longest {
            return weights;
        }
        let least = (reach * longest.sqrt() / double_area).min(1.0 / 3.0);
        let kept = weights.map(|w| w.max(least));
        kept.map(|w| w / (kept[0] + kept[1] + kept[2]))
    }

    /// The size of the numbers whose rounding may move a ray sideways: the corners', and those that sum up to them
    /// where rays are taken into the mesh's own space.
    fn reach(&self) -> f64 {
        let [a, b, c] = self.positions.map(DVec3::abs);
        let corners = a.max(b).max(c).max_element();
        match self.pose.translation() {
            None => corners,
            Some(translation) => {
                let size = self.positions.map(|p| (p - translation).abs());
                let size = size[0].max(size[1]).max(size[2]).max_element();
                corners + size + translation.abs().max_element()
            }
        }
    }

    fn shading_normal(&self, weights: [f64; 3]) -> Option<DVec3> {
        let normal = self.blend(&self.mesh.normals, weights, |n| n.as_dvec3())?;
        let turned = if self.pose.identity {
            normal
        } else {
            self.pose.normals * normal
        };
        unit(turned, turned.length())
    }

    /// Tangents without normals are no frame: glTF has them ignored.
    fn given_tangent(&self, weights: [f64; 3], normal: DVec3) -> Option<Vec4> {
        if self.mesh.normals.is_empty() {
            return None;
        }
        let tangent = self.blend(&self.mesh.tangents, weights, |t| t.truncate().as_dvec3())?;
        let first = self.mesh.indices[self.primitive as usize][0];
        let sign = f64::from(self.mesh.tangents[first as usize].w.signum()) * self.pose.handedness;
        frame_tangent(self.pose.linear * tangent, normal, sign)
    }

    /// From dp/du. glTF's `v` runs down the picture while the bitangent of a normal map runs up.
    fn derived_tangent(
        &self,
        corner: [usize; 3],
        normal: DVec3,
        along: &Unwrapping,
    ) -> Option<Vec4> {
        let uv = &self.mesh.uv[along.set];
        if uv.is_empty() {
            return None;
        }
        let [a, b, c] = corner.map(|i| along.turned * uv[i].as_dvec2());
        let (s, t) = (b - a, c - a);
        let area = s.perp_dot(t);
        if area == 0.0 {
            return None;
        }
        let [p0, p1, p2] = self.positions;
        let along_u = ((p1 - p0) * t.y - (p2 - p0) * s.y) * area.signum();
        let along_v = ((p2 - p0) * s.x - (p1 - p0) * t.x) * area.signum();
        let sign = if normal.cross(along_u).dot(along_v) > 0.0 {
            -1.0
        } else {
            1.0
        };
        frame_tangent(along_u, normal, sign)
    }

    #[inline]
    pub(crate) fn uv(&self, set: usize, weights: [f64; 3]) -> Vec2 {
        self.blend(&self.mesh.uv[set], weights, |t| t.as_dvec2().extend(0.0))
            .map_or(Vec2::ZERO, |t| t.truncate().as_vec2())
    }

    #[inline]
    pub(crate) fn color(&self, weights: [f64; 3]) -> [f32; 4] {
        if self.mesh.colors.is_empty() {
            return [1.0; 4];
        }
        let [a, b, c] =
            self.mesh.indices[self.primitive as usize].map(|i| self.mesh.colors[i as usize]);
        std::array::from_fn(|k| {
            (f64::from(a[k]) * weights[0]
                + f64::from(b[k]) * weights[1]
                + f64::from(c[k]) * weights[2]) as f32
        })
    }

    #[inline]
    fn blend<T>(
        &self,
        values: &[T],
        weights: [f64; 3],
        widen: impl Fn(&T) -> DVec3,
    ) -> Option<DVec3> {
        if values.is_empty() {
            return None;
        }
        let [a, b, c] =
            self.mesh.indices[self.primitive as usize].map(|i| widen(&values[i as usize]));
        Some(a * weights[0] + b * weights[1] + c * weights[2])
    }
}

/// How far a point keeps from the edges of its triangle, as a fraction of its coordinates: 2^-20, sixteen
/// roundings.
const EDGE: f64 = 1.0 / 1_048_576.0;

/// `v` over its length, if that is a length to divide by.
#[inline]
fn unit(v: DVec3, length: f64) -> Option<DVec3> {
    (length > 0.0 && length.is_finite()).then(|| v / length)
}

/// The part of `tangent` orthogonal to `normal`, with a sign.
fn frame_tangent(tangent: DVec3, normal: DVec3, sign: f64) -> Option<Vec4> {
    let across = tangent.try_normalize()?.reject_from_normalized(normal);
    Some(across.try_normalize()?.as_vec3().extend(sign as f32))
}

/// Half an ulp of each coordinate, and what double precision loses before.
#[inline]
pub(crate) fn rounding(position: Vec3) -> Vec3 {
    position.abs() * (f32::EPSILON * 0.501) + Vec3::splat(f32::MIN_POSITIVE)
}
