//! Tests of the film and of files and metrics through the public interface.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test's helper may do what the test may"
)]

mod files;
mod film;
mod filter;
mod hostile;
mod metrics;
mod random;
mod study;
