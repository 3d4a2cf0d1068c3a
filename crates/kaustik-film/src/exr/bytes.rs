//! A cursor over a file's bytes: every read is checked, none allocates more than there is.

use crate::read::DecodeError;

/// What is left of the file, and how far we are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a> {
    rest: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, at: 0 }
    }

    /// Offset of the next byte in the file, for messages.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    /// The next `count` bytes.
    pub(super) fn take(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<&'a [u8], DecodeError> {
        if count > self.rest.len() {
            return Err(DecodeError::Truncated {
                what,
                at: self.at,
                wanted: count,
                left: self.rest.len(),
            });
        }
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], DecodeError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    pub(super) fn u8(&mut self, what: &'static str) -> Result<u8, DecodeError> {
        Ok(self.array::<1>(what)?[0])
    }

    pub(super) fn u32(&mut self, what: &'static str) -> Result<u32, DecodeError> {
        Ok(u32::from_le_bytes(self.array(what)?))
    }

    pub(super) fn i32(&mut self, what: &'static str) -> Result<i32, DecodeError> {
        Ok(i32::from_le_bytes(self.array(what)?))
    }

    pub(super) fn u64(&mut self, what: &'static str) -> Result<u64, DecodeError> {
        Ok(u64::from_le_bytes(self.array(what)?))
    }

    /// An i32 that must not be negative.
    pub(super) fn size(&mut self, what: &'static str) -> Result<usize, DecodeError> {
        let at = self.at;
        let size = self.i32(what)?;
        usize::try_from(size).map_err(|_| {
            DecodeError::malformed(what, at, format!("it is {size}, expected 0 or more"))
        })
    }

    /// Text up to a zero byte; at most 255 bytes of printable ASCII. Empty ends a list.
    pub(super) fn name(&mut self, what: &'static str) -> Result<&'a str, DecodeError> {
        let at = self.at;
        let length = self.rest.iter().take(256).position(|&b| b == 0);
        let Some(length) = length else {
            return Err(DecodeError::malformed(
                what,
                at,
                "expected at most 255 characters and a zero".into(),
            ));
        };
        let text = self.take(length, what)?;
        self.take(1, what)?;
        match std::str::from_utf8(text) {
            Ok(text) if text.bytes().all(|b| (0x20..0x7f).contains(&b)) => Ok(text),
            _ => Err(DecodeError::malformed(
                what,
                at,
                "expected printable ASCII".into(),
            )),
        }
    }
}
