//! Absorption of water.

use crate::data::water::WATER_K;
use crate::guide::Guide;
use crate::{Spectrum, Wavelengths};

/// Absorption coefficient of pure water at 25 C, in 1/m, at a path's wavelengths: light is
/// left with `exp(-sigma d)` after d metres. Hale and Querry 1973.
///
/// sigma = 4 pi k / wavelength with the absorption index k linear between the 25 nm knots. The index of
/// refraction of water is [`Glass::named`](crate::Glass::named)`("water_20c")`.
pub fn water_absorption(wavelengths: &Wavelengths) -> Spectrum {
    Spectrum::new(wavelengths.nm().map(at))
}

static NM: [f32; WATER_K.len()] = NM_CONST;

const NM_CONST: [f32; WATER_K.len()] = {
    let mut nm = [0.0; WATER_K.len()];
    let mut i = 0;
    while i < WATER_K.len() {
        nm[i] = WATER_K[i][0] as f32;
        i += 1;
    }
    nm
};

static GUIDE: Guide = Guide::new(&NM_CONST);

fn at(nm: f32) -> f32 {
    let (i, s) = GUIDE.find(&NM, nm);
    let (a, b) = (WATER_K[i][1], WATER_K[(i + 1).min(WATER_K.len() - 1)][1]);
    let k = a + f64::from(s) * (b - a);
    (4.0 * std::f64::consts::PI * k / (f64::from(nm) * 1e-9)) as f32
}
