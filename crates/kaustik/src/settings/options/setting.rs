//! A setting as text: how what was written is read, and what was set is written.

use std::ops::RangeInclusive;
use std::str::FromStr;

/// A place that holds a setting, with the words for it.
pub(crate) trait Setting {
    /// Sets it to what a text says.
    ///
    /// # Errors
    /// If that is out of range, with the reason if there is more to say; then nothing changes.
    fn read(&mut self, text: &str) -> Result<(), Refusal>;
    /// What [`read`](Self::read) would have to be told for it to be as it is.
    fn written(&self) -> String;
}

/// Why a text is no value, if the range alone does not tell.
pub(crate) type Refusal = Option<String>;

/// A setting of some type.
pub(crate) type AnySetting<'a> = Box<dyn Setting + 'a>;

/// A place, and the two ways between what it holds and text.
struct By<'a, T, R, W> {
    value: &'a mut T,
    read: R,
    write: W,
}

impl<T, R, W> Setting for By<'_, T, R, W>
where
    R: Fn(&str) -> Result<T, Refusal>,
    W: Fn(&T) -> String,
{
    fn read(&mut self, text: &str) -> Result<(), Refusal> {
        *self.value = (self.read)(text)?;
        Ok(())
    }

    fn written(&self) -> String {
        (self.write)(self.value)
    }
}

/// By functions of its own.
pub(crate) fn by<'a, T>(
    value: &'a mut T,
    read: impl Fn(&str) -> Option<T> + 'a,
    write: impl Fn(&T) -> String + 'a,
) -> AnySetting<'a> {
    let read = move |text: &str| read(text).ok_or(None);
    Box::new(By { value, read, write })
}

/// A whole number within a range.
pub(crate) fn integer<'a, T>(value: &'a mut T, range: RangeInclusive<T>) -> AnySetting<'a>
where
    T: FromStr + ToString + PartialOrd + 'a,
{
    let read = move |text: &str| text.parse().ok().filter(|n| range.contains(n));
    by(value, read, T::to_string)
}

/// A word for nothing, or an integer of a range.
pub(crate) fn optional_integer<'a, T>(
    value: &'a mut Option<T>,
    nothing: &'static str,
    range: RangeInclusive<T>,
) -> AnySetting<'a>
where
    T: FromStr + ToString + PartialOrd + 'a,
{
    optional(value, nothing, move |text| {
        text.parse().ok().filter(|n| range.contains(n))
    })
}

/// A finite number for which `holds`.
pub(crate) fn number(value: &mut f64, holds: fn(f64) -> bool) -> AnySetting<'_> {
    let read = move |text: &str| finite(text).filter(|&x| holds(x));
    by(value, read, f64::to_string)
}

/// One of some words.
pub(crate) fn word<'a, T: Copy + PartialEq>(
    value: &'a mut T,
    words: &'static [(&'static str, T)],
) -> AnySetting<'a> {
    let read = |text: &str| Some(words.iter().find(|(word, _)| *word == text)?.1);
    let write = |value: &T| {
        let found = words.iter().find(|(_, meaning)| meaning == value);
        found.map_or_else(String::new, |(word, _)| (*word).to_owned())
    };
    by(value, read, write)
}

/// `on` or `off`.
pub(crate) fn switch(value: &mut bool) -> AnySetting<'_> {
    word(value, &[("on", true), ("off", false)])
}

/// A word for nothing, or what `read` takes.
pub(crate) fn optional<'a, T: ToString>(
    value: &'a mut Option<T>,
    nothing: &'static str,
    read: impl Fn(&str) -> Option<T> + 'a,
) -> AnySetting<'a> {
    reasoned(value, nothing, move |text| read(text).ok_or(None))
}

/// As [`optional`], where `read` tells why it does not take a text.
pub(crate) fn reasoned<'a, T: ToString>(
    value: &'a mut Option<T>,
    nothing: &'static str,
    read: impl Fn(&str) -> Result<T, Refusal> + 'a,
) -> AnySetting<'a> {
    let read = move |text: &str| match text {
        _ if text == nothing => Ok(None),
        _ => read(text).map(Some),
    };
    let write = |value: &Option<T>| {
        let written = value.as_ref().map(T::to_string);
        written.unwrap_or_else(|| nothing.to_owned())
    };
    Box::new(By { value, read, write })
}

/// A number that is neither infinite nor none.
pub(crate) fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

/// Two numbers that grow, both above 0, the second at most `most`, with a colon between them.
pub(crate) fn range(text: &str, most: f64) -> Option<[f64; 2]> {
    let (a, b) = text.split_once(':')?;
    Some([finite(a)?, finite(b)?]).filter(|[a, b]| 0.0 < *a && a < b && *b <= most)
}
