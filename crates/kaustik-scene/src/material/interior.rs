//! What fills a closed mesh.

use std::collections::HashMap;

use kaustik_spectrum::{Glass, Sigmoid, Spectrum, Wavelengths, uplift_reflectance};

use crate::description::MaterialDescription;

/// The interior of a transparent solid (`KHR_materials_volume`): it may absorb.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    /// Transmittance over `1 / inverse_distance`; `None` absorbs nothing.
    absorption: Option<(Sigmoid, f32)>,
    /// Which of two overlapping solids fills the overlap: the higher.
    pub(crate) priority: i32,
    /// The first material that is filled with the same: clear and frosted parts of a bottle bound one solid.
    pub(crate) medium: u32,
}

/// Media of a scene, told by all that makes a difference within them, each with the first material that it fills.
#[derive(Debug, Default)]
pub(crate) struct Media(HashMap<String, u32>);

impl Media {
    /// Tells the solid that the material of this number bounds which medium it is of.
    pub(super) fn add(&mut self, material: u32, glass: &Glass, solid: &mut Solid) {
        let words = format!("{glass:?}, {:?}, {}", solid.absorption, solid.priority);
        solid.medium = *self.0.entry(words).or_insert(material);
    }
}

impl Solid {
    pub(super) fn new(description: &MaterialDescription) -> Option<Self> {
        if !description.bounds_solid() {
            return None;
        }
        let volume = description.volume?;
        let absorbs = volume.attenuation_distance.is_finite()
            && volume.attenuation_distance > 0.0
            && volume.attenuation_color.iter().any(|&c| c < 1.0);
        Some(Self {
            absorption: absorbs.then(|| {
                (
                    uplift_reflectance(volume.attenuation_color),
                    1.0 / volume.attenuation_distance,
                )
            }),
            priority: description.priority,
            medium: u32::MAX,
        })
    }

    /// Share of light left after `distance` (Beer and Lambert).
    pub(crate) fn transmittance(&self, wavelengths: &Wavelengths, distance: f64) -> Spectrum {
        match &self.absorption {
            None => Spectrum::ONE,
            Some((color, inverse)) => {
                let exponent = distance as f32 * inverse;
                color
                    .eval(wavelengths)
                    .map(|c| libm::powf(c.max(0.0), exponent))
            }
        }
    }

    /// Does it absorb at all?
    pub(crate) fn absorbs(&self) -> bool {
        self.absorption.is_some()
    }
}
