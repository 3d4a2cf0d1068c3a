/// Pixels of a decoded image, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// Four bytes a pixel (red, green, blue, alpha), as stored: colour textures are sRGB-coded.
    Rgba8(Vec<u8>),
    /// Four numbers of 16 bits a pixel, coded as bytes are: what a PNG of 16 bits holds.
    Rgba16(Vec<u16>),
    /// Three floats a pixel, linear Rec.709.
    RgbF32(Vec<f32>),
}

/// A decoded image. `pixels` holds `width * height` pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageData {
    /// Name or uri, for messages.
    pub name: String,
    /// Columns, > 0.
    pub width: u32,
    /// Rows, > 0.
    pub height: u32,
    /// Row-major from the top left.
    pub pixels: Pixels,
    /// The undecoded file (PNG or JPEG; Radiance HDR for an environment), kept so that an export
    /// is exact; empty if there is none.
    pub encoded: Vec<u8>,
}
