//! From linear light to display codes: exposure and tone curve.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// How linear values become display values in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneCurve {
    /// Clipped to [0, 1], then the sRGB curve (IEC 61966-2-1): faithful below white, nothing above.
    #[default]
    Srgb,
    /// Highlights are rolled off and shadows deepened a little, a channel at a time, by
    /// x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14) (Narkowicz 2015, a fit to the ACES reference
    /// rendering), then the sRGB curve. 1 becomes 0.80 and 4 becomes 0.97 of white; middle gray 0.18
    /// becomes 0.27.
    Filmic,
}

/// A name that is no tone curve.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown tone curve '{0}': expected srgb or filmic")]
pub struct ToneError(String);

impl FromStr for ToneCurve {
    type Err = ToneError;

    fn from_str(text: &str) -> Result<Self, ToneError> {
        match text {
            "srgb" => Ok(Self::Srgb),
            "filmic" => Ok(Self::Filmic),
            _ => Err(ToneError(text.to_owned())),
        }
    }
}

impl std::fmt::Display for ToneCurve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Srgb => "srgb",
            Self::Filmic => "filmic",
        })
    }
}

/// How a picture is shown on eight bits a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tone {
    /// Stops: linear values are multiplied by 2^exposure first. 0 by default.
    pub exposure: f64,
    /// The curve.
    pub curve: ToneCurve,
}

impl Tone {
    /// The 8-bit code of a linear value; NaN and negative values are black.
    #[must_use]
    pub fn code(&self, linear: f32) -> u8 {
        self.code_scaled(linear, self.scale())
    }

    pub(crate) fn scale(&self) -> f64 {
        libm::exp2(self.exposure)
    }

    pub(crate) fn code_scaled(&self, linear: f32, scale: f64) -> u8 {
        let x = f64::from(linear) * scale;
        if x.is_nan() {
            return 0;
        }
        let x = x.clamp(0.0, 1e6);
        let x = match self.curve {
            ToneCurve::Srgb => x,
            ToneCurve::Filmic => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        };
        (to_srgb(x.min(1.0)) * 255.0 + 0.5) as u8
    }
}

/// The sRGB curve: linear in [0, 1] to display value in [0, 1].
pub(crate) fn to_srgb(x: f64) -> f64 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * libm::pow(x, 1.0 / 2.4) - 0.055
    }
}

/// Its inverse.
pub(crate) fn from_srgb(x: f64) -> f64 {
    if x <= 0.040_45 {
        x / 12.92
    } else {
        libm::pow((x + 0.055) / 1.055, 2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip() {
        let tone = Tone::default();
        for code in 0..=255u8 {
            let linear = from_srgb(f64::from(code) / 255.0) as f32;
            assert_eq!(tone.code(linear), code);
        }
    }

    #[test]
    fn hostile_values_are_clipped() {
        for curve in [ToneCurve::Srgb, ToneCurve::Filmic] {
            let tone = Tone {
                exposure: 0.0,
                curve,
            };
            assert_eq!(tone.code(f32::NAN), 0);
            assert_eq!(tone.code(-1.0), 0);
            assert_eq!(tone.code(f32::NEG_INFINITY), 0);
            assert_eq!(tone.code(f32::INFINITY), 255);
        }
    }

    #[test]
    fn exposure_is_in_stops() {
        let brighter = Tone {
            exposure: 1.0,
            curve: ToneCurve::Srgb,
        };
        assert_eq!(brighter.code(0.25), Tone::default().code(0.5));
    }

    #[test]
    fn the_filmic_curve_is_as_documented() {
        let tone = Tone {
            exposure: 0.0,
            curve: ToneCurve::Filmic,
        };
        for (x, y) in [(1.0, 0.8038), (4.0, 0.9734), (0.18, 0.2669)] {
            let plain = Tone::default().code(y);
            assert_eq!(tone.code(x), plain, "{x}");
        }
        let codes: Vec<u8> = (0..1000).map(|i| tone.code(i as f32 * 0.01)).collect();
        assert!(codes.is_sorted());
    }

    #[test]
    fn names_of_curves_are_read_and_others_refused() {
        assert_eq!("filmic".parse::<ToneCurve>().unwrap().to_string(), "filmic");
        assert!(
            "aces"
                .parse::<ToneCurve>()
                .unwrap_err()
                .to_string()
                .contains("srgb or filmic")
        );
    }
}
