//! Several pictures of one scene, averaged.

use crate::{Image, ImageError, Layer};

/// The weighted mean of images of one size, and how far they lie apart (West, Comm. ACM 22, 1979).
///
/// Images are to be pushed in a fixed order where bits matter. The layers of the first image are averaged;
/// one that another image lacks is left out.
#[derive(Clone, Debug)]
pub struct Average {
    first: Image,
    parts: u32,
    /// Sum of the weights.
    weight: f64,
    /// Linear Rec.709, weighted means.
    mean: [Vec<f64>; 3],
    /// Weighted sums of squared deviations from the mean.
    squares: [Vec<f64>; 3],
    /// For each layer but the main one, each channel: weighted sums; `None` where an image lacks it.
    layers: Vec<Option<Vec<Vec<f64>>>>,
}

impl Average {
    /// Of one image, for now. Weights are positive: how many samples are behind it.
    #[must_use]
    pub fn of(image: &Image, weight: f64) -> Self {
        let sums = |layer: &Layer| {
            let channels = layer.channels.iter();
            let sums = channels.map(|channel| weighted(&channel.samples, weight).collect());
            Some(sums.collect())
        };
        Self {
            first: image.clone(),
            parts: 1,
            weight,
            mean: image.rgb().map(|plane| weighted(plane, 1.0).collect()),
            squares: [(); 3].map(|()| vec![0.0; image.pixels()]),
            layers: image.layers()[1..].iter().map(sums).collect(),
        }
    }

    /// Takes another image.
    ///
    /// # Errors
    /// If it has another size, or shows another part of the whole.
    pub fn push(&mut self, image: &Image, weight: f64) -> Result<(), ImageError> {
        if image.shape() != self.first.shape() {
            return Err(ImageError::Shape {
                found: image.shape(),
                expected: self.first.shape(),
            });
        }
        self.parts += 1;
        self.weight += weight;
        let share = weight / self.weight;
        for ((means, squares), plane) in
            (self.mean.iter_mut().zip(&mut self.squares)).zip(image.rgb())
        {
            for ((mean, square), &sample) in means.iter_mut().zip(squares).zip(plane) {
                let sample = f64::from(sample);
                let delta = sample - *mean;
                *mean += share * delta;
                *square += weight * delta * (sample - *mean);
            }
        }
        for (sums, layer) in self.layers.iter_mut().zip(&self.first.layers()[1..]) {
            let other = image.layer(&layer.name);
            let alike = |other: &&Layer| {
                let names = |layer: &Layer| layer.channels.iter().map(|c| c.name.clone()).collect();
                let (a, b): (Vec<_>, Vec<_>) = (names(other), names(layer));
                a == b
            };
            let (Some(sums), Some(other)) = (&mut *sums, other.filter(alike)) else {
                *sums = None;
                continue;
            };
            for (sums, channel) in sums.iter_mut().zip(&other.channels) {
                let more = weighted(&channel.samples, weight);
                sums.iter_mut()
                    .zip(more)
                    .for_each(|(sum, more)| *sum += more);
            }
        }
        Ok(())
    }

    /// The mean, with the layers that all have.
    ///
    /// # Errors
    /// None that the images had not.
    pub fn image(&self) -> Result<Image, ImageError> {
        let planes = (self.mean.each_ref()).map(|plane| plane.iter().map(|&v| v as f32).collect());
        let (width, height) = (self.first.width(), self.first.height());
        let image = Image::from_rgb(width, height, planes)?;
        let mut image = image.placed(self.first.origin(), self.first.full_size());
        for (sums, layer) in self.layers.iter().zip(&self.first.layers()[1..]) {
            let Some(sums) = sums else { continue };
            let channels = layer.channels.iter().zip(sums).map(|(channel, sums)| {
                let means = sums.iter().map(|sum| (sum / self.weight) as f32);
                (channel.name.as_str(), means.collect())
            });
            image.push_layer(Layer::new(&layer.name, channels.collect()))?;
        }
        Ok(image)
    }

    /// Standard error of each channel of each pixel of the mean, as a layer: `sqrt(sum w (x - mean)^2 / (W (k
    /// - 1)))` for k images of weights w that sum to W. This is right if the variance of an image is inverse
    /// to its weight; it has k - 1 degrees of freedom. `None` for one image.
    #[must_use]
    pub fn error(&self, name: &str) -> Option<Layer> {
        let freedom = f64::from(self.parts - 1);
        let error = |square: &f64| (square / (self.weight * freedom)).sqrt() as f32;
        let planes = self
            .squares
            .iter()
            .map(|plane| plane.iter().map(error).collect());
        let channels = ["R", "G", "B"].into_iter().zip(planes);
        (self.parts > 1).then(|| Layer::new(name, channels.collect()))
    }
}

