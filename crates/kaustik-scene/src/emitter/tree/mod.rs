//! Choosing among many lamps by what each may bring to the point that asks.
//!
//! A tree of the emitters that stand somewhere (Conty Estevez and Kulla, "Importance sampling of many lights with adaptive tree
//! splitting", 2018, without the splitting). On the way down each of up to four
//! groups is taken in proportion to [what it may bring](Node::shares); the same products are formed upward for the probability of a given
//! emitter. Any positive numbers would leave pictures as they are; these are near what lamps bring where nothing stands in between.

mod build;
mod cone;
mod frame;
mod group;
mod node;
#[cfg(test)]
mod tests;

use glam::DVec3;

pub(super) use build::Light;
use frame::Frame;
use node::{Below, Node};

/// The root is node 0, and without a light there is none.
#[derive(Clone, Debug, Default)]
pub(super) struct LightTree {
    nodes: Vec<Node>,
    frame: Frame,
    /// Where each node but the root hangs.
    parents: Vec<Place>,
    /// Where each emitter is, or [`Place::NONE`].
    places: Vec<Place>,
}

/// A lane of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    node: u32,
    lane: u32,
}

impl Place {
    /// Of an emitter that is not in the tree.
    const NONE: Self = Self {
        node: u32::MAX,
        lane: 0,
    };
}

impl LightTree {
    /// The emitter for `u` in [0, 1), with the probability that it is chosen at this point; `None` where none shines.
    #[inline]
    pub(super) fn choose(&self, point: DVec3, u: f64) -> Option<(usize, f64)> {
        let mut node = self.nodes.first()?;
        let point = self.frame.local(point);
        // Numbers from `low` on lead to the node, as many as its probability is.
        let (mut low, mut probability) = (0.0, 1.0);
        loop {
            let shares = node.shares(point)?;
            let mut chosen = 0;
            let mut start = low;
            for (lane, share) in shares.into_iter().enumerate() {
                // The last that has a share gets what rounding leaves over.
                if share > 0.0 && u >= low {
                    (chosen, start) = (lane, low);
                }
                low += probability * share;
            }
            low = start;
            probability *= shares[chosen];
            match node.below(chosen) {
                Below::Emitter(emitter) => return Some((emitter as usize, probability)),
                Below::Node(below) => node = &self.nodes[below as usize],
            }
        }
    }

    /// The probability of [`Self::choose`] for an emitter at this point; `None` of one that is not in the tree.
    #[inline]
    pub(super) fn probability(&self, point: DVec3, emitter: usize) -> Option<f64> {
        let mut place = *(self.places.get(emitter)).filter(|&&place| place != Place::NONE)?;
        let point = self.frame.local(point);
        let mut probability = 1.0;
        loop {
            let Some(shares) = self.nodes[place.node as usize].shares(point) else {
                return Some(0.0);
            };
            probability *= shares[place.lane as usize];
            if place.node == 0 || probability <= 0.0 {
                return Some(probability);
            }
            place = self.parents[place.node as usize];
        }
    }
}
