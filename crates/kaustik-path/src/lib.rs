//! From a point of the unit cube to light paths: path tracing and light tracing.
