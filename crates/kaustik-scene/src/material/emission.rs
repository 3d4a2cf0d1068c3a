//! Light that a surface sends out by itself.

use kaustik_geometry::{Surface, World};
use kaustik_spectrum::{
    EmissionSpectrum, Spectrum, Tabulated, Wavelengths, integrate_xyz, uplift_emission,
};

use super::Slot;
use super::color::{luminance, tabulated};
use crate::description::MaterialDescription;
use crate::scene::SceneError;
use crate::texture::{Coding, Texture};

/// Points of a triangle at which a texture is looked at for its mean (barycentric u, v).
const PROBES: [[f32; 2]; 7] = [
    [0.333, 0.333],
    [0.1, 0.1],
    [0.8, 0.1],
    [0.1, 0.8],
    [0.45, 0.45],
    [0.1, 0.45],
    [0.45, 0.1],
];

/// Emitted radiance: one spectrum, or one that a texture colours.
#[derive(Debug)]
pub(super) struct Emission {
    source: Source,
    slot: Option<Slot>,
    /// Luminance where the texture is white.
    luminance: f64,
    /// Takes the vertex colour as well (unlit surfaces show their base colour).
    vertex_color: bool,
}

#[derive(Debug)]
enum Source {
    Rgb([f32; 3], EmissionSpectrum),
    Table(Tabulated),
}

impl Emission {
    /// `None` if nothing is emitted. `slot` is the emissive texture's.
    pub(super) fn new(
        description: &MaterialDescription,
        slot: Option<Slot>,
        base_slot: Option<Slot>,
    ) -> Result<Option<Self>, SceneError> {
        if description.unlit {
            let [r, g, b, _] = description.base_color;
            let shown = Self::of_rgb([r, g, b], base_slot);
            return Ok(Some(Self {
                vertex_color: true,
                ..shown
            }));
        }
        if let Some(input) = &description.emission {
            let table = tabulated(input, &description.name, "emission")?;
            let luminance = integrate_xyz(|nm| f64::from(table.at(nm as f32)))[1];
            let lit = luminance > 0.0;
            return Ok(lit.then_some(Self {
                source: Source::Table(table),
                slot,
                luminance,
                vertex_color: false,
            }));
        }
        let lit = description.emissive.iter().any(|&c| c > 0.0);
        Ok(lit.then(|| Self::of_rgb(description.emissive, slot)))
    }

    fn of_rgb(rgb: [f32; 3], slot: Option<Slot>) -> Self {
        Self {
            source: Source::Rgb(rgb, uplift_emission(rgb)),
            slot,
            luminance: f64::from(luminance(rgb)),
            vertex_color: false,
        }
    }

    /// The same everywhere?
    pub(super) fn is_even(&self) -> bool {
        self.slot.is_none() && !self.vertex_color
    }

    /// Radiance at a point.
    #[inline]
    pub(super) fn eval(
        &self,
        textures: &[Texture],
        surface: &Surface,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        if self.is_even() {
            return self.eval_even(wavelengths);
        }
        let tint = self.tint(textures, surface);
        match &self.source {
            Source::Rgb(rgb, _) => {
                uplift_emission([0, 1, 2].map(|i| rgb[i] * tint[i])).eval(wavelengths)
            }
            Source::Table(table) => table.eval(wavelengths) * luminance(tint),
        }
    }

    /// The same where it is the same everywhere.
    #[inline]
    pub(super) fn eval_even(&self, wavelengths: &Wavelengths) -> Spectrum {
        match &self.source {
            Source::Rgb(_, spectrum) => spectrum.eval(wavelengths),
            Source::Table(table) => table.eval(wavelengths),
        }
    }

    fn tint(&self, textures: &[Texture], surface: &Surface) -> [f32; 3] {
        let texel = self
            .slot
            .as_ref()
            .map_or([1.0; 4], |slot| slot.read(textures, surface, Coding::Srgb));
        let vertex = if self.vertex_color {
            surface.color
        } else {
            [1.0; 4]
        };
        [0, 1, 2].map(|i| texel[i] * vertex[i])
    }

    /// Rough mean luminance over a triangle.
    pub(super) fn mean(
        &self,
        textures: &[Texture],
        world: &World,
        instance: u32,
        primitive: u32,
    ) -> f64 {
        if self.is_even() {
            return self.luminance;
        }
        let sum: f64 = PROBES
            .iter()
            .map(|&[u, v]| {
                let surface = world.surface_at(instance, primitive, u, v);
                f64::from(luminance(self.tint(textures, &surface)))
            })
            .sum();
        // Never zero: the probes may have missed what shines.
        self.luminance * (sum / PROBES.len() as f64).max(1e-3)
    }
}
