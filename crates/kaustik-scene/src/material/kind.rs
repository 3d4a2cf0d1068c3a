use kaustik_bsdf::SMOOTH_ALPHA;
use kaustik_spectrum::Metal;

use super::layers::Layers;
use super::translucency::Translucency;
use crate::description::{MaterialDescription, Model};

/// Which scattering function, as far as constants decide it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Scatters nothing.
    Black,
    Lambertian,
    /// A metal by its base colour.
    Reflector,
    Measured(Metal),
    Coated,
    Phong(f32),
    OrenNayar(f32),
    /// A transparent solid.
    Solid,
    /// A transparent pane.
    Pane,
    Principled,
}

impl Kind {
    pub(super) fn of(description: &MaterialDescription) -> Self {
        let constant_mix = description.metallic_roughness_texture.is_none();
        let plain_metal = constant_mix && description.metallic >= 1.0;
        let plain_dielectric = description.metallic <= 0.0;
        let full_specular = description.specular.texture.is_none()
            && description.specular.color_texture.is_none()
            && description.specular.factor >= 1.0
            && matches!(description.specular.color, [1.0, 1.0, 1.0]);
        let clear = description
            .transmission
            .is_some_and(|t| t.factor >= 1.0 && t.texture.is_none());
        let no_transmission = description.transmission.is_none_or(|t| t.factor <= 0.0);
        let black = description.base_color[..3] == [0.0; 3]
            && description.reflectance.is_none()
            && description.specular.factor <= 0.0
            && plain_dielectric
            && no_transmission;
        match description.model {
            _ if description.unlit => Self::Black,
            Some(Model::Coated) => Self::Coated,
            Some(Model::Phong { exponent }) => Self::Phong(exponent),
            Some(Model::OrenNayar { sigma }) => Self::OrenNayar(sigma),
            None => match description.metal {
                Some(metal) => Self::Measured(metal),
                None if Layers::exist(description) => Self::Principled,
                None if Translucency::exists(description) => Self::Principled,
                None if description.specular_glossiness.is_some() => Self::Principled,
                None if black => Self::Black,
                None if plain_metal => Self::Reflector,
                None if plain_dielectric && clear && full_specular => {
                    if description.bounds_solid() {
                        Self::Solid
                    } else {
                        Self::Pane
                    }
                }
                None if plain_dielectric
                    && no_transmission
                    && description.specular.factor <= 0.0 =>
                {
                    Self::Lambertian
                }
                None => Self::Principled,
            },
        }
    }
}

/// Is the surface somewhere clear and smooth, without thickness and layers? Rays pass it there as they pass holes, if it does not
/// emit: what emits is to be met. Where a texture makes it rough the scattering function says so.
pub(super) fn is_pane(description: &MaterialDescription) -> bool {
    let kind = Kind::of(description);
    let clear = description
        .transmission
        .is_some_and(|transmission| transmission.factor > 0.0);
    let smooth = f64::from(description.roughness).powi(2) < SMOOTH_ALPHA;
    matches!(kind, Kind::Pane | Kind::Principled)
        && clear
        && (smooth || description.metallic_roughness_texture.is_some())
        && !(description.bounds_solid() || Layers::exist(description))
        && description.specular_glossiness.is_none()
}
