//! Russian roulette: when a walk is worth going on with.

/// Walks of fewer edges always go on.
const FIRST_EDGE: u32 = 2;
/// A walk that carries a third of a white path's light or more goes on as if it carried all of it. Of
/// the factors 1 to 4 and the first edges 1 to 4, measured on a Cornell box, these gave the least
/// error in a given time (`docs/performance.md`).
const EAGERNESS: f32 = 3.0;
/// Even a white wall ends one walk in twenty.
const MOST: f32 = 0.95;
/// Radiance inside glass is seen divided by the square of its index, and gets it back on the way
/// out; without this factor roulette would take it for a loss.
const INSIDE_SOLID: f32 = 2.25;

/// Probability of going on after `edge` edges with this share of the throughput that the walk began
/// with; 1 is no roulette.
#[inline]
pub(crate) fn survival(edge: u32, throughput: f32, inside_solid: bool) -> f32 {
    if edge < FIRST_EDGE {
        return 1.0;
    }
    let seen = throughput * if inside_solid { INSIDE_SOLID } else { 1.0 };
    (seen * EAGERNESS).min(MOST)
}
