use crate::layered::Layers;
use crate::principled::{PrincipledPieces, PrincipledStore};
use crate::shared::Shared;
use crate::{
    Bsdf, Coated, Conductor, Dielectric, Lambertian, Mirror, OrenNayar, Phong, RoughConductor,
    RoughDielectric, RoughThinDielectric, ThinDielectric,
};

/// One list a kind, for kinds that are stored as they are.
macro_rules! lists {
    ($($kind:ident $list:ident,)*) => {
        /// Many scattering functions in little memory, by number.
        ///
        /// A [`Bsdf`] takes as much memory as its largest kind. Here each takes only what its own kind does,
        /// and what functions that were added one soon after another have in common is stored once: a glTF
        /// material whose colour comes from a texture takes 28 bytes: its colour, and where its pieces are.
        #[derive(Clone, Debug, Default)]
        pub struct BsdfList {
            entries: Shared<Entry>,
            principled: PrincipledStore,
            layers: Shared<Layers>,
            layered: Shared<LayeredPieces>,
            $($list: Shared<$kind>,)*
        }

        /// Where a function's pieces are.
        #[derive(Clone, Copy, Debug, PartialEq)]
        enum Entry {
            $($kind(u32),)*
            Principled(PrincipledPieces),
            Layered(u32),
        }

        impl BsdfList {
            /// The number of a function, which is added if it is none of the last few.
            pub fn number(&mut self, bsdf: &Bsdf) -> u32 {
                let entry = match bsdf {
                    $(Bsdf::$kind(lobe) => Entry::$kind(self.$list.number(lobe)),)*
                    Bsdf::Principled(lobe) => Entry::Principled(self.principled.number(lobe)),
                    Bsdf::Layered(lobe) => {
                        let (layers, base) = lobe.apart();
                        let pieces = LayeredPieces {
                            layers: self.layers.number(&layers),
                            base: base.map(|base| self.principled.number(&base)),
                        };
                        Entry::Layered(self.layered.number(&pieces))
                    }
                };
                self.entries.number(&entry)
            }

            /// The function of a number that [`number`](Self::number) gave. Panics at others.
            #[inline]
            pub fn get(&self, number: u32) -> Bsdf {
                match self.entries.get(number) {
                    $(Entry::$kind(at) => Bsdf::$kind(self.$list.get(at)),)*
                    Entry::Principled(pieces) => Bsdf::Principled(self.principled.get(pieces)),
                    Entry::Layered(at) => {
                        let LayeredPieces { layers, base } = self.layered.get(at);
                        let base = base.map(|pieces| self.principled.get(pieces));
                        Bsdf::Layered(self.layers.get(layers).over(base))
                    }
                }
            }

            /// Takes another list's functions after its own; what their numbers grow by.
            pub fn append(&mut self, other: &Self) -> u32 {
                $(let $list = self.$list.append(&other.$list);)*
                let first = self.principled.append(&other.principled);
                let layers = self.layers.append(&other.layers);
                let layered = self.layered.append_as(&other.layered, |pieces| LayeredPieces {
                    layers: layers + pieces.layers,
                    base: pieces.base.map(|base| base.after(first)),
                });
                self.entries.append_as(&other.entries, |entry| match *entry {
                    $(Entry::$kind(at) => Entry::$kind($list + at),)*
                    Entry::Principled(pieces) => Entry::Principled(pieces.after(first)),
                    Entry::Layered(at) => Entry::Layered(layered + at),
                })
            }

            /// Forgets everything but the memory.
            pub fn clear(&mut self) {
                self.entries.clear();
                self.principled.clear();
                self.layers.clear();
                self.layered.clear();
                $(self.$list.clear();)*
            }

            /// Bytes of what is stored, without what is reserved.
            pub fn bytes(&self) -> usize {
                let plain = [$(self.$list.bytes(),)*];
                self.entries.bytes()
                    + self.principled.bytes()
                    + self.layers.bytes()
                    + self.layered.bytes()
                    + plain.into_iter().sum::<usize>()
            }
        }
    };
}

lists! {
    Lambertian lambertian,
    Mirror mirror,
    Conductor conductor,
    RoughConductor rough_conductor,
    Dielectric dielectric,
    RoughDielectric rough_dielectric,
    ThinDielectric thin_dielectric,
    RoughThinDielectric rough_thin_dielectric,
    Coated coated,
    Phong phong,
    OrenNayar oren_nayar,
}

/// Layers over a glTF material, or by themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LayeredPieces {
    layers: u32,
    base: Option<PrincipledPieces>,
}

impl BsdfList {
    /// How many functions it tells apart.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use kaustik_spectrum::Spectrum;

    use super::*;
    use crate::{Interface, LayerParameters, PrincipledParameters};

