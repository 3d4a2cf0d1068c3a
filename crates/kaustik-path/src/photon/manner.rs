//! How light leaves a measurement point.

use kaustik_bsdf::Lobe;

use super::points::Seen;

/// How light leaves toward the eye, with what is true or not of that, in the highest bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner(u32);

/// How light leaves toward the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scattering {
    /// Evenly: the value is in the throughput.
    Diffuse,
    /// As the entry of a list says, which is below [`MeasurementPoints::MOST`](super::MeasurementPoints::MOST).
    Listed(u32),
}

impl Manner {
    /// The camera walk has refracted where the index depends on the wavelength.
    pub(super) const DISPERSIVE: u32 = 1 << 31;
    /// The surface is seen from its front.
    pub(super) const FRONT: u32 = 1 << 30;
    /// Light from the other side does not come through.
    pub(super) const OPAQUE: u32 = 1 << 29;
    /// Something stands in the disc: the number is that of its outline, which has the scattering's.
    pub(super) const OUTLINED: u32 = 1 << 28;
    /// All bits below: the number of an entry of a list.
    pub(super) const NUMBER: u32 = Self::OUTLINED - 1;
    /// The number that no entry has.
    const DIFFUSE: u32 = Self::NUMBER;

    pub(super) fn of(seen: &Seen<'_>, scattering: Scattering) -> Self {
        let number = scattering.number();
        let flag = |flag: u32, holds: bool| if holds { flag } else { 0 };
        Self(
            number
                | flag(Self::DISPERSIVE, seen.dispersive)
                | flag(Self::FRONT, seen.wo.z > 0.0)
                | flag(Self::OPAQUE, !seen.bsdf.transmits()),
        )
    }

    /// The same with another number.
    pub(super) fn numbered(self, number: u32) -> Self {
        Self((self.0 & !Self::NUMBER) | number)
    }

    /// The same with something in the disc.
    pub(super) fn outlined(self, number: u32) -> Self {
        Self(self.numbered(number).0 | Self::OUTLINED)
    }

    /// Of the scattering, or, where something stands in the disc, of the outline.
    #[inline]
    pub(super) fn number(self) -> u32 {
        self.0 & Self::NUMBER
    }

    #[inline]
    pub(super) fn is(self, flag: u32) -> bool {
        self.0 & flag != 0
    }
}

impl Scattering {
    pub(super) fn number(self) -> u32 {
        match self {
            Self::Diffuse => Manner::DIFFUSE,
            Self::Listed(index) => index,
        }
    }

    #[inline]
    pub(super) fn of_number(number: u32) -> Self {
        match number {
            Manner::DIFFUSE => Self::Diffuse,
            index => Self::Listed(index),
        }
    }

    /// The same behind so many others in a list.
    pub(super) fn after(self, others: u32) -> Self {
        match self {
            Self::Diffuse => Self::Diffuse,
            Self::Listed(index) => Self::Listed(others + index),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use kaustik_bsdf::Bsdf;
    use kaustik_scene::Vertex;
    use kaustik_spectrum::Spectrum;

    use super::super::points::tests::{glass, seen};
    use super::*;

    #[test]
    fn a_manner_has_what_it_was_made_of() {
        let (vertex, grey) = (Vertex::default(), Bsdf::lambertian(Spectrum::splat(0.5)));
        let listed = [0, 1, 77, Manner::DIFFUSE - 1].map(Scattering::Listed);
        for scattering in listed.into_iter().chain([Scattering::Diffuse]) {
            for number in 0..8 {
                let [dispersive, front, opaque] = [1, 2, 4].map(|bit| number & bit != 0);
                let bsdf = if opaque { grey } else { glass() };
                let wo = DVec3::new(0.6, 0.0, if front { 0.8 } else { -0.8 });
                let seen = Seen {
                    dispersive,
                    ..seen(&vertex, bsdf, wo)
                };
                let manner = Manner::of(&seen, scattering);
                assert_eq!(Scattering::of_number(manner.number()), scattering);
                assert_eq!(manner.is(Manner::DISPERSIVE), dispersive);
                assert_eq!(manner.is(Manner::FRONT), front);
                assert_eq!(manner.is(Manner::OPAQUE), opaque);
                let moved = manner.numbered(5);
                assert_eq!(moved.number(), 5);
                assert_eq!(moved.0 & !Manner::NUMBER, manner.0 & !Manner::NUMBER);
            }
        }
    }
}
