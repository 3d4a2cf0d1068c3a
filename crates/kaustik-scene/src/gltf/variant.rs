//! `KHR_materials_variants`: one of several materials for a primitive, chosen by name.

use super::json::{Cursor, shorten};
use super::reader::Reader;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

const NAME: &str = "KHR_materials_variants";

/// The variants of a file, and which of them is shown.
#[derive(Debug, Default)]
pub(super) struct Variants {
    pub(super) names: Vec<String>,
    chosen: Option<usize>,
}

impl Variants {
    /// Reads the names and finds the one that the options ask for.
    pub(super) fn load(reader: &Reader<'_>) -> Result<Self> {
        let mut names = Vec::new();
        if let Some(place) = reader.root.extension(NAME)? {
            for variant in place.list("variants")? {
                names.push(variant.need("name")?.string()?.to_owned());
            }
        }
        let chosen = match &reader.options.variant {
            None => None,
            Some(wanted) => Some(find(&reader.root, &names, wanted)?),
        };
        Ok(Self { names, chosen })
    }

    /// The material of a primitive in the chosen variant; without one, or where the
    /// primitive has none for it, its own.
    pub(super) fn material(
        &self,
        root: &Cursor<'_>,
        primitive: &Cursor<'_>,
    ) -> Result<Option<usize>> {
        let materials = root.count("materials")?;
        let own = match primitive.get("material")? {
            Some(material) => Some(material.index("/materials", materials)?),
            None => None,
        };
        let Some(place) = primitive.extension(NAME)? else {
            return Ok(own);
        };
        let into = format!("/extensions/{NAME}/variants");
        let mut mapped = None;
        for mapping in place.need("mappings")?.items()? {
            let material = mapping.need("material")?.index("/materials", materials)?;
            for variant in mapping.need("variants")?.items()? {
                let variant = variant.index(&into, self.names.len())?;
                if self.chosen == Some(variant) && mapped.is_none() {
                    mapped = Some(material);
                }
            }
        }
        Ok(mapped.or(own))
    }
}

fn find(root: &Cursor<'_>, names: &[String], wanted: &str) -> Result<usize> {
    if let Some(at) = names.iter().position(|name| name == wanted) {
        return Ok(at);
    }
    let found = format!("no material variant \"{}\"", shorten(wanted));
    let expected = if names.is_empty() {
        "no choice of a variant, as the file has none".to_owned()
    } else {
        let known: Vec<String> = names.iter().take(50).map(|name| shorten(name)).collect();
        format!("one of {}", known.join(", "))
    };
    let error = match root.extension(NAME)? {
        Some(place) if !names.is_empty() => {
            place
                .need("variants")?
                .error(ErrorKind::Variant, found, expected)
        }
        _ => root.error(ErrorKind::Variant, found, expected),
    };
    Err(error)
}
