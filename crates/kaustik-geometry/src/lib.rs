//! Triangle meshes, instances and a wide, watertight ray traversal.
