//! Images that nothing reads.

use std::collections::HashSet;

use super::LoadError;
use super::json::Cursor;

type Result<T> = std::result::Result<T, LoadError>;

/// The images that the textures of ambient occlusion alone name: light finds its way here by itself, so that they are not
/// read, be they large, broken or missing.
pub(super) fn images(root: &Cursor<'_>) -> Result<HashSet<usize>> {
    let (mut occluding, mut seen) = (HashSet::new(), HashSet::new());
    for material in root.list("materials")? {
        if let Some(texture) = material.get("occlusionTexture")? {
            occluding.extend(texture.get("index")?.and_then(|index| index.usize().ok()));
        }
        textures(&material, &mut seen)?;
    }
    let (mut idle, mut read) = (HashSet::new(), HashSet::new());
    for (index, texture) in root.list("textures")?.into_iter().enumerate() {
        let webp = texture.extension("EXT_texture_webp")?;
        let sources = [Some(texture), webp];
        let set = match occluding.contains(&index) && !seen.contains(&index) {
            true => &mut idle,
            false => &mut read,
        };
        for source in sources.into_iter().flatten() {
            set.extend(source.get("source")?.and_then(|image| image.usize().ok()));
        }
    }
    if idle.is_empty() {
        return Ok(idle);
    }
    faces(root, &mut read)?;
    idle.retain(|image| !read.contains(image));
    Ok(idle)
}

/// Adds the textures that a material names, in whatever extension, but for that of its occlusion.
fn textures(material: &Cursor<'_>, seen: &mut HashSet<usize>) -> Result<()> {
    let mut open = vec![material.clone()];
    while let Some(place) = open.pop() {
        for key in place
            .object()?
            .keys()
            .filter(|key| *key != "occlusionTexture")
        {
            let Some(value) = place.get(key)?.filter(Cursor::is_object) else {
                continue;
            };
            if key.ends_with("Texture") {
                seen.extend(value.get("index")?.and_then(|index| index.usize().ok()));
            }
            open.push(value);
        }
    }
    Ok(())
}

/// Adds the faces of all image-based lights.
fn faces(root: &Cursor<'_>, read: &mut HashSet<usize>) -> Result<()> {
    let Some(lights) = root.extension("EXT_lights_image_based")? else {
        return Ok(());
    };
    for light in lights.list("lights")? {
        for mip in light.list("specularImages")? {
            for face in mip.items()? {
                read.extend(face.usize().ok());
            }
        }
    }
    Ok(())
}
