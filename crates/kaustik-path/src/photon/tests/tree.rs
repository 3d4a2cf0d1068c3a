//! The other way to find discs: a balanced k-d tree over their centres, each node with the largest radius
//! below it. Kept to be measured against [`Lookup`](crate::Lookup), and to agree with it.

use glam::Vec3;

pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy)]
struct Node {
    center: Vec3,
    squared: f32,
    /// Largest radius of this node and those below.
    reach: f32,
    axis: u8,
    index: u32,
}

impl Tree {
    pub(super) fn new(balls: impl Iterator<Item = (Vec3, f32)>) -> Self {
        let mut nodes: Vec<Node> = balls
            .zip(0..)
            .map(|((center, radius), index)| Node {
                center,
                squared: radius * radius,
                reach: radius,
                axis: 0,
                index,
            })
            .collect();
        arrange(&mut nodes);
        Self { nodes }
    }

    pub(super) fn holding(&self, point: Vec3, found: &mut impl FnMut(u32)) {
        descend(&self.nodes, point, found);
    }
}

/// The median stands in the middle, on either side a tree. Returns the largest radius.
fn arrange(nodes: &mut [Node]) -> f32 {
    if nodes.is_empty() {
        return 0.0;
    }
    let low = nodes.iter().fold(Vec3::INFINITY, |a, n| a.min(n.center));
    let high = nodes
        .iter()
        .fold(Vec3::NEG_INFINITY, |a, n| a.max(n.center));
    let axis = (high - low).max_position();
    let middle = nodes.len() / 2;
    nodes.select_nth_unstable_by(middle, |a, b| a.center[axis].total_cmp(&b.center[axis]));
    let (below, rest) = nodes.split_at_mut(middle);
    let (node, above) = rest.split_first_mut().expect("the median");
    node.axis = axis as u8;
    node.reach = node.reach.max(arrange(below)).max(arrange(above));
    node.reach
}

fn descend(nodes: &[Node], point: Vec3, found: &mut impl FnMut(u32)) {
    let middle = nodes.len() / 2;
    let Some(node) = nodes.get(middle) else {
        return;
    };
    if (point - node.center).length_squared() <= node.squared {
        found(node.index);
    }
    let axis = usize::from(node.axis);
    let (below, above) = (&nodes[..middle], &nodes[middle + 1..]);
    if point[axis] <= node.center[axis] + node.reach {
        descend(below, point, found);
    }
    if point[axis] >= node.center[axis] - node.reach {
        descend(above, point, found);
    }
}
