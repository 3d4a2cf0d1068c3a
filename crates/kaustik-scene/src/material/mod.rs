//! Materials ready for rays: what a description says, prepared so that a hit becomes a
//! [`Bsdf`] with little work.
//!
//! Which scattering function a material needs is decided once, when the scene is built, as
//! far as its textures allow: a plain wall is Lambertian at no more cost than reading its
//! reflectance at the path's wavelengths.

mod color;
mod emission;
mod frame;
mod interior;
mod kind;
mod layers;
mod older;
mod translucency;

use glam::DVec3;
use kaustik_bsdf::{
    Bsdf, Finish, Interface, LayerParameters, PrincipledParameters, SMOOTH_ALPHA, Wall,
};
use kaustik_geometry::{Surface, World};
use kaustik_spectrum::{Glass, Spectrum, Wavelengths};

use crate::description::{AlphaMode, MaterialDescription};
use crate::scene::SceneError;
use crate::texture::{Coding, Texture};
pub(crate) use color::{ColorSource, Slot, luminance, reflecting};
use emission::Emission;
pub(crate) use interior::{Media, Solid};
use kind::{Kind, is_pane};
use layers::Layers;
pub(crate) use layers::has_smooth_bumps;
use older::Older;
use translucency::Translucency;

/// A material at rest.
#[derive(Debug)]
pub(crate) struct Material {
    kind: Kind,
    base: ColorSource,
    alpha_factor: f32,
    alpha_mode: AlphaMode,
    metallic: f32,
    roughness: f32,
    metallic_roughness: Option<Slot>,
    /// Of a glTF material without layers, where it is the same all over.
    finish: Option<Finish>,
    normal: Option<(Slot, f32)>,
    specular: f32,
    specular_texture: Option<Slot>,
    specular_color: ColorSource,
    /// The largest channel of the factor of `specular_color` where that is above 1.
    specular_scale: f32,
    older: Option<Older>,
    transmission: f32,
    transmission_texture: Option<Slot>,
    translucency: Option<Translucency>,
    glass: Glass,
    emission: Option<Emission>,
    solid: Option<Solid>,
    layers: Option<Box<Layers>>,
    both_sides: bool,
    /// A smooth pane: rays may pass it.
    is_pane: bool,
    compensation: bool,
}

impl Material {
    /// From its description; `textures` are the scene's.
    pub(crate) fn new(
        description: &MaterialDescription,
        textures: &[Texture],
        compensation: bool,
    ) -> Result<Self, SceneError> {
        let slot = |slot: Option<crate::description::TextureSlot>| {
            slot.map(|slot| Slot::new(&slot, textures, &description.name))
                .transpose()
        };
        let base = ColorSource::reflectance(
            [0, 1, 2].map(|i| description.base_color[i]),
            slot(description.base_color_texture)?,
            description.reflectance.as_ref(),
            &description.name,
        )?;
        let transmission = description.transmission;
        let specular_scale = description.specular.color.into_iter().fold(1.0, f32::max);
        let kind = Kind::of(description);
        // other kinds have no place for them: an unlit surface scatters nothing, measured metals stay bare
        let is_layered = kind == Kind::Principled && Layers::exist(description);
        let emission = Emission::new(
            description,
            slot(description.emissive_texture)?,
            slot(description.base_color_texture)?,
        )?;
        Ok(Self {
            kind,
            base,
            alpha_factor: description.base_color[3],
            alpha_mode: description.alpha_mode,
            metallic: description.metallic,
            roughness: description.roughness,
            metallic_roughness: slot(description.metallic_roughness_texture)?,
            finish: (kind == Kind::Principled && is_equally_rough(description))
                .then(|| Finish::new(f64::from(description.roughness), 0.0)),
            normal: slot(description.normal_texture)?.map(|slot| (slot, description.normal_scale)),
            specular: description.specular.factor,
            specular_texture: slot(description.specular.texture)?,
            specular_scale,
            older: (description.specular_glossiness)
                .map(|older| Older::new(&older, slot(older.texture)?, &description.name))
                .transpose()?,
            specular_color: ColorSource::reflectance(
                description.specular.color.map(|c| c / specular_scale),
                slot(description.specular.color_texture)?,
                None,
                &description.name,
            )?,
            transmission: transmission.map_or(0.0, |t| t.factor),
            transmission_texture: slot(transmission.and_then(|t| t.texture))?,
            translucency: Translucency::new(description, textures)?,
            glass: index_of_refraction(description),
            is_pane: emission.is_none() && is_pane(description),
            emission,
            solid: Solid::new(description),
            layers: is_layered
                .then(|| Layers::new(description, textures).map(Box::new))
                .transpose()?,
            both_sides: description.double_sided || description.unlit,
            compensation,
        })
    }

