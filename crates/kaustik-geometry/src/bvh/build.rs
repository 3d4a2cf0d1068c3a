//! From triangles and placed trees to a wide tree.

use glam::{DVec3, Vec3};
use obvhs::aabb::Aabb as Bounds;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;

use super::collapse::collapse;
use super::divide::divide;
use super::node::Bvh;
use crate::Aabb;

/// What the tree leads to.
#[derive(Clone, Copy)]
pub(crate) enum Leaf {
    Triangle {
        corners: [Vec3; 3],
        instance: u32,
        primitive: u32,
    },
    Instance {
        place: u32,
        bounds: Aabb,
    },
}

impl Leaf {
    /// Whether no ray can meet it: a triangle without an area.
    pub(crate) fn is_degenerate(&self) -> bool {
        let Leaf::Triangle { corners, .. } = self else {
            return false;
        };
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        (b - a).cross(c - a) == DVec3::ZERO
    }

    /// A box that holds it, with room for the rounding of the distance to it: that is relative to its size, besides
    /// the distance itself, which the walk allows for.
    pub(crate) fn bounds(&self) -> Aabb {
        let tight = match self {
            Leaf::Triangle { corners, .. } => Aabb::from_points(*corners),
            Leaf::Instance { bounds, .. } => *bounds,
        };
        let room = Vec3::splat(tight.extent().max_element() * ROOM);
        Aabb {
            min: tight.min - room,
            max: tight.max + room,
        }
    }
}

/// 2^-20.
const ROOM: f32 = 1.0 / 1_048_576.0;

/// Beyond these coordinates the builder works on scaled boxes, as the products of its areas would leave `f32`.
const COMFORTABLE: f32 = (1u64 << 40) as f32;

/// No scaled box reaches that far, but one without an end.
const FARTHEST: Vec3 = Vec3::splat((1u64 << 60) as f32);

/// Builds the tree. The same bits for the same leaves, on any number of threads.
pub(crate) fn build(leaves: &[Leaf]) -> Bvh {
    let boxes: Vec<Aabb> = leaves.iter().map(Leaf::bounds).collect();
    let groups = Groups::new(&boxes);
    let scale = scale(&boxes);
    let scaled: Vec<Bounds> = groups
        .iter()
        .map(|group| &boxes[group[0] as usize])
        .map(|b| {
            // the room around the largest numbers is infinite
            let [min, max] = [b.min, b.max].map(|p| (p * scale).clamp(-FARTHEST, FARTHEST));
            Bounds::new(min.into(), max.into())
        })
        .collect();
    collapse(&binary(&scaled), &groups, leaves, &boxes)
}

/// Leaves with the same box. The builder sees each box once: it takes quadratic time over equal ones.
pub(crate) struct Groups {
    /// Leaves, group by group.
    members: Vec<u32>,
    /// Where each group begins, and the end of the last.
    starts: Vec<u32>,
}

impl Groups {
    pub(crate) fn new(boxes: &[Aabb]) -> Groups {
        let key = |&i: &u32| {
            let b = &boxes[i as usize];
            [b.min, b.max].map(|p| p.to_array().map(f32::to_bits))
        };
        let mut members: Vec<u32> = (0..boxes.len() as u32).collect();
        members.sort_by_cached_key(key);
        let mut starts = vec![0];
        for i in 1..=members.len() {
            if i == members.len() || key(&members[i]) != key(&members[i - 1]) {
                starts.push(i as u32);
            }
        }
        Groups { members, starts }
    }

    /// The leaves of a group; there is always one.
    pub(crate) fn get(&self, group: usize) -> &[u32] {
        &self.members[self.starts[group] as usize..self.starts[group + 1] as usize]
    }

    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.starts.len() - 1).map(|group| self.get(group))
    }
}

/// Share of the nodes that are put to a better place, and how many nodes a long line may meet for that: among
/// boxes that overlap more than any scene's do, looking for the place takes as long as there are boxes, and
/// so fewer are tried.
const REINSERTED: f32 = 0.25;
const USUAL_NODES: f64 = 2000.0;

