use crate::Stream;

/// A point of the primary sample space, read coordinate by coordinate.
///
/// Access is random: a coordinate that is never asked for shifts nothing. Asking twice
/// for the same one within an evaluation gives the same number, unless the
/// implementation says otherwise (plain Monte Carlo on a generator remembers nothing);
/// a builder that keeps to one ask per address works with all of them.
pub trait Coordinates {
    /// The coordinate `index` of `stream`: in [0, 1), uniform and independent of all
    /// others under plain Monte Carlo.
    fn get(&mut self, stream: Stream, index: u32) -> f64;

    /// The coordinates `index` and `index + 1` of `stream`, in this order.
    fn get2(&mut self, stream: Stream, index: u32) -> [f64; 2] {
        let first = self.get(stream, index);
        [first, self.get(stream, index + 1)]
    }
}

#[deny(clippy::missing_trait_methods)]
impl<C: Coordinates + ?Sized> Coordinates for &mut C {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        (**self).get(stream, index)
    }

    fn get2(&mut self, stream: Stream, index: u32) -> [f64; 2] {
        (**self).get2(stream, index)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<C: Coordinates + ?Sized> Coordinates for Box<C> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        (**self).get(stream, index)
    }

    fn get2(&mut self, stream: Stream, index: u32) -> [f64; 2] {
        (**self).get2(stream, index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Address;

    impl Coordinates for Address {
        fn get(&mut self, stream: Stream, index: u32) -> f64 {
            stream as u8 as f64 / 8.0 + f64::from(index) / 1024.0
        }
    }

    #[test]
    fn a_pair_is_two_neighbours_in_order() {
        let [a, b] = Address.get2(Stream::Light, 4);
        assert_eq!(a.to_bits(), Address.get(Stream::Light, 4).to_bits());
        assert_eq!(b.to_bits(), Address.get(Stream::Light, 5).to_bits());
    }

    #[test]
    fn works_through_references_boxes_and_objects() {
        fn read(mut u: impl Coordinates) -> f64 {
            u.get(Stream::Time, 1)
        }
        let expected = Address.get(Stream::Time, 1).to_bits();
        let object: &mut dyn Coordinates = &mut Address;
        assert_eq!(read(object).to_bits(), expected);
        let boxed: Box<dyn Coordinates> = Box::new(Address);
        assert_eq!(read(boxed).to_bits(), expected);
    }
}