    /// Tells its solid, if it bounds one, of which of the scene's media it is; `index` is the material's number.
    pub(crate) fn join_media(&mut self, index: u32, media: &mut Media) {
        if let Some(solid) = &mut self.solid {
            media.add(index, &self.glass, solid);
        }
    }

    /// The scattering function under a varnish whose normal, in the local frame, is this.
    pub(crate) fn varnished(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
        normal: Option<DVec3>,
    ) -> Bsdf {
        let base = self.parameters(textures, surface, wavelengths, around);
        let layers = self.layers.as_deref();
        let layers = layers.map(|layers| layers.on_top(textures, surface, wavelengths, around));
        let layers = layers.unwrap_or_default();
        Bsdf::layered(
            &base,
            &LayerParameters {
                clearcoat_normal: normal,
                ..layers
            },
        )
    }

    /// The scattering function at a hit, into the caller's slot: most are a plain wall's, a fraction of the size of the
    /// largest. `around` is the index of refraction of the medium on the outer side of the surface at the path's
    /// wavelengths.
    #[inline]
    pub(crate) fn write_bsdf(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: impl FnOnce() -> Spectrum,
        bsdf: &mut Bsdf,
    ) {
        match self.kind {
            Kind::Lambertian => {
                *bsdf = Bsdf::lambertian(self.base.eval(textures, surface, wavelengths));
            }
            Kind::Principled => *bsdf = self.principled(textures, surface, wavelengths, around()),
            _ => *bsdf = self.special(textures, surface, wavelengths, around()),
        }
        if self.is_pane {
            *bsdf = bsdf.passable();
        }
    }

    /// May rays pass this surface because it is a smooth pane?
    #[inline]
    pub(crate) fn is_pane(&self) -> bool {
        self.is_pane
    }

    /// Everything but the plain wall and glTF's mixture.
    #[inline(never)]
    fn special(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
    ) -> Bsdf {
        if self.kind == Kind::Black {
            return Bsdf::black();
        }
        let base = self.base.eval(textures, surface, wavelengths);
        let (metallic, roughness) = self.metallic_roughness(textures, surface);
        let alpha = f64::from(roughness * roughness);
        match self.kind {
            Kind::Reflector if alpha < SMOOTH_ALPHA => Bsdf::mirror(base),
            Kind::Reflector => Bsdf::metal(base, Spectrum::ONE, alpha, self.compensation),
            Kind::Measured(metal) => {
                let (eta, k) = metal.eta_k(wavelengths);
                Bsdf::conductor(eta / around, k / around, alpha, self.compensation)
            }
            Kind::Coated => {
                let ior = self.glass.ior(wavelengths).mean() / around.mean();
                Bsdf::coated(base, f64::from(ior))
            }
            Kind::Phong(exponent) => Bsdf::phong(
                base * (1.0 - metallic),
                base * metallic,
                f64::from(exponent),
            ),
            Kind::Solid | Kind::Pane => {
                let eta = self.glass.ior(wavelengths) / around;
                let interface = Interface::new(eta, Spectrum::ONE, base);
                if self.kind == Kind::Solid {
                    Bsdf::dielectric(interface, alpha, self.compensation)
                } else {
                    Bsdf::thin_dielectric(interface, alpha, self.compensation)
                }
            }
            Kind::OrenNayar(sigma) => Bsdf::oren_nayar(base, f64::from(sigma)),
            Kind::Black | Kind::Lambertian | Kind::Principled => Bsdf::lambertian(base),
        }
    }

    #[inline(never)]
    fn principled(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
    ) -> Bsdf {
        let base = self.parameters(textures, surface, wavelengths, around);
        match (self.layers.as_deref(), &self.finish) {
            (None, None) => Bsdf::principled(&base),
            (None, Some(finish)) => Bsdf::principled_of(&base, finish),
            (Some(layers), _) => {
                let on_top = layers.on_top(textures, surface, wavelengths, around);
                Bsdf::layered(&base, &on_top)
            }
        }
    }

