//! A place in a JSON document that knows its own JSON pointer.
//!
//! Every look-up returns either a value of the wanted type or an error that names the place,
//! what stands there and what should. Typed models of glTF lose the place on the way, which
//! is why this loader reads the plain JSON tree.

use std::fmt::Write as _;
use std::rc::Rc;

use serde_json::{Map, Value};

use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

/// One step of a JSON pointer.
#[derive(Clone, Copy, Debug)]
enum Segment<'a> {
    Key(&'a str),
    Item(usize),
}

#[derive(Debug)]
struct Link<'a> {
    parent: Option<Rc<Link<'a>>>,
    segment: Segment<'a>,
}

/// A value with the way that led to it.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    value: &'a Value,
    path: Option<Rc<Link<'a>>>,
}

impl<'a> Cursor<'a> {
    pub(super) fn root(value: &'a Value) -> Self {
        Self { value, path: None }
    }

    fn step(&self, value: &'a Value, segment: Segment<'a>) -> Self {
        let path = Some(Rc::new(Link {
            parent: self.path.clone(),
            segment,
        }));
        Self { value, path }
    }

    /// The JSON pointer (RFC 6901) of this place.
    pub(super) fn pointer(&self) -> String {
        let mut segments = Vec::new();
        let mut link = self.path.as_deref();
        while let Some(l) = link {
            segments.push(l.segment);
            link = l.parent.as_deref();
        }
        let mut pointer = String::new();
        for segment in segments.iter().rev() {
            pointer.push('/');
            match segment {
                Segment::Key(key) => {
                    pointer.push_str(&shorten(key).replace('~', "~0").replace('/', "~1"));
                }
                Segment::Item(index) => {
                    let _ = write!(pointer, "{index}");
                }
            }
        }
        pointer
    }

    /// An error at this place.
    pub(super) fn error(
        &self,
        kind: ErrorKind,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> LoadError {
        LoadError::new(kind, self.pointer(), found, expected)
    }

    /// This value is not what was expected.
    pub(super) fn mismatch(&self, expected: impl Into<String>) -> LoadError {
        self.error(ErrorKind::Value, describe(self.value), expected)
    }

    pub(super) fn object(&self) -> Result<&'a Map<String, Value>> {
        let object = self.value.as_object();
        object.ok_or_else(|| self.mismatch("an object"))
    }

    pub(super) fn is_object(&self) -> bool {
        self.value.is_object()
    }

    /// Do two places say the same?
    pub(super) fn says_as(&self, other: &Self) -> bool {
        self.value == other.value
    }

    pub(super) fn is_array(&self) -> bool {
        self.value.is_array()
    }

    /// The member `key` of this object, if there is one.
    pub(super) fn get(&self, key: &'a str) -> Result<Option<Self>> {
        let member = self.object()?.get(key);
        Ok(member.map(|value| self.step(value, Segment::Key(key))))
    }

    /// The member `key` of this object.
    pub(super) fn need(&self, key: &'a str) -> Result<Self> {
        self.get(key)?.ok_or_else(|| {
            let found = format!("no \"{key}\"");
            self.error(ErrorKind::Value, found, format!("a member \"{key}\""))
        })
    }

    /// The extension `name` of this object.
    pub(super) fn extension(&self, name: &'a str) -> Result<Option<Self>> {
        match self.get("extensions")? {
            Some(extensions) => extensions.get(name),
            None => Ok(None),
        }
    }

    /// `extras.kaustik` of this object. Extras may be anything; `kaustik` must be an object.
    pub(super) fn extras(&self) -> Result<Option<Self>> {
        match self.get("extras")? {
            Some(extras) if extras.is_object() => {
                let ours = extras.get("kaustik")?;
                if let Some(ours) = &ours {
                    ours.object()?;
                }
                Ok(ours)
            }
            _ => Ok(None),
        }
    }

