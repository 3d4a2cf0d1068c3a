//! From the visits of Markov chains to splats on a film.