    #[inline(always)]
    fn parameters(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        around: Spectrum,
    ) -> PrincipledParameters {
        let (metallic, roughness) = self.metallic_roughness(textures, surface);
        let read = |slot: &Option<Slot>, channel: usize| {
            slot.as_ref().map_or(1.0, |slot| {
                slot.read(textures, surface, Coding::Linear)[channel]
            })
        };
        let layers = self.layers.as_deref();
        let translucency =
            (self.translucency.as_ref()).map(|t| t.at(textures, surface, wavelengths));
        let (diffuse_transmission, diffuse_transmission_color) =
            translucency.unwrap_or((0.0, Spectrum::ONE));
        let base = PrincipledParameters {
            base_color: self.base.eval(textures, surface, wavelengths),
            metallic: f64::from(metallic),
            roughness: f64::from(roughness),
            specular: f64::from(self.specular * read(&self.specular_texture, 3)),
            specular_color: self
                .specular_color
                .eval_plain(textures, surface, wavelengths)
                * self.specular_scale,
            ior: self.glass.ior(wavelengths) / around,
            transmission: f64::from(self.transmission * read(&self.transmission_texture, 0)),
            wall: if self.solid.is_some() {
                Wall::Solid
            } else {
                Wall::Thin
            },
            diffuse_transmission,
            diffuse_transmission_color,
            anisotropy: layers.map_or(0.0, |layers| layers.anisotropy(textures, surface)),
            film: layers.and_then(|layers| layers.film(textures, surface, wavelengths, around)),
            compensation: self.compensation,
        };
        match &self.older {
            None => base,
            Some(older) => older.replace(&base, textures, surface, wavelengths),
        }
    }

    fn metallic_roughness(&self, textures: &[Texture], surface: &Surface) -> (f32, f32) {
        match &self.metallic_roughness {
            None => (self.metallic, self.roughness),
            Some(slot) => {
                let [_, roughness, metallic, _] = slot.read(textures, surface, Coding::Linear);
                (self.metallic * metallic, self.roughness * roughness)
            }
        }
    }

    /// Can a ray pass this surface because of its alpha?
    pub(crate) fn has_alpha(&self) -> bool {
        self.alpha_mode != AlphaMode::Opaque
    }

    /// Probability of meeting the surface at this point, in [0, 1].
    pub(crate) fn opacity(
        &self,
        textures: &[Texture],
        uv: impl Fn(u8) -> glam::Vec2,
        vertex_alpha: f32,
    ) -> f32 {
        let texel = self.base.slot().map_or(1.0, |slot| {
            slot.read_at(textures, uv(slot.uv_set()), Coding::Srgb)[3]
        });
        let alpha = (self.alpha_factor * texel * vertex_alpha).clamp(0.0, 1.0);
        match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            AlphaMode::Blend => alpha,
        }
    }

    /// Does it send out light of its own?
    pub(crate) fn is_emissive(&self) -> bool {
        self.emission.is_some()
    }

    /// Is the emission the same all over the surface?
    pub(crate) fn emits_evenly(&self) -> bool {
        self.emission.as_ref().is_some_and(Emission::is_even)
    }

    /// Do both sides emit?
    pub(crate) fn emits_on_both_sides(&self) -> bool {
        self.both_sides
    }

    /// Does light leave at this cosine to the front normal?
    #[inline]
    pub(crate) fn emits_toward(&self, cos: f64) -> bool {
        self.emission.is_some() && (cos > 0.0 || (self.both_sides && cos < 0.0))
    }

    /// Emitted radiance at a point (the side is the caller's matter).
    #[inline]
    pub(crate) fn emission(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        self.emission.as_ref().map_or(Spectrum::ZERO, |emission| {
            emission.eval(textures, surface, wavelengths)
        })
    }

    /// The same where [`Self::emits_evenly`].
    #[inline]
    pub(crate) fn even_emission(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.emission
            .as_ref()
            .map_or(Spectrum::ZERO, |emission| emission.eval_even(wavelengths))
    }

    /// Rough mean luminance over a triangle, for the choice among emitters.
    pub(crate) fn mean_emission(
        &self,
        textures: &[Texture],
        world: &World,
        instance: u32,
        primitive: u32,
    ) -> f64 {
        self.emission.as_ref().map_or(0.0, |emission| {
            emission.mean(textures, world, instance, primitive)
        })
    }

    /// The interior, if the surface bounds one.
    #[inline]
    pub(crate) fn solid(&self) -> Option<&Solid> {
        self.solid.as_ref()
    }

    /// Index of refraction of the interior.
    pub(crate) fn ior(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.glass.ior(wavelengths)
    }
}

/// Is its roughness one number?
fn is_equally_rough(description: &MaterialDescription) -> bool {
    description.metallic_roughness_texture.is_none() && description.specular_glossiness.is_none()
}

/// A glass by name, or glTF's ior with its dispersion (20 / Abbe number). An ior of 0 is the
/// extension's way to say that everything is reflected; a large index says the same here.
fn index_of_refraction(description: &MaterialDescription) -> Glass {
    const MIRROR_LIKE: f32 = 1e4;
    if let Some(glass) = &description.glass {
        return *glass;
    }
    let nd = if description.ior == 0.0 {
        MIRROR_LIKE
    } else {
        description.ior
    };
    let dispersive = (description.dispersion > 0.0)
        .then(|| Glass::abbe(nd, 20.0 / description.dispersion).ok())
        .flatten();
    dispersive
        .or_else(|| Glass::constant(nd).ok())
        .unwrap_or(Glass::Constant(1.5))
}
