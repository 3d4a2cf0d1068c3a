//! Choosing among many lamps by what each may bring to the point that asks.
//!
//! A tree of the emitters that stand somewhere (Conty Estevez and Kulla, "Importance sampling of many lights with adaptive tree
//! splitting", 2018, without the splitting). On the way down each of two
//! groups is taken in proportion to [`Bound::importance`]; the same products are formed upward for the probability of a given
//! emitter. Any positive numbers would leave pictures as they are; these are near what lamps bring where nothing stands in between.

mod bound;
mod build;
mod cone;

use glam::DVec3;

use bound::Bound;
pub(super) use build::Light;

/// Marks an emitter that is not in the tree.
const NONE: u32 = u32::MAX;

/// Each inner node has two children, which are neighbours in `nodes`; the root is node 0, alone.
#[derive(Clone, Debug, Default)]
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// The inner node above each.
    parents: Vec<u32>,
    /// For each emitter its leaf, or [`NONE`].
    leaf_of: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bound: Bound,
    /// The emitter of a leaf; otherwise the first of the children.
    link: u32,
    is_leaf: bool,
}

impl Node {
    /// To be filled.
    const EMPTY: Self = Self {
        bound: Bound::NOTHING,
        link: 0,
        is_leaf: true,
    };
}

impl LightTree {
    /// The emitter for `u` in [0, 1), with the probability that it is chosen at this point; `None` where none shines.
    #[inline]
    pub(super) fn choose(&self, point: DVec3, u: f64) -> Option<(usize, f64)> {
        let mut node = self.nodes.first()?;
        // Numbers from `low` on lead to the node, as many as its probability is.
        let (mut low, mut probability) = (0.0, 1.0);
        while !node.is_leaf {
            let first = node.link as usize;
            let share = self.share(first, first + 1, point)?;
            let middle = low + probability * share;
            if u < middle {
                probability *= share;
                node = &self.nodes[first];
            } else {
                low = middle;
                probability *= 1.0 - share;
                node = &self.nodes[first + 1];
            }
        }
        Some((node.link as usize, probability))
    }

    /// The probability of [`Self::choose`] for an emitter at this point; `None` of one that is not in the tree.
    #[inline]
    pub(super) fn probability(&self, point: DVec3, emitter: usize) -> Option<f64> {
        let leaf = self.leaf_of.get(emitter).filter(|&&leaf| leaf != NONE)?;
        let mut node = *leaf as usize;
        let mut probability = 1.0;
        while node != 0 {
            // Children stand in pairs behind the root, so that the first of a pair has an odd number.
            let first = (node - 1) | 1;
            let Some(share) = self.share(first, first + 1, point) else {
                return Some(0.0);
            };
            probability *= match node == first {
                true => share,
                false => 1.0 - share,
            };
            node = self.parents[node] as usize;
        }
        Some(probability)
    }

    /// The first one's part of what comes from two nodes; `None` if nothing does.
    #[inline]
    fn share(&self, first: usize, second: usize, point: DVec3) -> Option<f64> {
        let a = self.nodes[first].bound.importance(point);
        let b = self.nodes[second].bound.importance(point);
        let sum = a + b;
        (sum > 0.0).then(|| a / sum)
    }
}
