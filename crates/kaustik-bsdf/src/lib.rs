//! Scattering at surfaces in the local frame, spectral, in both transport modes.
