//! A developed picture: planes of `f32`, named, in layers.
//!
//! Planes rather than pixels: layers differ in their channels, EXR files store planes, and a metric reads
//! one plane at a time.

use crate::Window;

/// A picture of linear values: the main layer (R, G, B in linear Rec.709) and any further layers, all of
/// one size.
///
/// The pixels may be a crop of a larger image: [`Image::origin`] says where they lie in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    origin: [i32; 2],
    full: [u32; 2],
    layers: Vec<Layer>,
    metadata: Option<serde_json::Value>,
}

/// Named channels; the main layer's name is empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Empty for the main layer; otherwise unique in the image.
    pub name: String,
    /// At least one; names are unique within the layer.
    pub channels: Vec<Channel>,
}

/// One plane of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Such as `R`; not empty, no dots.
    pub name: String,
    /// Row by row from the top, width x height of them.
    pub samples: Vec<f32>,
}

/// An image that does not hold together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// Zero or too many columns or rows.
    #[error("an image of {width} x {height} pixels: expected 1 to {max} each way")]
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Most of either.
        max: u32,
    },
    /// A channel of another size.
    #[error("channel '{channel}' holds {found} samples: expected {expected}")]
    Samples {
        /// The channel's name.
        channel: String,
        /// Samples given.
        found: usize,
        /// Width times height.
        expected: usize,
    },
    /// A picture of another size, or of another part of the whole.
    #[error("a picture of {found}: expected {expected}")]
    Shape {
        /// Its size and place.
        found: String,
        /// Those wanted.
        expected: String,
    },
    /// A name that is empty, taken, too long, or not plain text.
    #[error(
        "layer '{layer}', channel '{channel}': expected unique names of 1 to 255 printable ASCII characters, channels without dots"
    )]
    Name {
        /// The layer's name.
        layer: String,
        /// The channel's name.
        channel: String,
    },
    /// A window that does not lie in the image.
    #[error(
        "window {window} does not lie in the image: expected a part of {width} x {height} pixels at {x},{y}"
    )]
    Window {
        /// The window asked for.
        window: Window,
        /// Columns of this image.
        width: u32,
        /// Rows of this image.
        height: u32,
        /// This image's first column in the full image.
        x: i32,
        /// This image's first row in the full image.
        y: i32,
    },
}

impl Layer {
    /// A layer of named planes.
    #[must_use]
    pub fn new(name: &str, channels: Vec<(&str, Vec<f32>)>) -> Self {
        let channels = channels.into_iter().map(|(name, samples)| Channel {
            name: name.to_owned(),
            samples,
        });
        Self {
            name: name.to_owned(),
            channels: channels.collect(),
        }
    }

    /// The samples of a channel by name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.samples.as_slice())
    }
}

