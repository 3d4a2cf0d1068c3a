use std::collections::HashMap;
use std::sync::Arc;

use super::budget::Budget;
use super::compressed;
use super::folder::Folder;
use super::json::Cursor;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

#[derive(Debug)]
enum Data<'a> {
    /// The binary chunk of the GLB.
    Chunk(&'a [u8]),
    /// A file or a data uri.
    Fetched(Arc<Vec<u8>>),
    /// A buffer without data, as some extensions have; an error once it is used.
    Absent,
}

#[derive(Debug)]
struct Buffer<'a> {
    data: Data<'a>,
    length: usize,
}

/// The file's buffers with their bytes, and checked ways into them.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    root: Cursor<'a>,
    buffers: Vec<Buffer<'a>>,
    /// Compressed views by their index, decoded.
    decoded: HashMap<usize, Vec<u8>>,
}

/// A checked range of bytes with the stride that its buffer view gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: Option<usize>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(
        root: &Cursor<'a>,
        binary: Option<&'a [u8]>,
        folder: &mut Folder,
        budget: &mut Budget,
    ) -> Result<Self> {
        let mut buffers = Vec::new();
        for (i, place) in root.list("buffers")?.iter().enumerate() {
            let chunk = binary.filter(|_| i == 0);
            buffers.push(Buffer::load(place, chunk, folder, budget)?);
        }
        let mut loaded = Self {
            root: root.clone(),
            buffers,
            decoded: HashMap::new(),
        };
        for (i, view) in root.list("bufferViews")?.iter().enumerate() {
            if let Some(place) = view.extension(compressed::NAME)? {
                let bytes = compressed::decode(view, &place, loaded.range(&place)?, budget)?;
                loaded.decoded.insert(i, bytes);
            }
        }
        Ok(loaded)
    }

    /// The bytes of the buffer view whose index stands at `place`.
    pub(super) fn view(&self, place: &Cursor<'a>) -> Result<View<'_>> {
        let view = place.target(&self.root, "bufferViews")?;
        let stride = view.get("byteStride")?.map(|s| s.usize()).transpose()?;
        if let Some(bytes) = self.decoded.get(&place.usize()?) {
            return Ok(View { bytes, stride });
        }
        let bytes = self.range(&view)?;
        Ok(View { bytes, stride })
    }

    /// The bytes that `buffer`, `byteOffset` and `byteLength` of this object name.
    fn range(&self, view: &Cursor<'a>) -> Result<&[u8]> {
        let place = view.need("buffer")?;
        let index = place.index("/buffers", self.buffers.len())?;
        let bytes = self.buffers[index].bytes(&place)?;
        let offset = view.usize_or("byteOffset", 0)?;
        let length = view.need("byteLength")?.usize()?;
        let range = offset
            .checked_add(length)
            .and_then(|end| bytes.get(offset..end));
        range.ok_or_else(|| {
            let found = format!("byteOffset {offset}, byteLength {length}");
            let expected = format!("a range within the {} bytes of the buffer", bytes.len());
            view.error(ErrorKind::Reference, found, expected)
        })
    }
}

impl<'a> Buffer<'a> {
    fn load(
        place: &Cursor<'a>,
        chunk: Option<&'a [u8]>,
        folder: &mut Folder,
        budget: &mut Budget,
    ) -> Result<Self> {
        let length = place.need("byteLength")?.usize()?;
        let data = match (place.get("uri")?, chunk) {
            _ if compressed::is_fallback(place)? => Data::Absent,
            (Some(uri), _) => Data::Fetched(folder.fetch(&uri, budget)?),
            (None, Some(chunk)) => Data::Chunk(chunk),
            (None, None) => Data::Absent,
        };
        let buffer = Self { data, length };
        let has = buffer.raw().map_or(length, <[u8]>::len);
        if has < length {
            let found = format!("{has} bytes of data");
            let expected = format!("byteLength = {length} bytes");
            return Err(place
                .error(ErrorKind::Reference, found, expected)
                .help("the file or its buffer may be incomplete"));
        }
        Ok(buffer)
    }

    fn raw(&self) -> Option<&[u8]> {
        match &self.data {
            Data::Chunk(bytes) => Some(bytes),
            Data::Fetched(bytes) => Some(bytes),
            Data::Absent => None,
        }
    }

    fn bytes(&self, place: &Cursor<'_>) -> Result<&[u8]> {
        let bytes = self.raw().and_then(|bytes| bytes.get(..self.length));
        bytes.ok_or_else(|| {
            let found = "a buffer with neither a uri nor a binary chunk";
            place.error(ErrorKind::Reference, found, "a buffer with data")
        })
    }
}
