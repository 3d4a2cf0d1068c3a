//! Which nodes of a binary tree become the children of which wide node, for the least expected cost.
//!
//! The cost of a node or block is its surface area times what visiting it costs, whatever the number of its slots in
//! use. Let `C(n, k)` be the least cost of showing the subtree of `n` as at most `k` children of one wide node. Then
//! `C(n, 1)` is that of a block, if it fits one, or of a wide node with `n`'s own best eight children; and
//! `C(n, k) = min(C(n, k - 1), min_i C(left, i) + C(right, k - i))` (after Ylitie, Karras, Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017). It fills more slots than opening the largest
//! child greedily does.

use obvhs::bvh2::Bvh2;

use super::build::{Groups, Leaf};
use super::node::{BLOCK, WIDTH};
use crate::Aabb;

/// Cost of testing a block, in units of that of a node.
const BLOCK_COST: f32 = 1.0;

/// What the collapse knows of each binary node.
pub(crate) struct Plan<'a> {
    tree: &'a Bvh2,
    groups: &'a Groups,
    pub(crate) facts: Vec<Facts>,
}

#[derive(Clone, Copy)]
pub(crate) struct Facts {
    pub(crate) bounds: Aabb,
    /// Triangles below, counted up to one more than a block holds; an instance counts as a full block and one.
    triangles: u8,
    /// `C(n, 1)` to `C(n, 7)`.
    costs: [f32; WIDTH - 1],
}

impl Plan<'_> {
    pub(crate) fn new<'a>(
        tree: &'a Bvh2,
        groups: &'a Groups,
        leaves: &[Leaf],
        boxes: &[Aabb],
    ) -> Plan<'a> {
        let blank = Facts {
            bounds: Aabb::EMPTY,
            triangles: 0,
            costs: [0.0; WIDTH - 1],
        };
        let mut plan = Plan {
            tree,
            groups,
            facts: vec![blank; tree.nodes.len()],
        };
        for node in children_first(tree) {
            plan.facts[node] = match plan.halves(node) {
                Some((left, right)) => plan.inner(left, right),
                None => plan.leaf(plan.group(node), leaves, boxes),
            };
        }
        plan
    }

    /// The two children of a binary node, or None of a leaf.
    pub(crate) fn halves(&self, node: usize) -> Option<(usize, usize)> {
        let node = &self.tree.nodes[node];
        (!node.is_leaf()).then_some((node.first_index as usize, node.first_index as usize + 1))
    }

    /// The primitives of a leaf: as many as have the same box.
    fn group(&self, node: usize) -> &[u32] {
        let slot = self.tree.nodes[node].first_index as usize;
        self.groups.get(self.tree.primitive_indices[slot] as usize)
    }

    fn leaf(&self, group: &[u32], leaves: &[Leaf], boxes: &[Aabb]) -> Facts {
        let bounds = boxes[group[0] as usize];
        let triangle = |&p: &u32| matches!(leaves[p as usize], Leaf::Triangle { .. });
        let triangles = if group.iter().all(triangle) {
            group.len().min(BLOCK + 1)
        } else {
            BLOCK + 1
        };
        Facts {
            bounds,
            triangles: triangles as u8,
            costs: [half_area(&bounds) * BLOCK_COST; WIDTH - 1],
        }
    }

    fn inner(&self, left: usize, right: usize) -> Facts {
        let (l, r) = (&self.facts[left], &self.facts[right]);
        let bounds = l.bounds.union(&r.bounds);
        let triangles = (l.triangles + r.triangles).min(BLOCK as u8 + 1);
        let area = half_area(&bounds);
        let node = area + self.split(left, right, WIDTH).1;
        let mut costs = [node; WIDTH - 1];
        if usize::from(triangles) <= BLOCK {
            costs[0] = node.min(area * BLOCK_COST);
        }
        for k in 2..WIDTH {
            costs[k - 1] = costs[k - 2].min(self.split(left, right, k).1);
        }
        Facts {
            bounds,
            triangles,
            costs,
        }
    }

    /// How many of `k` children to give to the left, and the cost of that.
    fn split(&self, left: usize, right: usize, k: usize) -> (usize, f32) {
        let (l, r) = (&self.facts[left].costs, &self.facts[right].costs);
        let mut best = (1, f32::INFINITY);
        for i in 1..k {
            let cost = l[i - 1] + r[k - i - 1];
            if cost < best.1 {
                best = (i, cost);
            }
        }
        best
    }

    /// Whether the subtree becomes one block.
    pub(crate) fn is_block(&self, node: usize) -> bool {
        let facts = &self.facts[node];
        let fits = usize::from(facts.triangles) <= BLOCK;
        fits && facts.costs[0] >= half_area(&facts.bounds) * BLOCK_COST
    }

    /// Whether the subtree is one primitive.
    pub(crate) fn is_single(&self, node: usize) -> bool {
        self.halves(node).is_none() && self.group(node).len() == 1
    }

    /// The children that the wide node of `node` gets, in the tree's order.
    pub(crate) fn children(&self, node: usize, k: usize, out: &mut Vec<usize>) {
        let Some((left, right)) = self.halves(node) else {
            out.push(node);
            return;
        };
        let costs = &self.facts[node].costs;
        let mut k = k;
        while k > 1 && k < WIDTH && costs[k - 1] >= costs[k - 2] {
            k -= 1;
        }
        if k == 1 {
            out.push(node);
            return;
        }
        let i = self.split(left, right, k).0;
        self.children(left, i, out);
        self.children(right, k - i, out);
    }

    pub(crate) fn primitives(&self, node: usize) -> Vec<usize> {
        let (mut found, mut stack) = (Vec::new(), vec![node]);
        while let Some(node) = stack.pop() {
            match self.halves(node) {
                Some((left, right)) => stack.extend([right, left]),
                None => found.extend(self.group(node).iter().map(|&p| p as usize)),
            }
        }
        found
    }
}

/// All nodes, each after its children.
fn children_first(tree: &Bvh2) -> Vec<usize> {
    let mut order = Vec::with_capacity(tree.nodes.len());
    let mut stack = vec![0];
    while let Some(index) = stack.pop() {
        order.push(index);
        let node = &tree.nodes[index];
        if !node.is_leaf() {
            stack.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order.reverse();
    order
}

/// Half the surface. Only compared, so that an infinite one does no harm.
fn half_area(bounds: &Aabb) -> f32 {
    let e = bounds.extent();
    e.x * e.y + e.y * e.z + e.z * e.x
}
