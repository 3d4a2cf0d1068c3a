//! What pictures are compared with: one picture, or two independent halves.

use crate::Image;

/// One reference, or two halves A and B of equal cost whose noise is independent.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    a: &'a Image,
    b: Option<&'a Image>,
}

impl<'a> Reference<'a> {
    /// A reference that is taken to be exact.
    #[must_use]
    pub fn exact(image: &'a Image) -> Self {
        Self { a: image, b: None }
    }

    /// Two halves; `None` if they differ in size or place.
    #[must_use]
    pub fn halves(a: &'a Image, b: &'a Image) -> Option<Self> {
        let place = |image: &Image| (image.width(), image.height(), image.origin());
        (place(a) == place(b)).then_some(Self { a, b: Some(b) })
    }

    /// The first picture: its size is the reference's.
    #[must_use]
    pub fn image(&self) -> &'a Image {
        self.a
    }

    /// The second half, if there is one.
    #[must_use]
    pub fn half(&self) -> Option<&'a Image> {
        self.b
    }

    /// A and B of a pixel; twice the same for an exact reference.
    pub(super) fn pair(&self, pixel: usize) -> [[f64; 3]; 2] {
        let a = self.a.pixel(pixel);
        [a, self.b.map_or(a, |b| b.pixel(pixel))]
    }

    /// r of a pixel: the mean of the halves.
    pub(super) fn mean(&self, pixel: usize) -> [f64; 3] {
        let [a, b] = self.pair(pixel);
        std::array::from_fn(|c| 0.5 * (a[c] + b[c]))
    }
}
