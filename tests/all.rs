//! The workspace's one integration binary: it links once.
//!
//! These modules hold the house together: what the manifests, the sources and
//! the documents promise each other. Each scan is itself tested on a planted violation.

/// Who depends on whom, and who must not.
mod arrows;
/// One accept/reject decision in the whole workspace.
mod decision;
/// Every link in the documents leads somewhere.
mod links;
/// Reading the tree: files, and Rust without its comments, strings and tests.
mod source;
/// Manifests, lengths, leftovers, paths of somebody's machine.
mod tidy;
/// Methods, settings, extensions, scenes: the words of the documents and of the program.
mod vocabulary;
