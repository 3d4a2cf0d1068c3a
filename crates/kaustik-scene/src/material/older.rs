//! Specular and glossiness in place of metal and roughness.

use kaustik_bsdf::PrincipledParameters;
use kaustik_geometry::Surface;
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::color::{ColorSource, Slot};
use crate::description::SpecularGlossiness;
use crate::scene::SceneError;
use crate::texture::{Coding, Texture};

/// The older model (`KHR_materials_pbrSpecularGlossiness`).
#[derive(Debug)]
pub(super) struct Older {
    /// Reflectance at normal incidence; its texture's alpha holds the glossiness.
    color: ColorSource,
    glossiness: f32,
}

impl Older {
    /// With its texture, for the material of this name.
    pub(super) fn new(
        description: &SpecularGlossiness,
        texture: Option<Slot>,
        material: &str,
    ) -> Result<Self, SceneError> {
        Ok(Self {
            color: ColorSource::reflectance(description.specular, texture, None, material)?,
            glossiness: description.glossiness,
        })
    }

    /// The parameters with its numbers: no metal, and an index so high that the colour alone
    /// tells what is reflected at normal incidence.
    pub(super) fn replace(
        &self,
        base: &PrincipledParameters,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> PrincipledParameters {
        const ALL_BY_COLOUR: f32 = 1e6;
        let alpha = self
            .color
            .slot()
            .map_or(1.0, |slot| slot.read(textures, surface, Coding::Srgb)[3]);
        PrincipledParameters {
            metallic: 0.0,
            roughness: f64::from(1.0 - self.glossiness * alpha),
            specular: 1.0,
            specular_color: self.color.eval_plain(textures, surface, wavelengths),
            ior: Spectrum::splat(ALL_BY_COLOUR),
            transmission: 0.0,
            ..*base
        }
    }
}
