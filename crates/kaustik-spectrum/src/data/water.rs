//! Absorption index of water at 25 C, Hale and Querry 1973.
//!
//! From refractiveindex.info's database (CC0, see `LICENSES.md`).

/// `[nm, k]`; the absorption coefficient is 4 pi k / wavelength.
#[rustfmt::skip]
pub(crate) const WATER_K: [[f64; 2]; 21] = [
    [350.0, 6.5e-09], [375.0, 3.5e-09], [400.0, 1.86e-09], [425.0, 1.3e-09], [450.0, 1.02e-09],
    [475.0, 9.35e-10], [500.0, 1e-09], [525.0, 1.32e-09], [550.0, 1.96e-09], [575.0, 3.6e-09],
    [600.0, 1.09e-08], [625.0, 1.39e-08], [650.0, 1.64e-08], [675.0, 2.23e-08],
    [700.0, 3.35e-08], [725.0, 9.15e-08], [750.0, 1.56e-07], [775.0, 1.48e-07],
    [800.0, 1.25e-07], [825.0, 1.82e-07], [850.0, 2.93e-07],
];
