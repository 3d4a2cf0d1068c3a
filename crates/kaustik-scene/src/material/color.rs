//! Where a colour comes from: a constant, a measured table, a texture.

use glam::Vec2;
use kaustik_geometry::{Surface, Unwrapping};
use kaustik_spectrum::{Illuminant, Sigmoid, Spectrum, Tabulated, Wavelengths, uplift_reflectance};

use crate::description::{SpectralInput, TextureSlot};
use crate::scene::SceneError;
use crate::texture::{Coding, Texture, UvMap};

/// Rec.709 luminance of a linear colour.
pub(crate) fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// A texture as a material reads it.
#[derive(Clone, Debug)]
pub(crate) struct Slot {
    texture: u32,
    uv_set: u8,
    map: UvMap,
}

impl Slot {
    pub(crate) fn new(
        slot: &TextureSlot,
        textures: &[Texture],
        material: &str,
    ) -> Result<Self, SceneError> {
        for (kind, index, count) in [
            ("texture", slot.texture, textures.len()),
            ("uv set", usize::from(slot.uv_set), 2),
        ] {
            if index >= count {
                return Err(SceneError::Reference {
                    what: format!("material '{material}'"),
                    kind,
                    index,
                    count,
                });
            }
        }
        Ok(Self {
            texture: slot.texture as u32,
            uv_set: slot.uv_set,
            map: UvMap::new(&slot.transform),
        })
    }

    pub(crate) fn uv_set(&self) -> u8 {
        self.uv_set
    }

    /// How the texture lies on the surface.
    pub(crate) fn unwrapping(&self) -> Unwrapping {
        Unwrapping {
            set: usize::from(self.uv_set),
            turned: self.map.linear(),
        }
    }

    /// The texel at a surface point, rgba.
    pub(crate) fn read(&self, textures: &[Texture], surface: &Surface, coding: Coding) -> [f32; 4] {
        self.read_at(textures, surface.uv[usize::from(self.uv_set)], coding)
    }

    /// The normal of a normal texture in its tangent frame with a scale applied, not unit.
    pub(crate) fn normal(&self, textures: &[Texture], surface: &Surface, scale: f32) -> [f32; 3] {
        let [x, y, z, _] = self.read(textures, surface, Coding::Linear);
        [
            (2.0 * x - 1.0) * scale,
            (2.0 * y - 1.0) * scale,
            2.0 * z - 1.0,
        ]
    }

    pub(crate) fn read_at(&self, textures: &[Texture], uv: Vec2, coding: Coding) -> [f32; 4] {
        textures[self.texture as usize].sample(self.map.apply(uv), coding)
    }
}

/// A reflectance that may vary over the surface.
#[derive(Clone, Debug)]
pub(crate) enum ColorSource {
    /// Linear Rec.709 with its uplift, times the texture, times the vertex colour.
    Rgb {
        factor: [f32; 3],
        uplifted: Sigmoid,
        slot: Option<Slot>,
    },
    /// Measured; a texture or vertex colour dims it by its luminance.
    Table {
        table: Tabulated,
        slot: Option<Slot>,
    },
}

impl ColorSource {
    pub(crate) fn reflectance(
        factor: [f32; 3],
        slot: Option<Slot>,
        table: Option<&SpectralInput>,
        material: &str,
    ) -> Result<Self, SceneError> {
        Ok(match table {
            None => Self::Rgb {
                factor,
                uplifted: uplift_reflectance(factor),
                slot,
            },
            Some(input) => Self::Table {
                table: reflecting(input, material)?,
                slot,
            },
        })
    }

    pub(crate) fn slot(&self) -> Option<&Slot> {
        match self {
            Self::Rgb { slot, .. } | Self::Table { slot, .. } => slot.as_ref(),
        }
    }

    /// At a point, vertex colour included.
    #[inline]
    pub(crate) fn eval(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let [r, g, b, _] = surface.color;
        self.times(textures, surface, wavelengths, [r, g, b])
    }

    /// At a point, without the vertex colour.
    pub(crate) fn eval_plain(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        self.times(textures, surface, wavelengths, [1.0; 3])
    }

    /// The largest of the channels at a point, without the vertex colour; of a table nothing is known.
    pub(crate) fn largest_plain(&self, textures: &[Texture], surface: &Surface) -> f32 {
        match self {
            Self::Rgb { factor, slot, .. } => {
                let texel = slot
                    .as_ref()
                    .map_or([1.0; 4], |s| s.read(textures, surface, Coding::Srgb));
                let channels = factor
                    .iter()
                    .zip(texel)
                    .map(|(factor, texel)| factor * texel);
                channels.fold(0.0, f32::max).min(1.0)
            }
            Self::Table { .. } => 0.0,
        }
    }

    #[inline]
    fn times(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
        vertex: [f32; 3],
    ) -> Spectrum {
        let plain = self.slot().is_none() && vertex.iter().all(|&c| c >= 1.0);
        let tint = |slot: &Option<Slot>| {
            let texel = slot
                .as_ref()
                .map_or([1.0; 4], |s| s.read(textures, surface, Coding::Srgb));
            [0, 1, 2].map(|i| (texel[i] * vertex[i]).clamp(0.0, 1.0))
        };
        match self {
            Self::Rgb { uplifted, .. } if plain => uplifted.eval(wavelengths),
            Self::Rgb { factor, slot, .. } => {
                let tint = tint(slot);
                uplift_reflectance([0, 1, 2].map(|i| factor[i] * tint[i])).eval(wavelengths)
            }
            Self::Table { table, .. } if plain => table.eval(wavelengths),
            Self::Table { table, slot } => table.eval(wavelengths) * luminance(tint(slot)),
        }
    }
}

/// A table of reflectances, which make no light.
pub(crate) fn reflecting(input: &SpectralInput, material: &str) -> Result<Tabulated, SceneError> {
    const KEY: &str = "reflectance";
    let table = tabulated(input, material, KEY)?;
    if table.max() <= 1.0 {
        return Ok(table);
    }
    let name = match input {
        SpectralInput::Named(name) => format!("'{name}' reaches"),
        SpectralInput::Knots(_) => "knots reach".to_owned(),
    };
    Err(SceneError::Spectrum {
        material: material.to_owned(),
        key: KEY,
        reason: format!("{name} {}, expected reflectances from 0 to 1", table.max()),
    })
}

/// A table from a file's words.
pub(super) fn tabulated(
    input: &SpectralInput,
    material: &str,
    key: &'static str,
) -> Result<Tabulated, SceneError> {
    let fail = |reason: String| SceneError::Spectrum {
        material: material.to_owned(),
        key,
        reason,
    };
    match input {
        SpectralInput::Knots(knots) => {
            Tabulated::new(knots.clone()).map_err(|error| fail(error.to_string()))
        }
        SpectralInput::Named(name) => {
            let lamp = || {
                let illuminant = Illuminant::named(name)?;
                let knots = (360..=830).map(|nm| (nm as f32, illuminant.at(nm as f32)));
                Tabulated::new(knots.collect()).ok()
            };
            Tabulated::named(name).or_else(lamp).ok_or_else(|| {
                fail(format!(
                    "there is no table '{name}'; known are {} and the illuminants A, D50, D65, E, FL2, FL11",
                    Tabulated::NAMES.join(", ")
                ))
            })
        }
    }
}
