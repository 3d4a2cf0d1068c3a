//! What lies on glTF's material: varnish, fibres, brush marks, a film.

use kaustik_bsdf::{FilmParameters, LayerParameters};
use kaustik_geometry::{Surface, Unwrapping};
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::color::{ColorSource, Slot};
use crate::description::{
    Anisotropy, Clearcoat, Iridescence, MaterialDescription, Sheen, TextureSlot,
};
use crate::scene::SceneError;
use crate::texture::{Coding, Texture};

/// All of a material's layers.
#[derive(Debug)]
pub(super) struct Layers {
    coat: Option<(Clearcoat, [Option<Slot>; 3])>,
    /// Has the varnish other normals than what it covers?
    own_normals: bool,
    sheen: Option<(ColorSource, f32, Option<Slot>)>,
    brush: Option<(Anisotropy, Option<Slot>)>,
    film: Option<(Iridescence, [Option<Slot>; 2])>,
}

/// Index of a varnish, as its extension has it.
const VARNISH: f64 = 1.5;

impl Layers {
    /// Does the material have any?
    pub(super) fn exist(description: &MaterialDescription) -> bool {
        let d = description;
        let sheen = |sheen: Sheen| sheen.color.iter().any(|&c| c > 0.0);
        d.clearcoat.is_some_and(|coat| coat.factor > 0.0)
            || d.sheen.is_some_and(sheen)
            || d.anisotropy.is_some_and(|brush| brush.strength > 0.0)
            || d.iridescence.is_some_and(|film| film.factor > 0.0)
    }

    pub(super) fn new(
        description: &MaterialDescription,
        textures: &[Texture],
    ) -> Result<Self, SceneError> {
        let slot = |slot: Option<TextureSlot>| {
            slot.map(|slot| Slot::new(&slot, textures, &description.name))
                .transpose()
        };
        let coat = match description.clearcoat {
            None => None,
            Some(coat) => {
                let textures = [coat.texture, coat.roughness_texture, coat.normal_texture];
                let [share, roughness, normal] = textures.map(slot);
                Some((coat, [share?, roughness?, normal?]))
            }
        };
        let sheen = match description.sheen {
            None => None,
            Some(sheen) => {
                let texture = slot(sheen.color_texture)?;
                let name = &description.name;
                let color = ColorSource::reflectance(sheen.color, texture, None, name)?;
                Some((color, sheen.roughness, slot(sheen.roughness_texture)?))
            }
        };
        let brush = match description.anisotropy {
            None => None,
            Some(brush) => Some((brush, slot(brush.texture)?)),
        };
        let film = match description.iridescence {
            None => None,
            Some(film) => Some((film, [slot(film.texture)?, slot(film.thickness_texture)?])),
        };
        Ok(Self {
            coat,
            own_normals: Self::has_own_normals(description),
            sheen,
            brush,
            film,
        })
    }

    /// Varnish and fibres at a point; `around` is the index of the medium outside.
    pub(super) fn on_top(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
    ) -> LayerParameters {
        let read = |slot: &Option<Slot>, channel: usize| texel(slot, textures, surface)[channel];
        let mut layers = LayerParameters {
            clearcoat_ior: VARNISH / f64::from(around.mean()),
            ..LayerParameters::default()
        };
        if let Some((coat, [share, roughness, _])) = &self.coat {
            layers.clearcoat = f64::from(coat.factor * read(share, 0));
            layers.clearcoat_roughness = f64::from(coat.roughness * read(roughness, 1));
        }
        if let Some((color, roughness, slot)) = &self.sheen {
            layers.sheen_color = color.eval_plain(textures, surface, wavelengths);
            layers.sheen_shade = color.largest_plain(textures, surface);
            layers.sheen_roughness = f64::from(roughness * read(slot, 3));
        }
        layers
    }

