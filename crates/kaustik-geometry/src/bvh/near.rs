//! The triangles about a place, without a ray.

use glam::{Affine3A, Vec3};

use super::node::{Bvh, Child, Kind, Node, WIDTH};
use super::prepared::{WIDEN, reach};
use super::walk::{PlacedTree, PlacedTrees};
use crate::Aabb;

/// A look for what is near, at an instant.
pub(crate) struct Near<'a> {
    /// What the world's tree leads to.
    pub(crate) places: &'a PlacedTrees,
    /// In [0, 1]: where what moves stands.
    pub(crate) time: f32,
}

impl Near<'_> {
    /// Offers instance and corners (world space, in the mesh's order) of every triangle of a tree whose box touches the
    /// given one, until one counts; whether one did.
    pub(crate) fn any(
        &self,
        bvh: &Bvh,
        bounds: &Aabb,
        counts: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        (bvh.root).is_some_and(|root| self.below(bvh, root, None, bounds, counts))
    }

    /// The same of what lies below a child; no deeper than the tree.
    fn below(
        &self,
        bvh: &Bvh,
        child: Child,
        place: Option<&PlacedTree>,
        bounds: &Aabb,
        counts: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        match child.kind() {
            Kind::Node { index } => {
                let node = &bvh.nodes[index];
                let mut mask = touched(node, bounds);
                while mask != 0 {
                    let slot = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    if self.below(bvh, node.children[slot], place, bounds, counts) {
                        return true;
                    }
                }
                false
            }
            Kind::Block { index, count } => {
                let block = &bvh.blocks[index];
                (0..count as usize).any(|lane| {
                    let corners = block.corners(lane);
                    touch(&Aabb::from_points(corners), bounds)
                        && match place {
                            None => counts(block.instances[lane], corners),
                            Some(place) => {
                                let to_world = |p| place.to_world.transform_point3(p);
                                counts(place.instance, corners.map(to_world))
                            }
                        }
                })
            }
            Kind::Instance { index } => self.inside(index, bounds, counts),
        }
    }

    /// The same of an instance's own tree.
    fn inside(
        &self,
        index: u32,
        bounds: &Aabb,
        counts: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        let Some(place) = self.places.at(index, self.time) else {
            return false;
        };
        let bvh = &self.places.trees[place.tree as usize];
        let turned = around(&place.to_object, bounds);
        (bvh.root).is_some_and(|root| self.below(bvh, root, Some(&place), &turned, counts))
    }
}

/// The box around a box that is turned, and what rounding may have moved it by; everything where numbers end.
fn around(to_object: &Affine3A, bounds: &Aabb) -> Aabb {
    let (center, half) = (bounds.center(), bounds.extent() * 0.5);
    let rounding = (reach(to_object, center) + to_object.translation.abs()) * (WIDEN - 1.0);
    let half = Vec3::from(reach(to_object, half) + rounding);
    let center = to_object.transform_point3(center);
    if !(center.is_finite() && half.is_finite()) {
        return Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        };
    }
    Aabb {
        min: center - half,
        max: center + half,
    }
}

/// The children whose boxes touch another, one bit each.
#[inline]
fn touched(node: &Node, bounds: &Aabb) -> u32 {
    let mut apart = [false; WIDTH];
    for axis in 0..3 {
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        let [least, greatest] = &node.planes[axis];
        for slot in 0..WIDTH {
            // a slot that holds nothing touches nothing, not even a box without end
            apart[slot] |=
                (least[slot] > high) | (greatest[slot] < low) | (least[slot] > greatest[slot]);
        }
    }
    (0..WIDTH).fold(0, |mask, slot| mask | u32::from(!apart[slot]) << slot)
}

#[inline]
fn touch(a: &Aabb, b: &Aabb) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}
