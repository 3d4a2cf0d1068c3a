//! Parts of a picture that are measured by themselves.

use kaustik::film::{Image, Window};

/// Pixels of a reference, by what they show.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    /// The darkest and the brightest quarter of the lit pixels.
    quarters: [Vec<usize>; 2],
    close_ups: Vec<Window>,
}

impl Parts {
    pub(crate) fn of(reference: &Image, close_ups: &[Window]) -> Self {
        Self {
            quarters: quarters(reference),
            close_ups: close_ups.to_vec(),
        }
    }

    /// Root of the mean square of a value a pixel, over each quarter.
    pub(crate) fn root_mean_squares(&self, values: &[f32]) -> [f64; 2] {
        [&self.quarters[0], &self.quarters[1]].map(|pixels| {
            let squares = pixels.iter().map(|&pixel| f64::from(values[pixel]).powi(2));
            (squares.sum::<f64>() / pixels.len().max(1) as f64).sqrt()
        })
    }

    /// Mean linear red, green, blue of each close-up, or of the whole picture if there is none.
    pub(crate) fn colours(&self, image: &Image) -> Vec<[f64; 3]> {
        let mean = |image: &Image| image.rgb().map(mean_of);
        let crop = |window: &Window| image.cropped(*window).ok().map(|part| mean(&part));
        match self.close_ups[..] {
            [] => vec![mean(image)],
            _ => self.close_ups.iter().filter_map(crop).collect(),
        }
    }
}

fn mean_of(plane: &[f32]) -> f64 {
    plane.iter().map(|&v| f64::from(v)).sum::<f64>() / plane.len().max(1) as f64
}

/// Luminance of each pixel, from planes of linear Rec.709.
pub(crate) fn luminances(planes: [&[f32]; 3]) -> Vec<f64> {
    let weighted = |v: f32, weight: f64| weight * f64::from(v);
    let luminance = |((r, g), b): ((&f32, &f32), &f32)| {
        weighted(*r, 0.2126) + weighted(*g, 0.7152) + weighted(*b, 0.0722)
    };
    planes[0]
        .iter()
        .zip(planes[1])
        .zip(planes[2])
        .map(luminance)
        .collect()
}

/// Pixels in the darkest and in the brightest quarter, black ones left out.
pub(crate) fn quarters(image: &Image) -> [Vec<usize>; 2] {
    let y = luminances(image.rgb());
    let mut lit: Vec<usize> = (0..y.len()).filter(|&i| y[i] > 0.0).collect();
    lit.sort_by(|&a, &b| y[a].total_cmp(&y[b]));
    let quarter = lit.len().div_ceil(4);
    [lit[..quarter].to_vec(), lit[lit.len() - quarter..].to_vec()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four pixels a row, brighter to the right, the last row black; blue is twice as bright as red and green.
    fn image() -> Image {
        let plane = |factor: f32| -> Vec<f32> {
            let value = |pixel: usize| {
                if pixel < 12 {
                    (1 + pixel % 4) as f32
                } else {
                    0.0
                }
            };
            (0..16).map(|pixel| factor * value(pixel)).collect()
        };
        Image::from_rgb(4, 4, [plane(1.0), plane(1.0), plane(2.0)]).expect("an image")
    }

    #[test]
    fn quarters_are_of_lit_pixels() {
        let [dark, bright] = quarters(&image());
        assert_eq!((dark, bright), (vec![0, 4, 8], vec![3, 7, 11]));
        let parts = Parts::of(&image(), &[]);
        let mut values = vec![0.0; 16];
        (values[4], values[3], values[12]) = (3.0, -1.0, 100.0);
        let [dark, bright] = parts.root_mean_squares(&values);
        assert!(
            (dark - 3.0_f64.sqrt()).abs() < 1e-6 && (bright - (1.0_f64 / 3.0).sqrt()).abs() < 1e-6
        );
    }

    #[test]
    fn colours_are_of_close_ups() {
        let window = |x0, y0, x1, y1| Window { x0, y0, x1, y1 };
        let parts = Parts::of(&image(), &[window(1, 0, 3, 2), window(0, 2, 1, 4)]);
        assert_eq!(parts.colours(&image()), [[2.5, 2.5, 5.0], [0.5, 0.5, 1.0]]);
        let whole = Parts::of(&image(), &[]).colours(&image());
        assert_eq!(whole, [[1.875, 1.875, 3.75]]);
    }
}
