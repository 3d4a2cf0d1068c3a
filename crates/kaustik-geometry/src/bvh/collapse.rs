//! A binary tree becomes an 8-wide one.
//!
//! [`Plan`] says which children a wide node gets; here they are written, siblings side by side.

use obvhs::bvh2::Bvh2;

use super::build::{Groups, Leaf};
use super::node::{BLOCK, Block, Bvh, Child, Kind, NEAR, Node, WIDTH};
use super::pages::settled;
use super::plan::Plan;
use super::stack::DEPTH;
use crate::Aabb;

/// Beyond this depth what is left is cut in equal parts, so that the whole cannot become deeper than [`DEPTH`]: 32
/// further bits of count are 11 levels.
const GREEDY_DEPTH: usize = DEPTH - 12;

/// Collapses `tree`, whose primitives are the `groups` of `leaves` with these `boxes`.
pub(crate) fn collapse(tree: &Bvh2, groups: &Groups, leaves: &[Leaf], boxes: &[Aabb]) -> Bvh {
    let mut wide = Bvh::default();
    if leaves.is_empty() {
        return wide;
    }
    let plan = Plan::new(tree, groups, leaves, boxes);
    let mut emit = Emit {
        plan: &plan,
        leaves,
        boxes,
        wide: &mut wide,
    };
    let root = emit.reserve(&Part::Tree(0));
    emit.fill(Part::Tree(0), root, 0);
    wide.root = Some(root);
    drop(plan);
    wide.nodes = settled(&wide.nodes);
    wide.blocks = settled(&wide.blocks);
    wide.is_near = wide.memory() <= NEAR;
    wide
}

/// Something that becomes one child.
enum Part {
    /// A binary node.
    Tree(usize),
    /// A run of primitives, where the tree is too deep to follow or their boxes are the same.
    Run(Vec<usize>),
}

struct Emit<'a> {
    plan: &'a Plan<'a>,
    leaves: &'a [Leaf],
    boxes: &'a [Aabb],
    wide: &'a mut Bvh,
}

impl Emit<'_> {
    /// Makes room for a part. Siblings lie side by side.
    fn reserve(&mut self, part: &Part) -> Child {
        let primitives = match part {
            Part::Tree(node) if self.plan.is_block(*node) => self.plan.primitives(*node),
            Part::Tree(node) if self.plan.is_single(*node) => self.plan.primitives(*node),
            Part::Run(run) if self.fits_block(run) => run.clone(),
            _ => {
                self.wide.nodes.push(Node::EMPTY);
                return Child::node(self.wide.nodes.len() - 1);
            }
        };
        self.leaf(&primitives)
    }

    fn fits_block(&self, run: &[usize]) -> bool {
        let triangle = |&p: &usize| matches!(self.leaves[p], Leaf::Triangle { .. });
        run.len() == 1 || (run.len() <= BLOCK && run.iter().all(triangle))
    }

    fn leaf(&mut self, primitives: &[usize]) -> Child {
        if let [only] = primitives
            && let Leaf::Instance { place, .. } = self.leaves[*only]
        {
            return Child::instance(place as usize);
        }
        let mut block = Block::EMPTY;
        for (lane, &p) in primitives.iter().enumerate() {
            if let Leaf::Triangle {
                corners,
                instance,
                primitive,
            } = self.leaves[p]
            {
                block.set(lane, corners, instance, primitive);
            }
        }
        self.wide.blocks.push(block);
        Child::block(self.wide.blocks.len() - 1, primitives.len())
    }

    /// Writes the node that was reserved for `part`, and all below it.
    fn fill(&mut self, part: Part, child: Child, depth: usize) {
        let Kind::Node { index } = child.kind() else {
            return;
        };
        let parts = self.divide(part, depth);
        let children: Vec<Child> = parts.iter().map(|p| self.reserve(p)).collect();
        for (slot, (part, &child)) in parts.iter().zip(&children).enumerate() {
            let bounds = self.bounds(part);
            self.wide.nodes[index].set(slot, &bounds, child);
        }
        for (part, child) in parts.into_iter().zip(children) {
            self.fill(part, child, depth + 1);
        }
    }

    fn divide(&self, part: Part, depth: usize) -> Vec<Part> {
        let run = match part {
            Part::Tree(node) if depth < GREEDY_DEPTH && self.plan.halves(node).is_some() => {
                let mut nodes = Vec::with_capacity(WIDTH);
                self.plan.children(node, WIDTH, &mut nodes);
                return nodes.into_iter().map(Part::Tree).collect();
            }
            Part::Tree(node) => self.plan.primitives(node),
            Part::Run(run) => run,
        };
        let size = run.len().div_ceil(WIDTH);
        run.chunks(size).map(|c| Part::Run(c.to_vec())).collect()
    }

    fn bounds(&self, part: &Part) -> Aabb {
        match part {
            Part::Tree(node) => self.plan.facts[*node].bounds,
            Part::Run(run) => run
                .iter()
                .fold(Aabb::EMPTY, |b, &p| b.union(&self.boxes[p])),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use obvhs::bvh2::node::Bvh2Node;

    use super::*;

    fn leaves(count: u32) -> Vec<Leaf> {
        let corner = |i: u32, k: f32| Vec3::new(i as f32, k, k * k);
        (0..count)
            .map(|i| Leaf::Triangle {
                corners: [corner(i, 0.0), corner(i, 1.0), corner(i, 2.0)],
                instance: 0,
                primitive: i,
            })
            .collect()
    }

    /// A tree in which every left child is a leaf.
    fn chain(leaves: &[Leaf]) -> Bvh2 {
        let count = leaves.len();
        let mut tree = Bvh2::zeroed(count);
        let bounds = |i: usize| {
            let b = leaves[i].bounds();
            obvhs::aabb::Aabb::new(b.min.into(), b.max.into())
        };
        tree.primitive_indices = (0..count as u32).collect();
        tree.nodes[0] = Bvh2Node::new(bounds(0), 0, 1);
        for i in 0..count - 1 {
            tree.nodes[2 * i + 1] = Bvh2Node::new(bounds(i), 1, i as u32);
            let last = i == count - 2;
            let (prims, next) = if last { (1, i + 1) } else { (0, 2 * i + 3) };
            tree.nodes[2 * i + 2] = Bvh2Node::new(bounds(i), prims, next as u32);
        }
        tree
    }

    fn visit(tree: &Bvh, child: Child, depth: usize, seen: &mut Vec<u32>) -> usize {
        match child.kind() {
            Kind::Node { index } => {
                let node = &tree.nodes[index];
                let used = node.boxes().count();
                let below = (0..used).map(|k| visit(tree, node.children[k], depth + 1, seen));
                below.max().unwrap_or(depth)
            }
            Kind::Block { index, count } => {
                seen.extend(&tree.blocks[index].primitives[..count as usize]);
                depth
            }
            Kind::Instance { .. } => depth,
        }
    }

    #[test]
    fn a_chain_does_not_become_too_deep() {
        let leaves = leaves(3000);
        let boxes: Vec<Aabb> = leaves.iter().map(Leaf::bounds).collect();
        let wide = collapse(&chain(&leaves), &Groups::new(&boxes), &leaves, &boxes);
        let mut seen = Vec::new();
        let depth = visit(&wide, wide.root.unwrap(), 0, &mut seen);
        assert!(depth > GREEDY_DEPTH && depth <= DEPTH, "{depth}");
        seen.sort_unstable();
        assert_eq!(seen, (0..3000).collect::<Vec<_>>());
    }
}
