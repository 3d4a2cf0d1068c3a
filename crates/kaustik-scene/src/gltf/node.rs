//! The node hierarchy, flattened without recursion: hostile files nest deeper than a stack.

use glam::DAffine3;

use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError, LoadOptions, transform};

type Result<T> = std::result::Result<T, LoadError>;

/// A node of the scene with its transform to the world.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    pub(super) node: Cursor<'a>,
    pub(super) world: DAffine3,
    /// Its index in the file.
    pub(super) index: usize,
    /// Position of its parent in the list of placed nodes.
    pub(super) parent: Option<usize>,
    /// Its meshes and lights are not there (`KHR_node_visibility`, which says nothing of cameras).
    pub(super) hidden: bool,
}

/// The parent of each node, after it has been checked that the nodes are a forest of bounded
/// depth. This is what makes every later walk short: a node is visited once.
fn parents(nodes: &[Cursor<'_>], options: &LoadOptions) -> Result<Vec<Option<usize>>> {
    let mut parents = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        for child in node.list("children")? {
            let index = child.index("/nodes", nodes.len())?;
            if let Some(other) = parents[index].replace(i) {
                let found = format!("node {index}, which is also a child of node {other}");
                return Err(child
                    .error(ErrorKind::Hierarchy, found, "a node without another parent")
                    .help("to place a mesh twice, let two nodes refer to it"));
            }
        }
    }
    check_depth(nodes, &parents, options.max_depth)?;
    Ok(parents)
}

/// Finds the depth of every node by walking up to the first one whose depth is known. Where
/// the walk meets itself there is a cycle.
fn check_depth(nodes: &[Cursor<'_>], parents: &[Option<usize>], most: usize) -> Result<()> {
    const UNKNOWN: usize = 0;
    const WALKED: usize = usize::MAX;
    let mut depths = vec![UNKNOWN; nodes.len()];
    let mut walk = Vec::new();
    for (start, place) in nodes.iter().enumerate() {
        let mut at = Some(start);
        while let Some(node) = at.filter(|&n| depths[n] == UNKNOWN) {
            depths[node] = WALKED;
            walk.push(node);
            at = parents[node];
        }
        let mut depth = at.map_or(0, |node| depths[node]);
        if depth == WALKED {
            let found = "a node that is its own ancestor";
            return Err(place.error(ErrorKind::Hierarchy, found, "a tree of nodes"));
        }
        while let Some(node) = walk.pop() {
            depth += 1;
            depths[node] = depth;
        }
        if depth > most {
            let found = format!("a node {depth} levels deep");
            let expected = format!("at most {most} levels");
            return Err(place.error(ErrorKind::Hierarchy, found, expected));
        }
    }
    Ok(())
}

/// The scene to show: the one that the file names, else the first; `None` without scenes.
pub(super) fn scene<'a>(root: &Cursor<'a>) -> Result<Option<Cursor<'a>>> {
    match (root.get("scene")?, root.get("scenes")?) {
        (Some(scene), _) => scene.target(root, "scenes").map(Some),
        (None, Some(scenes)) => Ok(scenes.items()?.next()),
        (None, None) => Ok(None),
    }
}

/// All nodes of the scene, parents before children, in the order of the file's lists. Without
/// a scene these are all nodes.
pub(super) fn flatten<'a>(
    reader: &mut Reader<'a>,
    scene: Option<&Cursor<'a>>,
) -> Result<Vec<Placed<'a>>> {
    let nodes = reader.root.list("nodes")?;
    let each = 4 * size_of::<Placed<'_>>();
    reader.budget.take_many("/nodes", nodes.len(), each)?;
    let parents = parents(&nodes, &reader.options)?;
    let roots = match scene {
        Some(scene) => roots(scene, nodes.len())?,
        None => (0..nodes.len()).filter(|&i| parents[i].is_none()).collect(),
    };
    let pending = roots.into_iter().rev().map(|i| (i, None));
    let mut pending: Vec<(usize, Option<usize>)> = pending.collect();
    let mut seen = vec![false; nodes.len()];
    let mut placed: Vec<Placed<'a>> = Vec::new();
    while let Some((index, parent)) = pending.pop() {
        let node = &nodes[index];
        if std::mem::replace(&mut seen[index], true) {
            let found = "a node that the scene contains twice";
            return Err(node.error(ErrorKind::Hierarchy, found, "each node once"));
        }
        let local = transform::local(reader, node)?;
        // a root keeps its very bits
        let world = parent.map_or(local, |parent| placed[parent].world * local);
        for child in node.list("children")?.iter().rev() {
            pending.push((child.index("/nodes", nodes.len())?, Some(placed.len())));
        }
        let hidden = parent.is_some_and(|parent| placed[parent].hidden) || is_hidden(node)?;
        placed.push(Placed {
            node: node.clone(),
            world,
            index,
            parent,
            hidden,
        });
    }
    Ok(placed)
}

/// Is the node hidden by itself, and with it all below it?
fn is_hidden(node: &Cursor<'_>) -> Result<bool> {
    match node.extension("KHR_node_visibility")? {
        Some(visibility) => Ok(!visibility.flag_or("visible", true)?),
        None => Ok(false),
    }
}

fn roots(scene: &Cursor<'_>, nodes: usize) -> Result<Vec<usize>> {
    let roots = scene.list("nodes")?;
    roots
        .iter()
        .map(|node| node.index("/nodes", nodes))
        .collect()
}