    fn grey(value: f32) -> Spectrum {
        Spectrum::new([value, value * 0.8, value * 0.6, value * 0.9])
    }

    fn lacquer(colour: f32) -> PrincipledParameters {
        PrincipledParameters {
            base_color: grey(colour),
            metallic: 0.0,
            roughness: 0.3,
            ..PrincipledParameters::default()
        }
    }

    /// One of each kind, and of both of those that are stored in pieces more than one.
    fn kinds(colour: f32) -> Vec<Bsdf> {
        let interface = Interface::new(Spectrum::splat(1.5), grey(colour), Spectrum::ONE);
        let glass = PrincipledParameters {
            transmission: 0.5,
            ..lacquer(colour)
        };
        let leaf = PrincipledParameters {
            diffuse_transmission: 0.4,
            diffuse_transmission_color: grey(0.5 * colour),
            ..lacquer(colour)
        };
        let layers = LayerParameters {
            clearcoat: 0.7,
            sheen_color: grey(0.2),
            ..LayerParameters::default()
        };
        let layered = Bsdf::layered(&lacquer(colour), &layers);
        let mut kinds = vec![
            Bsdf::lambertian(grey(colour)),
            Bsdf::mirror(grey(colour)),
            Bsdf::metal(grey(colour), Spectrum::ONE, 0.0, true),
            Bsdf::metal(grey(colour), Spectrum::ONE, 0.4, true),
            Bsdf::dielectric(interface, 0.0, true),
            Bsdf::dielectric(interface, 0.3, true),
            Bsdf::thin_dielectric(interface, 0.0, true),
            Bsdf::thin_dielectric(interface, 0.3, true),
            Bsdf::coated(grey(colour), 1.5),
            Bsdf::phong(grey(colour), grey(0.1), 20.0),
            Bsdf::oren_nayar(grey(colour), 0.5),
            Bsdf::principled(&lacquer(colour)),
            Bsdf::principled(&glass),
            Bsdf::principled(&leaf),
            layered,
        ];
        // Varnish without what is below, as a camera walk may take it.
        kinds.extend(layered.parts(0.9).narrow);
        kinds
    }

    fn numbers(list: &mut BsdfList, kinds: &[Bsdf]) -> Vec<u32> {
        kinds.iter().map(|bsdf| list.number(bsdf)).collect()
    }

    #[test]
    fn what_went_in_comes_out() {
        let kinds: Vec<Bsdf> = [0.7, 0.3].into_iter().flat_map(kinds).collect();
        let variants = kinds.iter().map(std::mem::discriminant);
        let variants: std::collections::HashSet<_> = variants.collect();
        assert_eq!(variants.len(), 13, "a kind is not tried");
        let mut list = BsdfList::default();
        let first = numbers(&mut list, &kinds);
        let mut all = list.clone();
        let added = all.append(&list);
        for (number, kind) in first.iter().zip(&kinds) {
            assert_eq!(list.get(*number), *kind);
            assert_eq!(all.get(*number), *kind);
            assert_eq!(all.get(added + number), *kind);
        }
        assert_eq!(all.len(), 2 * list.len());
        assert_eq!(all.bytes(), 2 * list.bytes());
        all.clear();
        assert!(all.is_empty() && all.bytes() == 0);
    }

    #[test]
    fn two_functions_by_turns_are_two() {
        let mut list = BsdfList::default();
        let kinds = [
            Bsdf::principled(&lacquer(0.2)),
            Bsdf::oren_nayar(grey(0.2), 0.4),
        ];
        for _ in 0..100 {
            assert_eq!(numbers(&mut list, &kinds), [0, 1]);
        }
        assert_eq!(list.len(), 2);
    }

    /// A colour of its own at each point.
    #[test]
    fn a_texture_takes_little() {
        let mut list = BsdfList::default();
        for at in 0..1_000 {
            let bsdf = Bsdf::principled(&lacquer(0.1 + 0.0005 * at as f32));
            assert_eq!(list.number(&bsdf), at);
            assert_eq!(list.get(at), bsdf);
        }
        // 512 bytes of it would be as many of `Principled`.
        assert!(list.bytes() < 1_000 * 29, "{}", list.bytes());
    }

    /// So does one by which light comes through.
    #[test]
    fn a_textured_leaf_takes_little() {
        let mut list = BsdfList::default();
        for at in 0..1_000 {
            let colour = 0.1 + 0.0005 * at as f32;
            let bsdf = Bsdf::principled(&PrincipledParameters {
                diffuse_transmission: 0.4,
                diffuse_transmission_color: grey(colour),
                ..lacquer(colour)
            });
            assert_eq!(list.number(&bsdf), at);
            assert_eq!(list.get(at), bsdf);
        }
        assert!(list.bytes() < 1_000 * 66, "{}", list.bytes());
    }
}
