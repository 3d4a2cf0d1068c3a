//! `EXT_lights_image_based`: a cube map around the scene, resampled to the picture that an
//! environment is.
//!
//! The six faces of the first mip are read; what is blurred beforehand for other renderers (the further
//! mips, the irradiance coefficients) is what paths find by themselves. Faces are taken as seen from
//! inside the cube with glTF's right-handed axes: that is the standard orientation of cube maps "flipped
//! about its vertical axis", as the extension has it. The result has shared exponents, as a Radiance
//! file, so that it can be exported with the same bits.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;
use image::codecs::hdr::HdrEncoder;

use super::environment::rotation;
use super::image::Images;
use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};
use crate::description::{EnvironmentDescription, ImageData, Pixels};
use crate::environment::{MAX_HDR_PIXELS, decode_hdr};
use crate::texture::{SRGB, SRGB_16, share};

type Result<T> = std::result::Result<T, LoadError>;

const NAME: &str = "EXT_lights_image_based";

/// The light that the scene refers to.
pub(super) fn load<'a>(
    reader: &mut Reader<'a>,
    scene: &Cursor<'a>,
    images: &Images,
) -> Result<Option<EnvironmentDescription>> {
    let Some(reference) = scene.extension(NAME)? else {
        return Ok(None);
    };
    let place = reference.need("light")?;
    let extension = reader.root.extension(NAME)?;
    let lights = match &extension {
        Some(extension) => extension.list("lights")?,
        None => Vec::new(),
    };
    let into = format!("/extensions/{NAME}/lights");
    let light = &lights[place.index(&into, lights.len())?];
    let cube = Cube::read(light, images)?;
    let image = cube.equirectangular(reader, light)?;
    Ok(Some(EnvironmentDescription::Image {
        image: Arc::new(image),
        strength: reader.number(light, "intensity", 1.0, (0.0, f32::INFINITY))?,
        rotation: rotation(light)?,
    }))
}

/// Six square faces: +x, -x, +y, -y, +z, -z.
struct Cube {
    faces: [Arc<ImageData>; 6],
    side: usize,
}

impl Cube {
    fn read(light: &Cursor<'_>, images: &Images) -> Result<Self> {
        let mips = light.need("specularImages")?;
        let first = mips.items()?.next();
        let first = first.ok_or_else(|| mips.mismatch("at least one mip of six images"))?;
        let mut faces = Vec::new();
        for face in first.items()? {
            let index = images.index[face.index("/images", images.index.len())?].pixels();
            let index = index.ok_or_else(|| {
                let found = "an image that is neither PNG, JPEG nor WebP";
                face.error(ErrorKind::Image, found, "PNG or JPEG")
            })?;
            faces.push((face, Arc::clone(&images.list[index])));
        }
        let side = faces.first().map_or(0, |(_, image)| image.width);
        for (face, image) in &faces {
            if image.width != side || image.height != side {
                let found = format!("an image of {} x {}", image.width, image.height);
                let expected = format!("squares of one size ({side} x {side}, as the first)");
                return Err(face.error(ErrorKind::Image, found, expected));
            }
        }
        let faces: Vec<Arc<ImageData>> = faces.into_iter().map(|(_, image)| image).collect();
        let count = faces.len();
        let faces: [Arc<ImageData>; 6] = faces.try_into().map_err(|_| {
            let found = format!("{count} images");
            first.error(ErrorKind::Value, found, "six, the faces of a cube")
        })?;
        Ok(Self {
            faces,
            side: side as usize,
        })
    }

    /// The picture: as many columns as four faces have, half as many rows.
    fn equirectangular(&self, reader: &mut Reader<'_>, light: &Cursor<'_>) -> Result<ImageData> {
        let (width, height) = (4 * self.side, 2 * self.side);
        let pixels = (width * height) as u64;
        if pixels > MAX_HDR_PIXELS {
            let found = format!("a cube map of {0} x {0}", self.side);
            let expected = format!("one that makes a picture of at most {MAX_HDR_PIXELS} pixels");
            return Err(light.error(ErrorKind::Budget, found, expected));
        }
        // the floats twice, and the file that is kept for export
        reader
            .budget
            .take(&light.pointer(), pixels * (12 + 12 + 8))?;
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let values: Vec<image::Rgb<f32>> = rows
            .map(|(x, y)| image::Rgb(self.mean(x, y, [width, height])))
            .collect();
        let bad = |e: &dyn std::fmt::Display| {
            light.error(
                ErrorKind::Image,
                e.to_string(),
                "a cube map of finite radiance",
            )
        };
        let mut encoded = Vec::new();
        HdrEncoder::new(&mut encoded)
            .encode(&values, width, height)
            .map_err(|e| bad(&e))?;
        let name = light.text("name")?;
        let mut image = decode_hdr(name, &encoded).map_err(|e| bad(&e))?.image;
        image.encoded = encoded;
        reader.budget.give(pixels * 12);
        Ok(image)
    }

