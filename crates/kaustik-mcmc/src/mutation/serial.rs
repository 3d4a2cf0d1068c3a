//! Mutations written down as their sizes (feature `serde`): all else follows from these.

use serde::de::{Deserialize, Deserializer};
use serde::ser::{Serialize, Serializer};

use super::{Exponential, Power, Uniform, WrappedCauchy, WrappedNormal};
use crate::serial::{check, finite};

const ERROR: &str = "a mutation of a size that does not exist";

macro_rules! written_as_a_size {
    ($($mutation:ident $size:ident,)*) => {$(
        impl Serialize for $mutation {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                self.$size().serialize(serializer)
            }
        }

        impl<'de> Deserialize<'de> for $mutation {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let size = finite(deserializer)?;
                let mutation = Self::new(size);
                check(mutation.$size().to_bits() == size.to_bits(), ERROR)?;
                Ok(mutation)
            }
        }
    )*};
}

written_as_a_size! {
    Uniform fraction,
    WrappedNormal sigma,
    WrappedCauchy scale,
    Power size,
}

impl Serialize for Exponential {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.sizes().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Exponential {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (s1, s2) = <(f64, f64)>::deserialize(deserializer)?;
        check(s1.is_finite() && s2.is_finite(), ERROR)?;
        let mutation = Self::new(s1, s2);
        check(mutation.sizes() == (s1, s2), ERROR)?;
        Ok(mutation)
    }
}
