//! What a method tells beside its picture, as pictures of a page.

use kaustik::film::{Image, Layer, Tone};

use crate::StudyError;
use crate::chart::number;
use crate::picture::{address, layer, log_map, region_map};

/// A picture for the page.
#[derive(Debug, PartialEq, serde::Serialize)]
pub(crate) struct Part {
    /// What is said under it.
    pub(crate) name: String,
    /// Its bytes as an address.
    pub(crate) picture: String,
    /// Is it in false colours, by the logarithm?
    pub(crate) is_logarithmic: bool,
}

/// Layers that tell of the scene and not of the method.
const FEATURES: [&str; 3] = ["albedo", "normal", "depth"];

/// G figure 3: the target, then its two factors. Each goes by its own largest value, as in the paper.
const TARGET: [(&str, &str); 3] = [
    ("full", "target"),
    ("density", "factor: inverse photon density"),
    ("kernel", "factor: inverse kernel size"),
];

/// The layers that a method adds to its picture, in the file's order.
pub(crate) fn parts(image: &Image, tone: &Tone) -> Result<Vec<Part>, StudyError> {
    let mut parts = Vec::new();
    for part in image.layers().iter().skip(1) {
        match part.name.as_str() {
            name if FEATURES.contains(&name) => {}
            "target" => parts.extend(target(image, part)?),
            "contributions" => {
                parts.extend(logarithmic(image, part, "Y", "contributions a point")?);
            }
            name => {
                if let Some(picture) = layer(image, part) {
                    parts.push(Part {
                        name: name.to_owned(),
                        picture: address(&picture, tone)?,
                        is_logarithmic: false,
                    });
                }
            }
        }
    }
    Ok(parts)
}

/// The target with its factors, and the regions of the cut.
fn target(image: &Image, part: &Layer) -> Result<Vec<Part>, StudyError> {
    let mut parts = Vec::new();
    for (channel, name) in TARGET {
        parts.extend(logarithmic(image, part, channel, name)?);
    }
    let (Some(regions), Some(kernel)) = (part.channel("region"), part.channel("kernel")) else {
        return Ok(parts);
    };
    // where no point is, there is no region
    let regions: Vec<Option<u32>> = (regions.iter().zip(kernel))
        .map(|(region, kernel)| (*kernel > 0.0).then_some(*region as u32))
        .collect();
    let mut seen: Vec<u32> = regions.iter().flatten().copied().collect();
    seen.sort_unstable();
    seen.dedup();
    parts.push(Part {
        name: format!("regions: {} are seen", seen.len()),
        picture: region_map(image.width(), image.height(), &regions)?,
        is_logarithmic: false,
    });
    Ok(parts)
}

/// A channel in false colours with its largest value; `None` if the layer has no such channel.
fn logarithmic(
    image: &Image,
    part: &Layer,
    channel: &str,
    name: &str,
) -> Result<Option<Part>, StudyError> {
    let Some(values) = part.channel(channel) else {
        return Ok(None);
    };
    let largest = values.iter().copied().fold(0.0, f32::max);
    Ok(Some(Part {
        name: format!("{name}, at most {}", number(f64::from(largest))),
        picture: log_map(image.width(), image.height(), values, largest)?,
        is_logarithmic: true,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::tests::decoded;

    /// Four pixels: three points, of which the first and the third are in one region, and none.
    fn image() -> Image {
        let grey = || vec![0.5; 4];
        let mut image = Image::from_rgb(2, 2, [grey(), grey(), grey()]).unwrap();
        let layers = [
            ("albedo", vec![("R", grey()), ("G", grey()), ("B", grey())]),
            (
                "target",
                vec![
                    ("full", vec![0.5, 5e-3, 1e-6, 0.0]),
                    ("kernel", vec![1.0, 1.0, 0.1, 0.0]),
                    ("density", vec![0.5, 5e-3, 1e-5, 0.0]),
                    ("region", vec![3.0, 4.0, 3.0, 0.0]),
                ],
            ),
            ("contributions", vec![("Y", vec![2.0, 200.0, 0.02, 0.0])]),
            ("part", vec![("R", grey()), ("G", grey()), ("B", grey())]),
        ];
        for (name, channels) in layers {
            image.push_layer(Layer::new(name, channels)).unwrap();
        }
        image
    }

    fn pixels(part: &Part) -> Vec<[f32; 3]> {
        let image = decoded(&part.picture);
        let [r, g, b] = image.rgb();
        (0..4).map(|i| [r[i], g[i], b[i]]).collect()
    }

    #[test]
    fn the_target_its_factors_and_its_regions_are_shown() {
        let parts = parts(&image(), &Tone::default()).unwrap();
        let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
        let wanted = [
            "target, at most 0.5",
            "factor: inverse photon density, at most 0.5",
            "factor: inverse kernel size, at most 1",
            "regions: 2 are seen",
            "contributions a point, at most 200",
            "part",
        ];
        assert_eq!(names, wanted);
        let logarithmic: Vec<bool> = parts.iter().map(|part| part.is_logarithmic).collect();
        assert_eq!(logarithmic, [true, true, true, false, true, false]);
    }

    #[test]
    fn false_colours_go_by_the_logarithm() {
        let parts = parts(&image(), &Tone::default()).unwrap();
        let [white, black] = [[1.0; 3], [0.0; 3]];
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        let target = pixels(&parts[0]);
        // the largest; a hundredth of it, half way; less than a ten-thousandth; none
        assert!(near(target[0], white) && near(target[2], black) && near(target[3], black));
        let contributions = pixels(&parts[4]);
        assert!(near(contributions[1], white) && near(contributions[2], black));
        assert!(
            near(contributions[0], target[1]),
            "a hundredth of the largest"
        );
        assert!(!near(target[1], white) && !near(target[1], black));
    }

    #[test]
    fn regions_are_told_apart() {
        let regions = pixels(&parts(&image(), &Tone::default()).unwrap()[3]);
        let bits = |at: usize| regions[at].map(f32::to_bits);
        assert_eq!(bits(0), bits(2), "one region");
        let far = |a: usize, b: usize| (0..3).any(|c| (regions[a][c] - regions[b][c]).abs() > 0.2);
        assert!(far(0, 1) && far(0, 3) && far(1, 3), "{regions:?}");
        assert_eq!(bits(3), [0; 3], "no point");
    }
}
