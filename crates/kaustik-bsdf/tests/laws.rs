//! The laws of scattering, over every variant through the one trait.

#[path = "laws/support.rs"]
mod support;

#[path = "laws/catalogue.rs"]
mod catalogue;
#[path = "laws/chi_square.rs"]
mod chi_square;
#[path = "laws/consistency.rs"]
mod consistency;
#[path = "laws/degenerate.rs"]
mod degenerate;
#[path = "laws/energy.rs"]
mod energy;
#[path = "laws/faults.rs"]
mod faults;
#[path = "laws/layers.rs"]
mod layers;
#[path = "laws/maps.rs"]
mod maps;
#[path = "laws/models.rs"]
mod models;
#[path = "laws/speed.rs"]
mod speed;
#[path = "laws/tilted.rs"]
mod tilted;