    /// Does the varnish of a material have other normals than what it covers? Without a normal texture of its
    /// own it has those of the mesh, whatever lies below.
    pub(super) fn has_own_normals(description: &MaterialDescription) -> bool {
        let of_base = (description.normal_texture).map(|slot| (slot, description.normal_scale));
        description.clearcoat.is_some_and(|coat| {
            let own = coat.normal_texture.map(|slot| (slot, coat.normal_scale));
            coat.factor > 0.0 && own != of_base
        })
    }

    /// The same of this one.
    pub(super) fn has_coat_normal(&self) -> bool {
        self.own_normals
    }

    /// These in the tangent frame, not unit.
    pub(super) fn coat_normal(&self, textures: &[Texture], surface: &Surface) -> Option<[f32; 3]> {
        let (coat, [.., slot]) = self.coat.as_ref()?;
        let Some(slot) = slot else {
            return Some([0.0, 0.0, 1.0]);
        };
        Some(slot.normal(textures, surface, coat.normal_scale))
    }

    /// How the texture of the varnish's normals lies.
    pub(super) fn coat_unwrapping(&self) -> Option<Unwrapping> {
        let (_, [.., slot]) = self.coat.as_ref()?;
        slot.as_ref().map(Slot::unwrapping)
    }

    /// How the texture of the brush marks lies.
    pub(super) fn brush_unwrapping(&self) -> Option<Unwrapping> {
        let (_, slot) = self.brush.as_ref()?;
        slot.as_ref().map(Slot::unwrapping)
    }

    /// The film at a point; `around` is the index of the medium outside.
    pub(super) fn film(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
    ) -> Option<FilmParameters> {
        let (film, [share, place]) = self.film.as_ref()?;
        let [least, most] = film.thickness;
        let place = texel(place, textures, surface)[1];
        Some(FilmParameters {
            strength: f64::from(film.factor * texel(share, textures, surface)[0]),
            ior: f64::from(film.ior / around.mean()),
            thickness: f64::from(least + place * (most - least)),
            // as they are outside, to which the index is relative
            wavelengths: Spectrum::new(wavelengths.nm()) / around.mean(),
        })
    }

    /// How strongly the facets are brushed at a point, in [0, 1].
    pub(super) fn anisotropy(&self, textures: &[Texture], surface: &Surface) -> f64 {
        self.brush.as_ref().map_or(0.0, |(brush, slot)| {
            f64::from(brush.strength * texel(slot, textures, surface)[2])
        })
    }

    /// Does the shading frame have to follow the brush marks?
    pub(super) fn is_brushed(&self) -> bool {
        self.brush.is_some()
    }

    /// Cosine and sine of the angle from the tangent to the direction in which the facets are rougher.
    pub(super) fn direction(&self, textures: &[Texture], surface: &Surface) -> [f64; 2] {
        let Some((brush, slot)) = &self.brush else {
            return [1.0, 0.0];
        };
        let (sin, cos) = (
            f64::from(libm::sinf(brush.rotation)),
            f64::from(libm::cosf(brush.rotation)),
        );
        let Some(slot) = slot else {
            return [cos, sin];
        };
        let [x, y, ..] = slot.read(textures, surface, Coding::Linear);
        let [x, y] = [x, y].map(|c| 2.0 * f64::from(c) - 1.0);
        let length = libm::hypot(x, y);
        if length < 1e-3 {
            return [cos, sin];
        }
        [(x * cos - y * sin) / length, (x * sin + y * cos) / length]
    }
}

/// Has the material a varnish with other normals than what it covers, smoother than such a one is rendered?
pub(crate) fn has_smooth_bumps(material: &MaterialDescription) -> bool {
    let smooth = |c: Clearcoat| c.roughness < 0.05 || c.roughness_texture.is_some();
    Layers::has_own_normals(material) && material.clearcoat.is_some_and(smooth)
}

fn texel(slot: &Option<Slot>, textures: &[Texture], surface: &Surface) -> [f32; 4] {
    slot.as_ref().map_or([1.0; 4], |slot| {
        slot.read(textures, surface, Coding::Linear)
    })
}
