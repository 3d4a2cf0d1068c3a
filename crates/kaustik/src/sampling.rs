//! Random numbers and where they fall: streams of generators, cells of the image, stratified points.

pub(crate) mod cells;
pub(crate) mod shuffle;
pub(crate) mod sobol;
pub(crate) mod stratified;
pub(crate) mod streams;
