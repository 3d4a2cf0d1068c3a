//! The law of a wavelength and its inverse CDF.
//!
//! The pdf is linear between whole nanometres, so the CDF is a parabola on each and is inverted
//! in closed form; a guide table finds the nanometre in one or two steps. All tables are built at
//! compile time, in double precision.

use crate::Spectrum;
use crate::cmf::{KNOTS, NM_MIN, cell};
use crate::data::cie_1931::CIE_1931;
use crate::rgb::XYZ_TO_RGB;

/// How a path's wavelengths are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum WavelengthSampling {
    /// Four wavelengths over 360-830 nm, density proportional to |rbar| + |gbar| + |bbar| and a
    /// small floor.
    #[default]
    Hero,
    /// One wavelength in all lanes, uniform over 400-700 nm (RELT 5.1.1).
    Single,
}

impl WavelengthSampling {
    /// Density of a wavelength, per nm; 0 outside the range.
    pub fn pdf(self, nm: f64) -> f64 {
        match self {
            Self::Hero if (360.0..=830.0).contains(&nm) => {
                let x = nm - 360.0;
                let i = (x as usize).min(KNOTS - 2);
                f64::from(CELLS[i].pdf) + (x - i as f64) * f64::from(CELLS[i].rise)
            }
            Self::Single if (400.0..=700.0).contains(&nm) => 1.0 / 300.0,
            _ => 0.0,
        }
    }

    /// Share of the law below a wavelength: the u whose hero it is.
    pub fn cdf(self, nm: f64) -> f64 {
        match self {
            Self::Hero => {
                let x = (nm - 360.0).clamp(0.0, 470.0);
                let i = (x as usize).min(KNOTS - 2);
                let (cell, s) = (&CELLS[i], x - i as f64);
                cell.cdf + s * (f64::from(cell.pdf) + 0.5 * s * f64::from(cell.rise))
            }
            Self::Single => ((nm - 400.0) / 300.0).clamp(0.0, 1.0),
        }
    }

    /// The wavelengths below which shares `u` in [0, 1] of the law lie.
    #[inline]
    pub(super) fn inverse(self, u: [f64; Spectrum::LANES]) -> Drawn {
        match self {
            Self::Hero => inverse(u),
            Self::Single => {
                let nm = Spectrum::new(u.map(|u| (400.0 + 300.0 * u) as f32));
                Drawn {
                    nm,
                    pdf: Spectrum::splat(1.0 / 300.0),
                    cells: nm.lanes().map(|nm| cell(nm).0 as u32),
                }
            }
        }
    }
}

/// Wavelengths as a law gave them.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    pub(super) nm: Spectrum,
    pub(super) pdf: Spectrum,
    /// The whole nanometre below each, from [`NM_MIN`].
    pub(super) cells: [u32; Spectrum::LANES],
}

/// The law on one nanometre: pdf + s rise at the share s of it, cdf at its left end.
#[derive(Clone, Copy)]
struct Cell {
    cdf: f64,
    next_cdf: f64,
    pdf: f32,
    rise: f32,
}

/// Smallest density, relative to |rbar| + |gbar| + |bbar| (whose maximum is 3.5): where the eye sees next
/// to nothing, one sample in 1000 goes all the same.
const FLOOR: f64 = 0.001;
/// So many that one in nine begins within the nanometre that it leads to.
const GUIDES: usize = 2048;

static CELLS: [Cell; KNOTS - 1] = cells();
static GUIDE: [u16; GUIDES] = guide(&cells());

#[inline]
fn inverse(u: [f64; Spectrum::LANES]) -> Drawn {
    let cells = u.map(|u| {
        let mut i = GUIDE[((u * GUIDES as f64) as usize).min(GUIDES - 1)];
        while CELLS[usize::from(i)].next_cdf <= u && usize::from(i) < KNOTS - 2 {
            i += 1;
        }
        u32::from(i)
    });
    let of_cell = |f: fn(&Cell) -> f32| Spectrum::new(cells.map(|i| f(&CELLS[i as usize])));
    let (pdf, rise) = (of_cell(|cell| cell.pdf), of_cell(|cell| cell.rise));
    // s pdf + s^2 rise / 2 = rest, in the form that does not cancel; single precision resolves a
    // nanometre far below what nm itself does
    let rest = Spectrum::from_fn(|lane| (u[lane] - CELLS[cells[lane] as usize].cdf) as f32);
    let root = (pdf * pdf + 2.0 * rise * rest)
        .map(|square| square.max(0.0))
        .sqrt();
    let s = (2.0 * rest / (pdf + root)).clamp(0.0, 1.0);
    Drawn {
        nm: NM_MIN + (Spectrum::new(cells.map(|i| i as f32)) + s),
        pdf: pdf + s * rise,
        cells,
    }
}

const fn unnormalised(i: usize) -> f64 {
    let [x, y, z] = CIE_1931[i];
    let mut sum = FLOOR;
    let mut c = 0;
    while c < 3 {
        let [by_x, by_y, by_z] = XYZ_TO_RGB[c];
        sum += (by_x * x + by_y * y + by_z * z).abs();
        c += 1;
    }
    sum
}

const fn cells() -> [Cell; KNOTS - 1] {
    let mut total = 0.0;
    let mut i = 0;
    while i + 1 < KNOTS {
        total += 0.5 * (unnormalised(i) + unnormalised(i + 1));
        i += 1;
    }
    let mut out = [Cell {
        cdf: 0.0,
        next_cdf: 0.0,
        pdf: 0.0,
        rise: 0.0,
    }; KNOTS - 1];
    let mut cdf = 0.0;
    let mut i = 0;
    while i + 1 < KNOTS {
        let (a, b) = (unnormalised(i) / total, unnormalised(i + 1) / total);
        let next_cdf = cdf + 0.5 * (a + b);
        out[i] = Cell {
            cdf,
            next_cdf,
            pdf: a as f32,
            rise: (b - a) as f32,
        };
        cdf = next_cdf;
        i += 1;
    }
    out[KNOTS - 2].next_cdf = 1.0;
    out
}

/// The cell in which each of the equal shares of u begins.
const fn guide(cells: &[Cell; KNOTS - 1]) -> [u16; GUIDES] {
    let mut out = [0; GUIDES];
    let (mut g, mut i) = (0, 0);
    while g < GUIDES {
        while cells[i].next_cdf <= g as f64 / GUIDES as f64 {
            i += 1;
        }
        out[g] = i as u16;
        g += 1;
    }
    out
}