    /// The elements of this array.
    pub(super) fn items(&self) -> Result<impl ExactSizeIterator<Item = Self> + use<'a>> {
        let array = self.value.as_array();
        let array = array.ok_or_else(|| self.mismatch("an array"))?;
        let this = self.clone();
        let items = array.iter().enumerate();
        Ok(items.map(move |(i, value)| this.step(value, Segment::Item(i))))
    }

    /// The elements of the array `key`; none if there is no such member.
    pub(super) fn list(&self, key: &'a str) -> Result<Vec<Self>> {
        match self.get(key)? {
            Some(array) => Ok(array.items()?.collect()),
            None => Ok(Vec::new()),
        }
    }

    /// How many elements the array `key` has.
    pub(super) fn count(&self, key: &'a str) -> Result<usize> {
        match self.get(key)? {
            Some(array) => Ok(array.items()?.len()),
            None => Ok(0),
        }
    }

    /// Element `index` of this array.
    pub(super) fn item(&self, index: usize) -> Option<Self> {
        let value = self.value.as_array()?.get(index)?;
        Some(self.step(value, Segment::Item(index)))
    }

    pub(super) fn string(&self) -> Result<&'a str> {
        let string = self.value.as_str();
        string.ok_or_else(|| self.mismatch("a string"))
    }

    /// The string `key`, empty if there is none.
    pub(super) fn text(&self, key: &'a str) -> Result<&'a str> {
        self.get(key)?.map_or(Ok(""), |c| c.string())
    }

    pub(super) fn flag(&self, key: &'a str) -> Result<bool> {
        self.flag_or(key, false)
    }

    pub(super) fn flag_or(&self, key: &'a str, default: bool) -> Result<bool> {
        let Some(member) = self.get(key)? else {
            return Ok(default);
        };
        let flag = member.value.as_bool();
        flag.ok_or_else(|| member.mismatch("true or false"))
    }

    pub(super) fn f64(&self) -> Result<f64> {
        let number = self.value.as_f64();
        number.ok_or_else(|| self.mismatch("a number"))
    }

    /// A number that is finite in single precision.
    pub(super) fn f32(&self) -> Result<f32> {
        let number = self.f64()? as f32;
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.error(
            ErrorKind::NotFinite,
            describe(self.value),
            "a number within single precision (below 3.4e38)",
        ))
    }

    pub(super) fn f32_or(&self, key: &'a str, default: f32) -> Result<f32> {
        self.get(key)?.map_or(Ok(default), |c| c.f32())
    }

    /// A non-negative whole number; `3.0` counts as one.
    pub(super) fn usize(&self) -> Result<usize> {
        let whole = self.value.as_u64().or_else(|| {
            let f = self.value.as_f64()?;
            ((0.0..=9e15).contains(&f) && f.fract() == 0.0).then_some(f as u64)
        });
        let whole = whole.and_then(|n| usize::try_from(n).ok());
        whole.ok_or_else(|| self.mismatch("a non-negative integer"))
    }

    pub(super) fn usize_or(&self, key: &'a str, default: usize) -> Result<usize> {
        self.get(key)?.map_or(Ok(default), |c| c.usize())
    }

    pub(super) fn i32(&self) -> Result<i32> {
        let whole = self.value.as_i64().and_then(|n| i32::try_from(n).ok());
        whole.ok_or_else(|| self.mismatch("an integer of 32 bits"))
    }

    /// An index below `len` into the array `into`.
    pub(super) fn index(&self, into: &str, len: usize) -> Result<usize> {
        let index = self.usize()?;
        if index < len {
            return Ok(index);
        }
        let expected = match len {
            0 => format!("no index, as the file has no {into}"),
            _ => format!("an index into {into}, 0 to {}", len - 1),
        };
        Err(self.error(ErrorKind::Reference, index.to_string(), expected))
    }

    /// What the index at this place refers to: an element of the array `key` of `root`.
    pub(super) fn target(&self, root: &Self, key: &'a str) -> Result<Self> {
        let index = self.index(&format!("/{key}"), root.count(key)?)?;
        let target = root.get(key)?.and_then(|array| array.item(index));
        target.ok_or_else(|| self.mismatch("an index"))
    }

    /// `N` numbers, finite in single precision.
    pub(super) fn floats<const N: usize>(&self) -> Result<[f32; N]> {
        let wrong = || self.mismatch(format!("an array of {N} numbers"));
        let mut items = self.items().map_err(|_| wrong())?;
        if items.len() != N {
            return Err(wrong());
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(&mut items) {
            *number = item.f32()?;
        }
        Ok(numbers)
    }

    pub(super) fn floats_or<const N: usize>(
        &self,
        key: &'a str,
        default: [f32; N],
    ) -> Result<[f32; N]> {
        self.get(key)?.map_or(Ok(default), |c| c.floats())
    }
}

/// What a value is, for messages.
pub(super) fn describe(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(b) => b.to_string(),
        Value::Number(n) => n.to_string(),
        Value::String(s) => format!("\"{}\"", shorten(s)),
        Value::Array(a) => match a.len() {
            0 => "an empty array".into(),
            1 => "an array of 1 value".into(),
            n => format!("an array of {n} values"),
        },
        Value::Object(_) => "an object".into(),
    }
}

/// At most 60 characters, without control characters.
pub(super) fn shorten(text: &str) -> String {
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut short: String = text.chars().take(60).map(clean).collect();
    if text.chars().nth(60).is_some() {
        short.push('…');
    }
    short
}
