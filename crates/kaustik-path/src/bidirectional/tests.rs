//! Weights against their definition, strategies against each other.

/// What a joint through matter loses.
mod absorption;
/// Random paths over planes and spheres, in f64.
mod analytic;
/// Each strategy alone in a room whose light is known.
mod furnace;
/// One strategy at a time against all at once.
mod multiplexed;
/// How many rays.
mod rays;
/// The weights' definition.
mod reference;
/// The renderer's own paths.
mod traced;