    /// Mean radiance of a pixel of the picture, from four points of it.
    fn mean(&self, x: usize, y: usize, [width, height]: [usize; 2]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
            let phi = TAU * ((x as f64 + dx) / width as f64 - 0.5);
            let theta = PI * (y as f64 + dy) / height as f64;
            let (sin, cos) = (libm::sin(theta), libm::cos(theta));
            // the middle column looks along -z, +x lies to the right of it
            let direction = DVec3::new(sin * libm::sin(phi), cos, -sin * libm::cos(phi));
            for (sum, value) in sum.iter_mut().zip(self.radiance(direction)) {
                *sum += 0.25 * value;
            }
        }
        sum
    }

    /// Bilinear within the face that the direction meets.
    fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let (face, [s, t]) = face(direction);
        let most = self.side - 1;
        let at = |s: f64| (s * self.side as f64 - 0.5).clamp(0.0, most as f64);
        let (x, y) = (at(s), at(t));
        let (i, j) = (x as usize, y as usize);
        let (fx, fy) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let texel = |i: usize, j: usize| self.texel(face, i.min(most), j.min(most));
        let line = |j: usize| {
            let (a, b) = (texel(i, j), texel(i + 1, j));
            std::array::from_fn::<f32, 3, _>(|c| a[c] + (b[c] - a[c]) * fx)
        };
        let (a, b) = (line(j), line(j + 1));
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * fy)
    }

    /// A colour coded as sRGB over its alpha (RGBD); alpha is 1 where an image has none.
    fn texel(&self, face: usize, x: usize, y: usize) -> [f32; 3] {
        let at = 4 * (y * self.side + x);
        let (colour, divisor) = match &self.faces[face].pixels {
            Pixels::Rgba8(pixels) => {
                let Some(&[r, g, b, a]) = pixels.get(at..at + 4) else {
                    return [0.0; 3];
                };
                (
                    [r, g, b].map(|c| SRGB[usize::from(c)]),
                    f32::from(a) / 255.0,
                )
            }
            Pixels::Rgba16(pixels) => {
                let Some(&[r, g, b, a]) = pixels.get(at..at + 4) else {
                    return [0.0; 3];
                };
                ([r, g, b].map(|c| SRGB_16[usize::from(c)]), share(a))
            }
            Pixels::RgbF32(_) => return [0.0; 3],
        };
        // the least that eight bits can say: 16 divide by no less
        colour.map(|c| c / divisor.max(1.0 / 255.0))
    }
}

/// Which face a direction meets, and where: from the left and from the top, in [0, 1].
fn face(d: DVec3) -> (usize, [f64; 2]) {
    let a = d.abs();
    let (face, s, t, major) = if a.x >= a.y && a.x >= a.z {
        if d.x > 0.0 {
            (0, d.z, -d.y, a.x)
        } else {
            (1, -d.z, -d.y, a.x)
        }
    } else if a.y >= a.z {
        if d.y > 0.0 {
            (2, -d.x, d.z, a.y)
        } else {
            (3, -d.x, -d.z, a.y)
        }
    } else if d.z > 0.0 {
        (4, -d.x, -d.y, a.z)
    } else {
        (5, d.x, -d.y, a.z)
    };
    (face, [s, t].map(|c| 0.5 + 0.5 * c / major))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walking across an edge of the cube, the texel beside it is on the neighbour's edge: the six
    /// faces fit together as seen from inside, none of them mirrored.
    #[test]
    fn faces_are_seen_from_inside() {
        let axes = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::Z,
            DVec3::NEG_Z,
        ];
        for (i, axis) in axes.into_iter().enumerate() {
            let (found, [s, t]) = face(axis);
            assert_eq!(found, i);
            assert!((s - 0.5).abs() < 1e-12 && (t - 0.5).abs() < 1e-12);
            // the picture's right times its down is its depth, in a right-handed frame
            let step = 1e-3;
            let mut derivative = [DVec3::ZERO; 2];
            for across in axes {
                let (_, [s1, t1]) = face(axis + across * step);
                derivative[0] += across * (s1 - 0.5);
                derivative[1] += across * (t1 - 0.5);
            }
            let [right, down] = derivative.map(|d| d.normalize());
            assert!(right.cross(down).dot(axis) > 0.99, "face {i} is mirrored");
        }
        // sideways the picture stands upright
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
            assert!(face(side + DVec3::Y * 0.5).1[1] < 0.3);
        }
    }
}
