//! `EXT_meshopt_compression`: buffer views that are stored compressed.

use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{BufferView, Filter, Mode};

use super::budget::{Budget, size};
use super::json::Cursor;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

pub(super) const NAME: &str = "EXT_meshopt_compression";

/// Bytes that a compressed byte can stand for: a group of 16 elements takes at least two bits for
/// each byte of an element, a triangle a byte. Who claims more lies, and is refused before memory
/// is set aside.
const MOST_PER_BYTE: u64 = 64;

/// Is this a buffer that only readers without the extension need?
pub(super) fn is_fallback(buffer: &Cursor<'_>) -> Result<bool> {
    match buffer.extension(NAME)? {
        Some(place) => place.flag("fallback"),
        None => Ok(false),
    }
}

/// The bytes of a view from its compressed form, which stands at `place`.
pub(super) fn decode<'a>(
    view: &Cursor<'a>,
    place: &Cursor<'a>,
    source: &[u8],
    budget: &mut Budget,
) -> Result<Vec<u8>> {
    let layout = layout(place)?;
    let length = view.need("byteLength")?.usize()?;
    let stride = view.get("byteStride")?.map(|s| s.usize()).transpose()?;
    if layout.validate_parent(length, stride).is_err() {
        let found = format!("a buffer view of {length} bytes with byteStride {stride:?}");
        let expected = format!(
            "{} bytes and the stride of the compressed data",
            layout.byte_length()
        );
        return Err(view.error(ErrorKind::Value, found, expected));
    }
    let most = MOST_PER_BYTE * (source.len() as u64 + 64);
    if layout.byte_length() as u64 > most {
        let found = format!(
            "{} in {} bytes",
            size(layout.byte_length() as u64),
            source.len()
        );
        let expected = format!("at most {}, as much as they can hold", size(most));
        return Err(place.error(ErrorKind::Compressed, found, expected));
    }
    budget.take(&place.pointer(), layout.byte_length() as u64)?;
    let mut bytes = vec![0; layout.byte_length()];
    let mut workspace = Workspace::default();
    layout
        .decode_into(&mut bytes, source, &mut workspace)
        .map_err(|e| {
            let found = format!("compressed data that does not decode ({e})");
            place.error(
                ErrorKind::Compressed,
                found,
                "a stream of meshoptimizer's codec",
            )
        })?;
    Ok(bytes)
}

fn layout(place: &Cursor<'_>) -> Result<BufferView> {
    let mode = place.need("mode")?;
    let known = Mode::parse(mode.string()?);
    let known = known.map_err(|_| mode.mismatch("ATTRIBUTES, TRIANGLES or INDICES"))?;
    let filter = match place.get("filter")? {
        None => Filter::None,
        Some(filter) => Filter::parse(filter.string()?)
            .map_err(|_| filter.mismatch("NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL"))?,
    };
    let count = place.need("count")?.usize()?;
    let stride = place.need("byteStride")?.usize()?;
    BufferView::new(known, filter, count, stride).map_err(|e| {
        let found =
            format!("{count} elements of {stride} bytes, {known:?}, filter {filter:?} ({e})");
        let expected = "a count, stride and filter that EXT_meshopt_compression permits";
        place.error(ErrorKind::Value, found, expected)
    })
}
