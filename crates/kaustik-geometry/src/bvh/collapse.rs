//! A binary tree becomes an 8-wide one of least expected cost.
//!
//! The cost of a node or block is its surface area times what visiting it costs, whatever the number of its slots in
//! use. Let `C(n, k)` be the least cost of showing the subtree of `n` as at most `k` children of one wide node. Then
//! `C(n, 1)` is that of a block, if it fits one, or of a wide node with `n`'s own best eight children; and
//! `C(n, k) = min(C(n, k - 1), min_i C(left, i) + C(right, k - i))` (after Ylitie, Karras, Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017). It fills more slots than opening the largest
//! child greedily does.

use obvhs::bvh2::Bvh2;

use super::build::{Groups, Leaf};
use super::node::{BLOCK, Block, Bvh, Child, Kind, Node, WIDTH};
use super::pages::settled;
use super::stack::DEPTH;
use crate::Aabb;

/// Cost of testing a block, in units of that of a node.
const BLOCK_COST: f32 = 1.3;

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
    wide
}

/// What the collapse knows of each binary node.
struct Plan<'a> {
    tree: &'a Bvh2,
    groups: &'a Groups,
    facts: Vec<Facts>,
}

#[derive(Clone, Copy)]
struct Facts {
    bounds: Aabb,
    /// Triangles below, counted up to one more than a block holds; an instance counts as a full block and one.
    triangles: u8,
    /// `C(n, 1)` to `C(n, 7)`.
    costs: [f32; WIDTH - 1],
}

impl Plan<'_> {
    fn new<'a>(tree: &'a Bvh2, groups: &'a Groups, leaves: &[Leaf], boxes: &[Aabb]) -> Plan<'a> {
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
    fn halves(&self, node: usize) -> Option<(usize, usize)> {
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
    fn is_block(&self, node: usize) -> bool {
        let facts = &self.facts[node];
        let fits = usize::from(facts.triangles) <= BLOCK;
        fits && facts.costs[0] >= half_area(&facts.bounds) * BLOCK_COST
    }

    /// Whether the subtree is one primitive.
    fn is_single(&self, node: usize) -> bool {
        self.halves(node).is_none() && self.group(node).len() == 1
    }

    /// The children that the wide node of `node` gets, in the tree's order.
    fn children(&self, node: usize, k: usize, out: &mut Vec<usize>) {
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

    fn primitives(&self, node: usize) -> Vec<usize> {
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
