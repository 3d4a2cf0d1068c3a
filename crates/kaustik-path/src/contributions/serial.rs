//! Contributions written down and read again (feature `serde`), checked as if they were pushed.

use glam::DVec2;
use kaustik_spectrum::Xyz;
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

use super::{Contributions, Largest, Quality, Splat, quality};
use crate::{Class, RayCounts};

/// Raster point, colour, class of a splat.
type Written = ([f64; 2], [f32; 3], u8);

impl Serialize for Contributions {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let written = |splat: &Splat| (splat.raster.to_array(), splat.xyz.0, splat.class as u8);
        let splats: Vec<Written> = self.splats.iter().map(written).collect();
        let largest = [self.largest.xyz, self.largest.luminance];
        (splats, largest, self.nonfinite, self.rays).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Contributions {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (splats, largest, nonfinite, rays) =
            <(Vec<Written>, [f32; 2], u32, RayCounts)>::deserialize(deserializer)?;
        if !largest.iter().all(|v| v.is_finite() && *v >= 0.0) {
            return Err(D::Error::custom(
                "a largest contribution is no amount of light",
            ));
        }
        let splats: Option<Vec<Splat>> = splats.into_iter().map(splat).collect();
        Ok(Self {
            splats: splats.ok_or_else(|| D::Error::custom("a splat is no amount of light"))?,
            largest: Largest {
                xyz: largest[0],
                luminance: largest[1],
            },
            nonfinite,
            rays,
        })
    }
}

fn splat((raster, xyz, class): Written) -> Option<Splat> {
    let (raster, xyz) = (DVec2::from(raster), Xyz(xyz));
    let light = raster.is_finite() && matches!(quality(xyz), Quality::Light);
    let class = *Class::ALL.get(usize::from(class))?;
    light.then_some(Splat { raster, xyz, class })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read() {
        let mut value = Contributions::default();
        value.push(DVec2::new(0.25, 0.5), Xyz([1.0, 2.0, 0.0]), Class::L4);
        value.push(DVec2::new(0.75, 0.1), Xyz([1e-30, 2e9, 3.5]), Class::L0);
        value.push(DVec2::ZERO, Xyz([f32::NAN; 3]), Class::L0);
        let bytes = postcard::to_allocvec(&value).expect("bytes");
        let again: Contributions = postcard::from_bytes(&bytes).expect("what was written");
        assert_eq!(again, value);
    }

    #[test]
    fn what_is_no_light_is_refused() {
        let sound: Written = ([0.5; 2], [1.0; 3], 5);
        let read = |splat: Written, largest: [f32; 2]| {
            let bytes = postcard::to_allocvec(&(vec![splat], largest, 0_u32, RayCounts::default()))
                .expect("bytes");
            postcard::from_bytes::<Contributions>(&bytes)
        };
        assert!(read(sound, [1.0; 2]).is_ok());
        for (raster, xyz, class) in [
            ([f64::NAN, 0.5], [1.0; 3], 5),
            ([0.5; 2], [-1.0, 2.0, 2.0], 5),
            ([0.5; 2], [f32::INFINITY; 3], 5),
            ([0.5; 2], [0.0; 3], 5),
            ([0.5; 2], [1.0; 3], 7),
        ] {
            assert!(read((raster, xyz, class), [1.0; 2]).is_err(), "{xyz:?}");
        }
        assert!(read(sound, [f32::NAN, 1.0]).is_err() && read(sound, [1.0, -1.0]).is_err());
    }
}
