//! Pictures inside a page: PNG as base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use kaustik::film::{Image, Layer, Tone, Window, png};

use crate::StudyError;

/// A picture as the address of its own bytes.
pub(crate) fn address(image: &Image, tone: &Tone) -> Result<String, StudyError> {
    let mut bytes = Vec::new();
    png::encode(&mut bytes, image, tone).map_err(|e| StudyError::page("picture", e))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(bytes)))
}

/// A part of a picture.
pub(crate) fn close_up(image: &Image, window: Window, tone: &Tone) -> Result<String, StudyError> {
    address(&image.cropped(window)?, tone)
}

/// A layer of R, G and B as a picture; `None` if it is another kind.
pub(crate) fn layer(image: &Image, layer: &Layer) -> Option<Image> {
    let plane = |name| Some(layer.channel(name)?.to_vec());
    let planes = [plane("R")?, plane("G")?, plane("B")?];
    Image::from_rgb(image.width(), image.height(), planes).ok()
}

/// Relative errors in false colours: black is 1 % and below, white 100 % and above, a power of ten
/// half the scale. What is no number is blue.
pub(crate) fn error_map(width: u32, height: u32, errors: &[f32]) -> Result<String, StudyError> {
    map(width, height, errors, |e| heat(level(e.abs())))
}

/// Signed differences as in G figure 9: green is too bright, red too dark, black right; full at 50 %.
pub(crate) fn signed_map(width: u32, height: u32, errors: &[f32]) -> Result<String, StudyError> {
    map(width, height, errors, |e| signed(e / 0.5))
}

/// Numbers in false colours by their logarithm: white is the largest, black a ten-thousandth of it and less.
pub(crate) fn log_map(
    width: u32,
    height: u32,
    values: &[f32],
    largest: f32,
) -> Result<String, StudyError> {
    map(width, height, values, |v| {
        let level = 1.0 + (v / largest).log10() / 4.0;
        heat(if level.is_nan() { 0.0 } else { level })
    })
}

/// Regions by number, each in a colour of its own; black where there is none.
pub(crate) fn region_map(
    width: u32,
    height: u32,
    regions: &[Option<u32>],
) -> Result<String, StudyError> {
    let colours: Vec<[f32; 3]> = (regions.iter())
        .map(|region| region.map_or([0.0; 3], region_colour))
        .collect();
    picture(width, height, &colours)
}

/// Neighbours in number are far apart in hue: it goes on by the golden section of the circle.
fn region_colour(number: u32) -> [f32; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let hue = (f64::from(number) * GOLDEN).fract() as f32;
    let full = [255.0, 190.0, 135.0][number as usize % 3];
    [0.0, 2.0 / 3.0, 1.0 / 3.0].map(|turn| {
        let away = ((hue + turn).fract() - 0.5).abs();
        full * (6.0 * away - 1.0).clamp(0.15, 1.0)
    })
}

/// Where on the scale of [`error_map`] a relative error lies.
fn level(error: f32) -> f32 {
    if error <= 0.01 {
        return 0.0;
    }
    ((error.log10() + 2.0) / 2.0).clamp(0.0, 1.0)
}

/// Stops of a scale from black over purple and orange to white, sRGB codes.
const HEAT: [[f32; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [70.0, 15.0, 110.0],
    [180.0, 45.0, 90.0],
    [240.0, 110.0, 30.0],
    [250.0, 205.0, 60.0],
    [255.0, 255.0, 255.0],
];

fn heat(level: f32) -> [f32; 3] {
    let place = level.clamp(0.0, 1.0) * (HEAT.len() - 1) as f32;
    let low = (place as usize).min(HEAT.len() - 2);
    let share = place - low as f32;
    std::array::from_fn(|c| HEAT[low][c] + share * (HEAT[low + 1][c] - HEAT[low][c]))
}

fn signed(level: f32) -> [f32; 3] {
    let full = 255.0 * level.abs().min(1.0);
    if level >= 0.0 {
        [0.0, full, 0.0]
    } else {
        [full, 0.0, 0.0]
    }
}

/// The scales as gradients for a style sheet, lowest first.
pub(crate) fn heat_gradient() -> String {
    let stops = HEAT.map(|[r, g, b]| format!("rgb({r},{g},{b})"));
    format!("linear-gradient(90deg,{})", stops.join(","))
}

pub(crate) fn signed_gradient() -> String {
    let stops = [-1.0, 0.0, 1.0].map(signed);
    let stops = stops.map(|[r, g, b]| format!("rgb({r},{g},{b})"));
    format!("linear-gradient(90deg,{})", stops.join(","))
}

fn map(
    width: u32,
    height: u32,
    values: &[f32],
    colour: impl Fn(f32) -> [f32; 3],
) -> Result<String, StudyError> {
    let pixels: Vec<[f32; 3]> = (values.iter())
        .map(|&v| {
            if v.is_nan() {
                [0.0, 0.0, 255.0]
            } else {
                colour(v)
            }
        })
        .collect();
    picture(width, height, &pixels)
}

/// Of sRGB codes.
fn picture(width: u32, height: u32, pixels: &[[f32; 3]]) -> Result<String, StudyError> {
    let plane = |c: usize| pixels.iter().map(|p| linear(p[c])).collect();
    let image = Image::from_rgb(width, height, [plane(0), plane(1), plane(2)])?;
    address(&image, &Tone::default())
}

/// The inverse of the sRGB curve that the PNG is written with.
fn linear(code: f32) -> f32 {
    let x = code / 255.0;
    if x <= 0.040_45 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The picture of an address.
    pub(crate) fn decoded(address: &str) -> Image {
        let bytes = STANDARD.decode(address.split_once(',').unwrap().1).unwrap();
        let limits = kaustik::film::Limits::default();
        kaustik::film::decode(&bytes, &limits, kaustik::film::Keep::Main).unwrap()
    }

    #[test]
    fn colour_scales_begin_and_end_as_they_say() {
        assert_eq!(level(0.005).to_bits(), 0.0f32.to_bits());
        assert!((level(0.1) - 0.5).abs() < 1e-6 && (level(1.0) - 1.0).abs() < 1e-6);
        let bits = |colour: [f32; 3]| colour.map(f32::to_bits);
        assert_eq!(bits(heat(0.0)), bits(HEAT[0]));
        assert_eq!(bits(heat(1.0)), bits(HEAT[5]));
        assert_eq!(bits(signed(0.0)), bits([0.0; 3]));
        assert_eq!(bits(signed(1.0)), bits([0.0, 255.0, 0.0]));
        assert_eq!(bits(signed(-2.0)), bits([255.0, 0.0, 0.0]));
    }

    #[test]
    fn false_colours_arrive_as_they_are() {
        let text = error_map(2, 1, &[1.0, f32::NAN]).unwrap();
        let [r, g, b] = decoded(&text).rgb().map(<[f32]>::to_vec);
        let near = |v: f32, to: f32| (v - to).abs() < 1e-5;
        assert!(near(r[0], 1.0) && near(g[0], 1.0) && near(b[0], 1.0));
        assert!(near(r[1], 0.0) && near(g[1], 0.0) && near(b[1], 1.0));
    }
}
