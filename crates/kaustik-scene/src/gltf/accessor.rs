//! Typed, checked reading of accessors: strides, all component types, sparse overlays.

use super::budget::Budget;
use super::buffer::{Buffers, View};
use super::json::Cursor;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

/// How a component is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn read(place: &Cursor<'_>) -> Result<Self> {
        Ok(match place.usize()? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(place.mismatch("5120 to 5123, 5125 or 5126")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value at the start of `bytes`; normalised integers map to [0, 1] or [-1, 1]
    /// (glTF 2.0, 3.6.2.2).
    fn value(self, bytes: &[u8], normalized: bool) -> f32 {
        let (value, most) = match self {
            Self::I8 => (f32::from(i8::from_le_bytes([bytes[0]])), 127.0),
            Self::U8 => (f32::from(bytes[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => return self.whole(bytes) as f32,
            Self::F32 => return f32::from_bits(self.whole(bytes)),
        };
        if normalized {
            return (value / most).max(-1.0);
        }
        value
    }

    /// The unsigned integer (or the bits) at the start of `bytes`.
    fn whole(self, bytes: &[u8]) -> u32 {
        match self.size() {
            1 => u32::from(bytes[0]),
            2 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// What an attribute may be stored as.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    /// Beyond floats.
    pub(super) components: &'static [Component],
    /// Integers may come without `normalized`.
    pub(super) plain_integers: bool,
    /// For the message.
    pub(super) words: &'static str,
}

impl Allowed {
    fn holds(&self, component: Component, normalized: bool) -> bool {
        component == Component::F32
            || (self.components.contains(&component) && (normalized || self.plain_integers))
    }
}

/// An accessor whose header and byte ranges have been checked.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    place: Cursor<'a>,
    component: Component,
    normalized: bool,
    width: usize,
    count: usize,
}

impl<'a> Accessor<'a> {
    /// The accessor whose index stands at `place`.
    pub(super) fn find(root: &Cursor<'a>, place: &Cursor<'a>) -> Result<Self> {
        let accessor = place.target(root, "accessors")?;
        let kind = accessor.need("type")?;
        let width = match kind.string()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => return Err(kind.mismatch("SCALAR, VEC2, VEC3, VEC4 or MAT4")),
        };
        Ok(Self {
            component: Component::read(&accessor.need("componentType")?)?,
            normalized: accessor.flag("normalized")?,
            width,
            count: accessor.need("count")?.usize()?,
            place: accessor,
        })
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn wrong_type(&self, expected: &str) -> LoadError {
        let normalized = if self.normalized { ", normalized" } else { "" };
        let found = format!("{:?} x {}{normalized}", self.component, self.width);
        self.place.error(ErrorKind::Value, found, expected)
    }

    /// `count` vectors of `N` floats.
    pub(super) fn floats<const N: usize>(
        &self,
        allowed: &Allowed,
        buffers: &Buffers<'a>,
        budget: &mut Budget,
    ) -> Result<Vec<[f32; N]>> {
        if self.width != N || !allowed.holds(self.component, self.normalized) {
            return Err(self.wrong_type(allowed.words));
        }
        let (component, normalized) = (self.component, self.normalized);
        let size = component.size();
        self.collect([0.0; N], buffers, budget, |element| {
            std::array::from_fn(|i| component.value(&element[i * size..], normalized))
        })
    }

    /// `count` unsigned integers.
    pub(super) fn indices(&self, buffers: &Buffers<'a>, budget: &mut Budget) -> Result<Vec<u32>> {
        let component = self.component;
        let unsigned = matches!(component, Component::U8 | Component::U16 | Component::U32);
        if self.width != 1 || !unsigned {
            return Err(self.wrong_type("unsigned integers, one each"));
        }
        self.collect(0, buffers, budget, |element| component.whole(element))
    }

    /// `count` times four unsigned integers, as they are.
    pub(super) fn quads(
        &self,
        buffers: &Buffers<'a>,
        budget: &mut Budget,
    ) -> Result<Vec<[u16; 4]>> {
        let component = self.component;
        let unsigned = matches!(component, Component::U8 | Component::U16);
        if self.width != 4 || !unsigned || self.normalized {
            return Err(self.wrong_type("VEC4 of UNSIGNED_BYTE or _SHORT, not normalized"));
        }
        let size = component.size();
        self.collect([0; 4], buffers, budget, |element| {
            std::array::from_fn(|i| component.whole(&element[i * size..]) as u16)
        })
    }

    /// Reads all elements: those of the buffer view (or `zero` without one), then the sparse
    /// ones over them.
    fn collect<T: Copy>(
        &self,
        zero: T,
        buffers: &Buffers<'a>,
        budget: &mut Budget,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        let base = match self.place.get("bufferView")? {
            Some(view) => Some(self.elements(&self.place, buffers.view(&view)?, self.count)?),
            None => None,
        };
        let sparse = match self.place.get("sparse")? {
            Some(place) => self.sparse(&place, buffers, budget)?,
            None => Vec::new(),
        };
        let pairs = size_of_val(&sparse[..]) as u64;
        budget.take_many(&self.place.pointer(), self.count, size_of::<T>())?;
        let mut values = match base {
            Some(elements) => elements.map(&read).collect(),
            None => vec![zero; self.count],
        };
        for (index, element) in sparse {
            values[index] = read(element);
        }
        budget.give(pairs);
        Ok(values)
    }

    /// The elements of a view, from the `byteOffset` at `place` on.
    fn elements<'b>(
        &self,
        place: &Cursor<'_>,
        view: View<'b>,
        count: usize,
    ) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>> {
        let size = self.component.size() * self.width;
        slices(place, view, count, size)
    }

    /// Pairs of an index below `count` and the bytes of its element. The budget holds them until they are given back.
    fn sparse<'b>(
        &self,
        place: &Cursor<'a>,
        buffers: &'b Buffers<'a>,
        budget: &mut Budget,
    ) -> Result<Vec<(usize, &'b [u8])>> {
        let count = place.need("count")?;
        let many = count.usize()?;
        if many > self.count {
            let expected = format!("at most the accessor's count of {}", self.count);
            return Err(count.error(ErrorKind::Value, many.to_string(), expected));
        }
        let place_of_indices = place.need("indices")?;
        let component = Component::read(&place_of_indices.need("componentType")?)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(place_of_indices.mismatch("indices of an unsigned integer type"));
        }
        let view = buffers.view(&place_of_indices.need("bufferView")?)?;
        let indices = slices(&place_of_indices, view, many, component.size())?;
        let place_of_values = place.need("values")?;
        let view = buffers.view(&place_of_values.need("bufferView")?)?;
        let values = self.elements(&place_of_values, view, many)?;
        budget.take_many(&place.pointer(), many, size_of::<(usize, &[u8])>())?;
        let mut pairs = Vec::with_capacity(many);
        for (index, value) in indices.zip(values) {
            let index = component.whole(index) as usize;
            if index >= self.count {
                let expected = format!("indices below the accessor's count of {}", self.count);
                let found = index.to_string();
                return Err(place_of_indices.error(ErrorKind::Reference, found, expected));
            }
            pairs.push((index, value));
        }
        Ok(pairs)
    }
}

/// `count` slices of `size` bytes, `byteOffset` (at `place`) into the view, a stride apart.
fn slices<'b>(
    place: &Cursor<'_>,
    view: View<'b>,
    count: usize,
    size: usize,
) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>> {
    let offset = place.usize_or("byteOffset", 0)?;
    let stride = view.stride.unwrap_or(size);
    if stride < size {
        let found = format!("a buffer view with byteStride {stride}");
        let expected = format!("at least the {size} bytes of an element");
        return Err(place.error(ErrorKind::Reference, found, expected));
    }
    let last = count.saturating_sub(1).checked_mul(stride);
    let length = last.and_then(|l| l.checked_add(if count == 0 { 0 } else { size }));
    let end = length.and_then(|l| l.checked_add(offset));
    let Some(end) = end.filter(|&end| end <= view.bytes.len()) else {
        let found =
            format!("{count} elements of {size} bytes from byte {offset} on, {stride} apart");
        let expected = format!(
            "a range within the {} bytes of the buffer view",
            view.bytes.len()
        );
        return Err(place.error(ErrorKind::Reference, found, expected));
    };
    let bytes = if count == 0 {
        &[]
    } else {
        &view.bytes[offset..end]
    };
    // all chunks are whole, and the last one is `size` long
    Ok(bytes.chunks(stride).map(move |chunk| &chunk[..size]))
}
