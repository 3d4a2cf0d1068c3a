//! Broken files, and what becomes of them: campaigns of files that are broken by a seed (the command), and the one
//! call that coverage-guided targets make.

mod campaign;
mod check;
mod command;
mod kind;
mod model;
mod picture;
mod random;
mod seeds;
mod spoil;
mod table;

pub use check::verdict;
pub use command::main;
pub use kind::Kind;
pub use seeds::assembled;
