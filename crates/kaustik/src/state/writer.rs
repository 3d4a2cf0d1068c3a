use std::io::{self, Write};

use blake3::Hasher;
use kaustik_film::Film;
use serde::Serialize;

use super::packed::pack;
use super::{BYTE_ORDER, FILM, MAGIC, NUMBERS, VALUE, VERSION};

/// Writes the sections of a state, and their checksum at the end.
pub(crate) struct Writer<'a> {
    out: &'a mut dyn Write,
    checksum: Hasher,
}

impl<'a> Writer<'a> {
    /// Writes what every state file begins with.
    pub(super) fn new(out: &'a mut dyn Write) -> io::Result<Self> {
        let checksum = Hasher::new();
        let mut writer = Self { out, checksum };
        writer.raw(&MAGIC)?;
        writer.raw(&VERSION.to_le_bytes())?;
        writer.raw(&BYTE_ORDER.to_le_bytes())?;
        Ok(writer)
    }

    fn raw(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.out.write_all(bytes)
    }

    fn section(&mut self, kind: u8, length: usize) -> io::Result<()> {
        self.raw(&[kind])?;
        self.raw(&(length as u64).to_le_bytes())
    }

    /// A value of any type.
    pub(crate) fn value<T: Serialize + ?Sized>(&mut self, value: &T) -> io::Result<()> {
        let bytes = postcard::to_allocvec(value).map_err(io::Error::other)?;
        self.section(VALUE, bytes.len())?;
        self.raw(&bytes)
    }

    /// A film: its quantum, what it left out, its sums.
    pub(crate) fn film(&mut self, film: &Film) -> io::Result<()> {
        self.value(&(film.quantum(), film.counters()))?;
        let sums = film.sums();
        self.section(FILM, sums.len())?;
        pack(sums, |bytes| self.raw(bytes))
    }

    /// Many numbers.
    pub(crate) fn numbers<'n>(
        &mut self,
        numbers: impl ExactSizeIterator<Item = &'n f64>,
    ) -> io::Result<()> {
        self.section(NUMBERS, numbers.len())?;
        const MOST: usize = 1 << 16;
        let mut bytes = Vec::with_capacity(MOST);
        for number in numbers {
            bytes.extend(number.to_le_bytes());
            if bytes.len() == MOST {
                self.raw(&bytes)?;
                bytes.clear();
            }
        }
        self.raw(&bytes)
    }

    pub(super) fn finish(self) -> io::Result<()> {
        let checksum = self.checksum.finalize();
        self.out.write_all(checksum.as_bytes())
    }
}