/// Parts and clusters, then reinsertion of the nodes that cost most.
fn binary(boxes: &[Bounds]) -> Bvh2 {
    let mut tree = divide(boxes);
    let share = REINSERTED * (USUAL_NODES / met(&tree)).min(1.0) as f32;
    ReinsertionOptimizer::default().run(&mut tree, share, None);
    tree
}

/// How many nodes a line through the whole meets in the mean: the sum of their areas over that of the root.
fn met(tree: &Bvh2) -> f64 {
    let area = |node: &Bvh2Node| {
        let [x, y, z] = node.aabb().diagonal().to_array().map(f64::from);
        x * y + y * z + z * x
    };
    let sum: f64 = tree.nodes.iter().map(area).sum();
    let root = tree.nodes.first().map_or(0.0, area);
    if root > 0.0 { sum / root } else { 1.0 }
}

/// A power of two that brings the boxes to comfortable coordinates; mostly one.
fn scale(boxes: &[Aabb]) -> f32 {
    let reach = boxes
        .iter()
        .map(|b| b.min.abs().max(b.max.abs()).max_element())
        .fold(0.0, f32::max);
    if reach > COMFORTABLE {
        1.0 / COMFORTABLE / COMFORTABLE
    } else if reach < 1.0 / COMFORTABLE && reach > 0.0 {
        COMFORTABLE * COMFORTABLE
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy square, by exact arithmetic alone.
    fn leaves(n: u32) -> Vec<Leaf> {
        let point = |i: u32, j: u32| {
            let height = (i * i * 7 + j * j * 13 + i * j * 5) % 97;
            Vec3::new(i as f32, height as f32 / 64.0, j as f32)
        };
        (0..n * n * 2)
            .map(|k| {
                let (i, j) = (k / 2 / n, k / 2 % n);
                let far = if k % 2 == 0 {
                    point(i + 1, j)
                } else {
                    point(i, j + 1)
                };
                Leaf::Triangle {
                    corners: [point(i, j), point(i + 1, j + 1), far],
                    instance: 0,
                    primitive: k,
                }
            })
            .collect()
    }

    /// All bits of a tree's nodes, in one number (FNV).
    fn fingerprint(tree: &Bvh) -> u64 {
        let mix = |hash: u64, word: u32| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
        let node = |hash: u64, node: &super::super::node::Node| {
            let planes = node.planes.as_flattened().as_flattened();
            let hash = planes.iter().fold(hash, |h, x| mix(h, x.to_bits()));
            node.children.iter().fold(hash, |h, c| mix(h, c.bits()))
        };
        let hash = tree.nodes.iter().fold(0xcbf2_9ce4_8422_2325, node);
        let primitives = tree.blocks.iter().flat_map(|b| b.primitives);
        primitives.fold(hash, mix)
    }

    /// The same on any number of threads. (Where the builder sorts equal keys, its two variants order them differently,
    /// so that there is a tree with the feature `parallel` and one without; hits do not depend on the tree.)
    #[test]
    fn the_tree_is_the_same_everywhere() {
        let tree = build(&leaves(200));
        assert_eq!(fingerprint(&tree), PINNED, "{:#x}", fingerprint(&tree));
    }

    /// Triangles that all overlap: a place for one is looked for among all others, unless few are tried.
    #[test]
    fn a_crowd_that_overlaps_is_built_soon() {
        let corner = |i: u32, turn: u32| {
            let number = (3 * i + turn).wrapping_mul(0x9e37_79b9);
            Vec3::from([0, 11, 22].map(|shift| ((number >> shift) & 1023) as f32))
        };
        let leaves: Vec<Leaf> = (0..300_000)
            .map(|i| Leaf::Triangle {
                corners: [0, 1, 2].map(|turn| corner(i, turn)),
                instance: 0,
                primitive: i,
            })
            .collect();
        let start = std::time::Instant::now();
        let tree = build(&leaves);
        assert!(!tree.blocks.is_empty());
        let taken = start.elapsed().as_secs_f64();
        assert!(taken < 15.0, "{taken} s");
    }

    /// Changes where the builder, its settings or its costs change, and only there.
    #[cfg(not(feature = "parallel"))]
    const PINNED: u64 = 0xdd85_ffa9_d24e_21c5;
    #[cfg(feature = "parallel")]
    const PINNED: u64 = 0xc18f_6bca_825b_ed83;
}
