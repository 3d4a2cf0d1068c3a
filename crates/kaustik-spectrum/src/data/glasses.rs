//! Dispersion formulas of clear solids and liquids.
//!
//! From refractiveindex.info's database (CC0, see `LICENSES.md`). Wavelengths in micrometres.

use crate::glass::Glass;

/// Name as used in scene files, the formula.
#[rustfmt::skip]
pub(crate) const GLASSES: [(&str, Glass); 13] = [
    // SCHOTT N-BK7 crown glass; fits 0.3-2.5 um, nd 1.5168, Vd 64.167
    ("n-bk7", Glass::Sellmeier {
        b: [1.03961212, 0.231792344, 1.01046945, 0.0],
        c: [0.00600069867, 0.0200179144, 103.560653, 0.0],
    }),
    // SCHOTT SF10 dense flint; fits 0.38-2.5 um, nd 1.72825, Vd 28.41
    ("sf10", Glass::Sellmeier {
        b: [1.61625977, 0.259229334, 1.07762317, 0.0],
        c: [0.0127534559, 0.0581983954, 116.60768, 0.0],
    }),
    // SCHOTT SF11 dense flint; fits 0.39-2.5 um, nd 1.78472, Vd 25.757
    ("sf11", Glass::Sellmeier {
        b: [1.73848403, 0.311168974, 1.17490871, 0.0],
        c: [0.0136068604, 0.0615960463, 121.922711, 0.0],
    }),
    // SCHOTT N-SF11; fits 0.37-2.5 um, nd 1.78472, Vd 25.68
    ("n-sf11", Glass::Sellmeier {
        b: [1.73759695, 0.313747346, 1.89878101, 0.0],
        c: [0.013188707, 0.0623068142, 155.23629, 0.0],
    }),
    // SCHOTT N-SF6; fits 0.37-2.5 um, nd 1.80518, Vd 25.36
    ("n-sf6", Glass::Sellmeier {
        b: [1.77931763, 0.338149866, 2.08734474, 0.0],
        c: [0.0133714182, 0.0617533621, 174.01759, 0.0],
    }),
    // SCHOTT F2 flint; fits 0.32-2.5 um, nd 1.62004, Vd 36.366
    ("f2", Glass::Sellmeier {
        b: [1.34533359, 0.209073176, 0.937357162, 0.0],
        c: [0.00997743871, 0.0470450767, 111.886764, 0.0],
    }),
    // SCHOTT N-SF66; fits 0.39-2.5 um, nd 1.92286, Vd 20.88
    ("n-sf66", Glass::Sellmeier {
        b: [2.0245976, 0.470187196, 2.59970433, 0.0],
        c: [0.0147053225, 0.0692998276, 161.817601, 0.0],
    }),
    // Fused silica, Malitson 1965, 20 C; fits 0.21-6.7 um, nd 1.458464, Vd 67.821
    ("fused_silica", Glass::Sellmeier {
        b: [0.6961663, 0.4079426, 0.8974794, 0.0],
        c: [0.00467914825849, 0.013512063074, 97.9340025379, 0.0],
    }),
    // Diamond, Peter 1923; fits 0.226-0.76 um, nd 2.417486, Vd 55.301
    ("diamond", Glass::Sellmeier {
        b: [0.3306, 4.3356, 0.0, 0.0],
        c: [0.030625, 0.011236, 0.0, 0.0],
    }),
    // Distilled water 20 C, Daimon & Masumura 2007; fits 0.182-1.129 um, nd 1.333403, Vd 55.76
    ("water_20c", Glass::Sellmeier {
        b: [0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688],
        c: [0.005101829712, 0.01821153936, 0.02620722293, 10.69792721],
    }),
    // Acrylic (PMMA), Sultanova et al. 2009; fits 0.4368-1.052 um, nd 1.490618, Vd 53.176
    ("pmma_sultanova", Glass::Sellmeier {
        b: [1.1819, 0.0, 0.0, 0.0],
        c: [0.011313, 0.0, 0.0, 0.0],
    }),
    // Acrylic (PMMA), Beadie et al. 2015; fits 0.42-1.62 um, nd 1.492527, Vd 59.367
    ("pmma_beadie", Glass::Polynomial {
        a: [-0.0015004, 0.0061209, 2.1778, 0.023678, -0.0042137, 0.00073417, -4.5042e-05],
    }),
    // Sapphire, ordinary ray, Malitson & Dodge 1972; fits 0.2-5.0 um, nd 1.768172, Vd 72.309
    ("sapphire_o", Glass::Sellmeier {
        b: [1.4313493, 0.65054713, 5.3414021, 0.0],
        c: [0.00527992610161, 0.0142382647056, 325.017834119, 0.0],
    }),
];
