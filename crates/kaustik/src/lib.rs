//! Markov-chain Monte Carlo light transport: methods, rounds, threads.