fn weighted(plane: &[f32], weight: f64) -> impl Iterator<Item = f64> {
    plane.iter().map(move |&v| f64::from(v) * weight)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(r: [f32; 2], layer: Option<f32>) -> Image {
        let planes = [r.to_vec(), vec![0.5; 2], vec![r[0] * 2.0; 2]];
        let mut image = Image::from_rgb(2, 1, planes).expect("an image");
        if let Some(v) = layer {
            let layer = Layer::new("part", vec![("Y", vec![v; 2])]);
            image.push_layer(layer).expect("a layer");
        }
        image
    }

    #[test]
    fn other_shapes_are_refused() {
        let wide = image([1.0, 2.0], None);
        let planes = || [(); 3].map(|()| vec![1.0; 2]);
        let high = Image::from_rgb(1, 2, planes()).expect("an image");
        let elsewhere = image([1.0, 2.0], None).placed([2, 0], [4, 1]);
        let here = image([1.0, 2.0], None).placed([0, 0], [4, 1]);
        for other in [&high, &elsewhere] {
            assert!(Average::of(&wide, 1.0).push(other, 1.0).is_err());
        }
        assert!(Average::of(&here, 1.0).push(&elsewhere, 1.0).is_err());
        assert!(Average::of(&here, 1.0).push(&here, 1.0).is_ok());
    }

    #[test]
    fn means_and_errors_are_those_of_weighted_numbers() {
        let parts = [([1.0, 7.0], 1.0), ([2.0, 7.0], 2.0), ([5.0, 7.0], 5.0)];
        let mut average = Average::of(&image(parts[0].0, Some(3.0)), parts[0].1);
        assert!(average.error("error").is_none());
        for (r, weight) in &parts[1..] {
            average
                .push(&image(*r, Some(3.0)), *weight)
                .expect("one size");
        }
        let mean = average.image().expect("an image");
        assert_eq!(mean.rgb(), [&[3.75, 7.0][..], &[0.5, 0.5], &[7.5, 7.5]]);
        let part = mean.layer("part").and_then(|part| part.channel("Y"));
        assert_eq!(part, Some(&[3.0, 3.0][..]));
        let error = average.error("error").expect("three parts");
        // (1 x 2.75^2 + 2 x 1.75^2 + 5 x 1.25^2) / (8 x 2)
        let wanted = (21.5_f64 / 16.0).sqrt() as f32;
        let red = error.channel("R").expect("red");
        assert!((red[0] - wanted).abs() < 1e-6 && red[1] <= 0.0, "{red:?}");
        let blue = error.channel("B").expect("blue");
        assert!((blue[1] - 2.0 * wanted).abs() < 1e-6, "{blue:?}");
        // what one lacks is left out; another size is refused
        average.push(&image([0.0; 2], None), 1.0).expect("one size");
        assert!(average.image().expect("an image").layer("part").is_none());
        let other = Image::from_rgb(1, 1, [vec![1.0], vec![1.0], vec![1.0]]).expect("an image");
        assert!(average.push(&other, 1.0).is_err());
    }

    /// Over many draws the error squared is the variance of the mean, also for unequal weights.
    #[test]
    fn errors_are_right_in_the_mean() {
        let mut state = 1_u64;
        let mut normal = || {
            // the sum of twelve uniform numbers
            let mut sum = -6.0;
            for _ in 0..12 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                sum += (state >> 40) as f64 / f64::from(1 << 24);
            }
            sum
        };
        let weights = [1.0, 2.0, 4.0];
        let (mut seen, mut told) = (0.0, 0.0);
        let rounds = 4_000;
        for _ in 0..rounds {
            let mut part = |weight: f64| image([(normal() / weight.sqrt()) as f32; 2], None);
            let mut average = Average::of(&part(weights[0]), weights[0]);
            for weight in &weights[1..] {
                average.push(&part(*weight), *weight).expect("one size");
            }
            seen += f64::from(average.image().expect("an image").rgb()[0][0]).powi(2);
            let error = average.error("error").expect("three parts");
            told += f64::from(error.channel("R").expect("red")[0]).powi(2);
        }
        let ratio = told / seen;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
}
