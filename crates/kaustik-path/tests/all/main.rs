//! Builders against each other and against closed forms, on small scenes made by code.

/// Unidirectional, endpoint and light walks give the same image in the mean.
mod agreement;
/// Images known in closed form.
mod closed_forms;
/// No coordinate is read twice; the same point gives the same bits.
mod coordinates;
/// Refraction by wavelength: white stays white, the hero counts alone.
mod dispersion;
/// Estimates with their errors, Welch's test.
mod estimate;
/// Edges are counted alike by all builders.
mod lengths;
/// Short and long paths apart.
mod parts;
/// The scenes on which builders are compared.
mod scenes;
/// A walk from the camera alone sees what the full form finds.
mod sighting;
