//! What a material asks of the frame that it scatters in: tangents, and normals that are bent.

use kaustik_geometry::{Surface, Unwrapping};

use super::Material;
use crate::texture::Texture;

impl Material {
    /// Has its varnish other normals than what it covers?
    #[inline]
    pub(crate) fn has_coat_normal(&self) -> bool {
        self.layers
            .as_ref()
            .is_some_and(|layers| layers.has_coat_normal())
    }

    /// The varnish's normal in the tangent frame, not unit; `None` if it is that of what it covers.
    pub(crate) fn coat_normal(&self, textures: &[Texture], surface: &Surface) -> Option<[f32; 3]> {
        self.layers.as_ref()?.coat_normal(textures, surface)
    }

    /// Does the shading frame need the tangent: for a normal texture, or for brush marks?
    #[inline]
    pub(crate) fn needs_tangent(&self) -> bool {
        self.normal.is_some() || self.is_brushed()
    }

    #[inline]
    pub(crate) fn is_brushed(&self) -> bool {
        self.layers
            .as_ref()
            .is_some_and(|layers| layers.is_brushed())
    }

    /// Cosine and sine of the angle from the tangent to where brushed facets are rougher.
    pub(crate) fn brush_direction(&self, textures: &[Texture], surface: &Surface) -> [f64; 2] {
        self.layers
            .as_ref()
            .map_or([1.0, 0.0], |layers| layers.direction(textures, surface))
    }

    /// The normal texture's normal in the tangent frame and its scale applied; `None` without one.
    pub(crate) fn tangent_normal(
        &self,
        textures: &[Texture],
        surface: &Surface,
    ) -> Option<[f32; 3]> {
        let (slot, scale) = self.normal.as_ref()?;
        Some(slot.normal(textures, surface, *scale))
    }

    /// What the frame follows: the normal texture, or else that of the brush marks, as they lie on the surface.
    pub(crate) fn unwrapping(&self) -> Unwrapping {
        let normal = self.normal.as_ref().map(|(slot, _)| slot.unwrapping());
        let layers = self.layers.as_ref();
        let brush = || layers.and_then(|layers| layers.brush_unwrapping());
        normal.or_else(brush).unwrap_or_default()
    }

    /// The same of the varnish's own normal texture.
    pub(crate) fn coat_unwrapping(&self) -> Unwrapping {
        let layers = self.layers.as_ref();
        let coat = layers.and_then(|layers| layers.coat_unwrapping());
        coat.unwrap_or_default()
    }

    /// How the texture lies for which a mesh needs tangents; `None` if no texture and no brush marks follow them.
    pub(crate) fn tangents_along(&self) -> Option<Unwrapping> {
        let coat = self
            .layers
            .as_ref()
            .and_then(|layers| layers.coat_unwrapping());
        match self.needs_tangent() {
            true => Some(self.unwrapping()),
            false => coat,
        }
    }
}
