//! Tests of the film and of files and metrics through the public interface.

mod files;
mod film;
mod hostile;
mod metrics;
mod random;
