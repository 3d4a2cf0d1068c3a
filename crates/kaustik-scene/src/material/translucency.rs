use kaustik_geometry::Surface;
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::color::{ColorSource, Slot};
use crate::description::{MaterialDescription, TextureSlot};
use crate::scene::SceneError;
use crate::texture::{Coding, Texture};

/// Diffuse light that leaves on the other side of a thin surface.
#[derive(Debug)]
pub(super) struct Translucency {
    factor: f32,
    texture: Option<Slot>,
    color: ColorSource,
}

impl Translucency {
    /// Does any light leave there?
    pub(super) fn exists(description: &MaterialDescription) -> bool {
        let diffuse = description.diffuse_transmission;
        diffuse.is_some_and(|diffuse| diffuse.factor > 0.0) && !description.bounds_solid()
    }

    pub(super) fn new(
        description: &MaterialDescription,
        textures: &[Texture],
    ) -> Result<Option<Self>, SceneError> {
        let name = &description.name;
        let slot = |slot: Option<TextureSlot>| {
            slot.map(|slot| Slot::new(&slot, textures, name))
                .transpose()
        };
        let diffuse = description.diffuse_transmission;
        let Some(diffuse) = diffuse.filter(|_| Self::exists(description)) else {
            return Ok(None);
        };
        let color_texture = slot(diffuse.color_texture)?;
        Ok(Some(Self {
            factor: diffuse.factor,
            texture: slot(diffuse.texture)?,
            color: ColorSource::reflectance(diffuse.color, color_texture, None, name)?,
        }))
    }

    /// Share and colour at a point.
    pub(super) fn at(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> (f64, Spectrum) {
        let texel = (self.texture.as_ref())
            .map_or(1.0, |slot| slot.read(textures, surface, Coding::Linear)[3]);
        let color = self.color.eval_plain(textures, surface, wavelengths);
        (f64::from(self.factor * texel), color)
    }
}
