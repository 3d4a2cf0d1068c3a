//! The settings of photon methods.

use crate::method::{Key, Method};

/// Settings that only photon methods read.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the table of keys says what each does")]
pub struct PhotonOptions {
    pub photons: u64,
    pub roughness: f64,
    pub radius: f64,
    /// `None`: the radius stays.
    pub reduction: Option<f64>,
    pub remainder: bool,
}

impl Default for PhotonOptions {
    fn default() -> Self {
        Self {
            photons: 250_000,
            roughness: 0.39,
            radius: 1.0,
            reduction: None,
            remainder: true,
        }
    }
}

/// Methods that trace photons.
const PHOTONS: &[Method] = &[Method::Sppm];

/// Light paths of an iteration.
pub(crate) const LIGHT_PATHS: Key = Key {
    name: "photons",
    default: "250000",
    range: "1000..=100000000",
    meaning: "light paths an iteration: each iteration sees the scene from new points, with new wavelengths \
              (the paper on the spatial target function takes 10 million)",
    methods: PHOTONS,
};
/// Where measurement points stand.
pub(crate) const ROUGHNESS: Key = Key {
    name: "roughness",
    default: "0.39",
    range: "0 <= alpha <= 1",
    meaning: "lobes of this GGX roughness or more show the light of photons; narrower ones are followed \
              further from the camera",
    methods: PHOTONS,
};
/// Their size.
pub(crate) const RADIUS: Key = Key {
    name: "radius",
    default: "1",
    range: "0.01 <= widths <= 100",
    meaning: "radius within which a photon counts, in widths of a pixel on the surface that it shows",
    methods: PHOTONS,
};
/// How that changes.
pub(crate) const REDUCTION: Key = Key {
    name: "reduction",
    default: "off",
    range: "off|0 < alpha < 1",
    meaning: "shrinks the radius from iteration to iteration so that its error vanishes in the end: the square by \
              (i + alpha) / (i + 1); 0.7 is usual (Hachisuka and Jensen 2009)",
    methods: PHOTONS,
};
/// What they cannot carry.
pub(crate) const REMAINDER: Key = Key {
    name: "remainder",
    default: "on",
    range: "on|off",
    meaning: "path tracing of what photons cannot carry, light that reaches the camera by mirrors, glass and \
              narrow lobes alone; off: emitters seen directly are all that is left of it",
    methods: PHOTONS,
};

impl PhotonOptions {
    /// A setting as one would write it; `None` if the key is none of these.
    pub(crate) fn value(&self, key: &str) -> Option<String> {
        let switch = |on| if on { "on" } else { "off" }.to_owned();
        Some(match key {
            "photons" => self.photons.to_string(),
            "roughness" => self.roughness.to_string(),
            "radius" => self.radius.to_string(),
            "reduction" => (self.reduction).map_or("off".to_owned(), |alpha| alpha.to_string()),
            "remainder" => switch(self.remainder),
            _ => return None,
        })
    }

    /// `None` if the key is none of these or the value is out of range.
    pub(crate) fn assign(&mut self, key: &str, value: &str) -> Option<()> {
        let number = || value.parse().ok().filter(|x: &f64| x.is_finite());
        match key {
            "photons" => {
                let photons = value.parse().ok();
                self.photons = photons.filter(|n| (1_000..=100_000_000).contains(n))?;
            }
            "roughness" => self.roughness = number().filter(|a| (0.0..=1.0).contains(a))?,
            "radius" => self.radius = number().filter(|r| (0.01..=100.0).contains(r))?,
            "reduction" if value == "off" => self.reduction = None,
            "reduction" => self.reduction = Some(number().filter(|a| *a > 0.0 && *a < 1.0)?),
            "remainder" => self.remainder = switch(value)?,
            _ => return None,
        }
        Some(())
    }
}

fn switch(value: &str) -> Option<bool> {
    match value {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    #[test]
    fn what_is_written_of_photons_is_what_was_set() {
        let mut options = Options::default();
        for text in [
            "photons=5000",
            "roughness=0.05",
            "radius=2.5",
            "reduction=0.7",
            "remainder=off",
        ] {
            options.set(Method::Sppm, text).unwrap();
        }
        let mut again = Options::default();
        for (key, value) in options.entries(Method::Sppm) {
            again.set(Method::Sppm, &format!("{key}={value}")).unwrap();
        }
        assert_eq!(again, options);
        assert_ne!(options.photon, PhotonOptions::default());
        for wrong in [
            "photons=10",
            "roughness=2",
            "radius=0",
            "reduction=1",
            "remainder=some",
        ] {
            assert!(again.set(Method::Sppm, wrong).is_err(), "{wrong}");
        }
        assert_eq!(again, options);
    }
}
