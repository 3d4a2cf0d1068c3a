//! Markov chains for expensive, vector-valued targets on the unit cube and on any state.
