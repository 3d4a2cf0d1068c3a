//! Stand-ins with the shape of `kaustik-spectrum`'s colours, until that crate has them.

/// CIE XYZ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Xyz(pub [f32; 3]);

/// Linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rgb(pub [f32; 3]);

impl From<Xyz> for Rgb {
    fn from(xyz: Xyz) -> Self {
        let [x, y, z] = xyz.0.map(f64::from);
        Rgb([
            3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
            -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
            0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
        ]
        .map(|v| v as f32))
    }
}

impl From<Rgb> for Xyz {
    fn from(rgb: Rgb) -> Self {
        let [r, g, b] = rgb.0.map(f64::from);
        Xyz([
            0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b,
            0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b,
            0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b,
        ]
        .map(|v| v as f32))
    }
}
