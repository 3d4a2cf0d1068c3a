//! The acceleration structure: an 8-wide tree over blocks of triangles.
//!
//! Boxes are parted from the top until few are left, and obvhs clusters these into a binary tree and reinserts
//! nodes; [`collapse`] turns it into wide nodes of least expected cost. The layouts follow from how they are
//! read: a node is tested as a whole, so its boxes lie as one array a plane; so do the corners of a block,
//! copied out of the mesh so that a leaf is one run of memory.

mod build;
mod collapse;
mod divide;
mod goal;
mod lanes;
mod near;
mod node;
mod pages;
mod plan;
mod precise;
mod prepared;
mod slabs;
mod stack;
mod triangles;
mod walk;

pub(crate) use build::{Leaf, build};
pub(crate) use goal::{Any, Closest, Goal};
pub(crate) use lanes::InstructionSet;
pub(crate) use near::Near;
pub(crate) use node::{Bvh, Kind, LIMIT};
pub(crate) use walk::{Level, PlacedTree, PlacedTrees, STILL};
