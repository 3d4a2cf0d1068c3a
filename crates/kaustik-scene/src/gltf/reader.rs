use super::LoadError;
use super::LoadOptions;
use super::budget::Budget;
use super::buffer::Buffers;
use super::folder::Folder;
use super::json::Cursor;
use super::warning::Warnings;

/// What every part of the loader needs: the document, its bytes, and the running accounts.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    pub(super) root: Cursor<'a>,
    pub(super) buffers: Buffers<'a>,
    pub(super) folder: Folder,
    pub(super) budget: Budget,
    pub(super) warnings: Warnings,
    pub(super) options: LoadOptions,
    /// May vertices be integers (`KHR_mesh_quantization`)?
    pub(super) quantized: bool,
}

impl Reader<'_> {
    /// Warns about something at a place.
    pub(super) fn warn(&mut self, place: &Cursor<'_>, message: impl Into<String>) {
        self.warnings.push(place.pointer(), message);
    }

    /// The number `key` within [least, most], brought there with a warning if need be.
    pub(super) fn number<'b>(
        &mut self,
        place: &Cursor<'b>,
        key: &'b str,
        default: f32,
        (least, most): (f32, f32),
    ) -> Result<f32, LoadError> {
        match place.get(key)? {
            Some(number) => {
                let value = number.f32()?;
                Ok(self.within(&number, value, (least, most)))
            }
            None => Ok(default),
        }
    }

    /// The numbers `key`, each within [least, most], brought there with a warning if need be.
    pub(super) fn numbers<'b, const N: usize>(
        &mut self,
        place: &Cursor<'b>,
        key: &'b str,
        default: [f32; N],
        range: (f32, f32),
    ) -> Result<[f32; N], LoadError> {
        match place.get(key)? {
            Some(numbers) => {
                let values = numbers.floats::<N>()?;
                Ok(values.map(|value| self.within(&numbers, value, range)))
            }
            None => Ok(default),
        }
    }

    fn within(&mut self, place: &Cursor<'_>, value: f32, (least, most): (f32, f32)) -> f32 {
        let inside = value.max(least).min(most);
        if value < least || value > most {
            let range = match most {
                f32::INFINITY => format!("at least {least}"),
                _ => format!("{least} to {most}"),
            };
            self.warn(
                place,
                format!("{value} is outside of {range}; {inside} is used"),
            );
        }
        inside
    }
}
