use super::image::{Fate, Images};
use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};
use crate::description::{Filtering, TextureDescription, TextureSlot, UvTransform, Wrap};

type Result<T> = std::result::Result<T, LoadError>;

/// The file's textures that can be read.
#[derive(Debug, Default)]
pub(super) struct Textures {
    pub(super) list: Vec<TextureDescription>,
    /// For each texture of the file its index in `list`; `None` if it has no readable image.
    index: Vec<Option<usize>>,
}

impl Textures {
    pub(super) fn load(reader: &mut Reader<'_>, images: &Images) -> Result<Self> {
        let mut textures = Self::default();
        for place in reader.root.list("textures")? {
            let webp = match place.extension("EXT_texture_webp")? {
                Some(webp) => webp.get("source")?,
                None => None,
            };
            let plain = place.get("source")?;
            let Some(source) = webp.or(plain) else {
                let message = "no image in a format that is read; the texture is left out";
                reader.warnings.push(place.pointer(), message);
                textures.index.push(None);
                continue;
            };
            let image = match images.index[source.index("/images", images.index.len())?] {
                Fate::Read(image) => image,
                Fate::Idle => {
                    textures.index.push(None);
                    continue;
                }
                Fate::Strange => {
                    let found = "an image that is neither PNG, JPEG nor WebP";
                    return Err(source.error(ErrorKind::Image, found, "PNG, JPEG or WebP"));
                }
            };
            let texture = sampled(&reader.root, &place, image)?;
            textures.index.push(Some(textures.list.len()));
            textures.list.push(texture);
        }
        Ok(textures)
    }

    /// The texture that the texture info at `place` refers to. `None` with a warning if its
    /// image is not read or it uses texture coordinates past the second set.
    pub(super) fn slot(
        &self,
        reader: &mut Reader<'_>,
        place: &Cursor<'_>,
    ) -> Result<Option<TextureSlot>> {
        let texture = place.need("index")?.index("/textures", self.index.len())?;
        let mut uv_set = place.usize_or("texCoord", 0)?;
        let mut transform = UvTransform::IDENTITY;
        if let Some(map) = place.extension("KHR_texture_transform")? {
            uv_set = map.usize_or("texCoord", uv_set)?;
            transform = UvTransform {
                offset: map.floats_or("offset", [0.0; 2])?,
                rotation: map.f32_or("rotation", 0.0)?,
                scale: map.floats_or("scale", [1.0; 2])?,
            };
        }
        let Some(texture) = self.index[texture] else {
            reader.warnings.push(
                place.pointer(),
                "its image is not read; the texture is left out",
            );
            return Ok(None);
        };
        if uv_set > 1 {
            let message =
                format!("TEXCOORD_{uv_set} is not read (only 0 and 1); the texture is left out");
            reader.warnings.push(place.pointer(), message);
            return Ok(None);
        }
        Ok(Some(TextureSlot {
            texture,
            uv_set: uv_set as u8,
            transform,
        }))
    }
}

/// A texture of the image with the sampler that `place` names.
fn sampled<'a>(root: &Cursor<'a>, place: &Cursor<'a>, image: usize) -> Result<TextureDescription> {
    let mut texture = TextureDescription {
        image,
        wrap_s: Wrap::Repeat,
        wrap_t: Wrap::Repeat,
        filtering: Filtering::Linear,
    };
    let Some(sampler) = place.get("sampler")? else {
        return Ok(texture);
    };
    let sampler = sampler.target(root, "samplers")?;
    texture.wrap_s = wrap(&sampler, "wrapS")?;
    texture.wrap_t = wrap(&sampler, "wrapT")?;
    if let Some(filter) = sampler.get("magFilter")? {
        texture.filtering = match filter.usize()? {
            9728 => Filtering::Nearest,
            9729 => Filtering::Linear,
            _ => return Err(filter.mismatch("9728 (nearest) or 9729 (linear)")),
        };
    }
    Ok(texture)
}

fn wrap<'a>(sampler: &Cursor<'a>, key: &'a str) -> Result<Wrap> {
    let Some(wrap) = sampler.get(key)? else {
        return Ok(Wrap::Repeat);
    };
    match wrap.usize()? {
        10497 => Ok(Wrap::Repeat),
        33071 => Ok(Wrap::Clamp),
        33648 => Ok(Wrap::Mirror),
        _ => Err(wrap.mismatch("10497 (repeat), 33071 (clamp) or 33648 (mirror)")),
    }
}