impl Image {
    /// Most columns or rows.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// An image with these R, G, B planes as its main layer.
    ///
    /// # Errors
    /// If a side is 0 or above [`Image::MAX_SIDE`], or a plane does not hold width x height samples.
    pub fn from_rgb(width: u32, height: u32, [r, g, b]: [Vec<f32>; 3]) -> Result<Self, ImageError> {
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(ImageError::Size {
                width,
                height,
                max: Self::MAX_SIDE,
            });
        }
        let (origin, full) = ([0, 0], [width, height]);
        let mut image = Self {
            width,
            height,
            origin,
            full,
            layers: Vec::new(),
            metadata: None,
        };
        image.push_layer(Layer::new("", vec![("R", r), ("G", g), ("B", b)]))?;
        Ok(image)
    }

    /// The same pixels, lying at `origin` (column, row) in a full image of this width and height.
    #[must_use]
    pub fn placed(mut self, origin: [i32; 2], full: [u32; 2]) -> Self {
        self.origin = origin;
        self.full = full;
        self
    }

    /// The same with this description, which an EXR file carries as its one attribute `kaustik`.
    #[must_use]
    pub fn with_metadata(mut self, metadata: serde_json::Value) -> Self {
        self.metadata = Some(metadata);
        self
    }

    /// Adds a layer behind the others.
    ///
    /// # Errors
    /// If a channel has another size, or a name is empty, taken, longer than 255 characters, not
    /// printable ASCII, or (a channel's) has a dot.
    pub fn push_layer(&mut self, layer: Layer) -> Result<(), ImageError> {
        let main = self.layers.is_empty();
        let wrong = !plain(&layer.name, usize::from(!main)) || self.layer(&layer.name).is_some();
        if wrong || layer.channels.is_empty() {
            let channel = String::new();
            return Err(ImageError::Name {
                layer: layer.name,
                channel,
            });
        }
        self.push_channels(layer)
    }

    /// Adds channels to the layer of this name, which is made if it is not there; all or none.
    pub(crate) fn push_channels(&mut self, layer: Layer) -> Result<(), ImageError> {
        let index = self
            .layers
            .iter()
            .position(|other| other.name == layer.name);
        let old = index.map_or(&[][..], |index| &self.layers[index].channels);
        for (i, channel) in layer.channels.iter().enumerate() {
            let name = channel.name.clone();
            let (found, expected) = (channel.samples.len(), self.pixels());
            if found != expected {
                return Err(ImageError::Samples {
                    channel: name,
                    found,
                    expected,
                });
            }
            let mut others = old.iter().chain(&layer.channels[..i]);
            let wrong = !plain(&name, 1) || name.contains('.') || !plain(&layer.name, 0);
            if wrong || others.any(|other| other.name == name) {
                return Err(ImageError::Name {
                    layer: layer.name,
                    channel: name,
                });
            }
        }
        match index {
            Some(index) => self.layers[index].channels.extend(layer.channels),
            None => self.layers.push(layer),
        }
        Ok(())
    }

    /// Columns, >= 1.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows, >= 1.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Width times height.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Column and row of the first pixel in the full image.
    #[must_use]
    pub fn origin(&self) -> [i32; 2] {
        self.origin
    }

    /// Width and height of the full image that these pixels are a part of.
    #[must_use]
    pub fn full_size(&self) -> [u32; 2] {
        self.full
    }

    /// Its size and place, in words: what two pictures must share for their pixels to lie on each other.
    pub(crate) fn shape(&self) -> String {
        let ([x, y], [width, height]) = (self.origin, self.full);
        format!(
            "{} x {} pixels at {x},{y} of {width} x {height}",
            self.width, self.height
        )
    }

    /// All layers, the main one first.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// A layer by name; the main layer's is empty.
    #[must_use]
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// What an EXR file's attribute `kaustik` holds.
    #[must_use]
    pub fn metadata(&self) -> Option<&serde_json::Value> {
        self.metadata.as_ref()
    }

    /// The main layer's R, G and B planes.
    #[must_use]
    pub fn rgb(&self) -> [&[f32]; 3] {
        let channels = &self.layers[0].channels;
        [
            &channels[0].samples,
            &channels[1].samples,
            &channels[2].samples,
        ]
    }

    /// The picture alone, with its metadata and without the other layers.
    #[must_use]
    pub fn without_layers(mut self) -> Self {
        self.layers.truncate(1);
        self
    }

    /// The main layer's R, G and B planes alone.
    #[must_use]
    pub fn into_rgb(self) -> [Vec<f32>; 3] {
        let layers = self.layers.into_iter().take(1);
        let mut channels = layers.flat_map(|main| main.channels);
        [(); 3].map(|()| channels.next().map_or(Vec::new(), |c| c.samples))
    }

    /// The main layer's R, G, B of a pixel by its index, row by row from the top.
    pub(crate) fn pixel(&self, index: usize) -> [f64; 3] {
        self.rgb().map(|plane| f64::from(plane[index]))
    }

    /// Multiplies the main layer's pixels by a factor for each index, row by row from the top.
    pub fn scale_pixels(&mut self, factor: impl Fn(usize) -> f32) {
        for channel in self.layers[0].channels.iter_mut().take(3) {
            for (index, sample) in channel.samples.iter_mut().enumerate() {
                *sample *= factor(index);
            }
        }
    }

    /// Adds R, G, B to the main layer's pixels, row by row from the top; pixels for which there are none stay.
    pub fn add_pixels(&mut self, pixels: impl Iterator<Item = [f32; 3]>) {
        if let [r, g, b, ..] = &mut self.layers[0].channels[..] {
            let planes = (r.samples.iter_mut())
                .zip(&mut g.samples)
                .zip(&mut b.samples);
            for (((r, g), b), [more_r, more_g, more_b]) in planes.zip(pixels) {
                *r += more_r;
                *g += more_g;
                *b += more_b;
            }
        }
    }

    /// Adds the main layer of another image, pixel by pixel.
    ///
    /// # Errors
    /// If it has not as many pixels.
    pub fn add(&mut self, other: &Self) -> Result<(), ImageError> {
        for (channel, plane) in self.layers[0].channels.iter_mut().zip(other.rgb()) {
            if channel.samples.len() != plane.len() {
                return Err(ImageError::Samples {
                    channel: channel.name.clone(),
                    found: plane.len(),
                    expected: channel.samples.len(),
                });
            }
            for (sample, more) in channel.samples.iter_mut().zip(plane) {
                *sample += more;
            }
        }
        Ok(())
    }

    /// A copy of the main layer's pixels in a window given in coordinates of the full image.
    ///
    /// # Errors
    /// If the window is empty or not all of it lies in this image.
    pub fn cropped(&self, window: Window) -> Result<Self, ImageError> {
        let [x, y] = self.origin;
        let error = ImageError::Window {
            window,
            width: self.width,
            height: self.height,
            x,
            y,
        };
        let left = i64::from(window.x0) - i64::from(x);
        let top = i64::from(window.y0) - i64::from(y);
        let fits = left >= 0
            && top >= 0
            && left + i64::from(window.width()) <= i64::from(self.width)
            && top + i64::from(window.height()) <= i64::from(self.height);
        if window.area() == 0 || !fits {
            return Err(error);
        }
        let (left, top) = (left as usize, top as usize);
        let (width, stride) = (window.width() as usize, self.width as usize);
        let planes = self.rgb().map(|plane| {
            let rows = plane
                .chunks_exact(stride)
                .skip(top)
                .take(window.height() as usize);
            rows.flat_map(|row| &row[left..left + width])
                .copied()
                .collect()
        });
        let origin = [x.saturating_add(left as i32), y.saturating_add(top as i32)];
        Ok(Self::from_rgb(window.width(), window.height(), planes)?.placed(origin, self.full))
    }
}

/// Whether a name can stand in a file: printable ASCII, `min` to 255 characters.
fn plain(name: &str, min: usize) -> bool {
    (min..=255).contains(&name.len()) && name.bytes().all(|b| (0x20..0x7f).contains(&b))
}
