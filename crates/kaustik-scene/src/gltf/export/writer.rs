use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

/// A glTF document in the making: its JSON parts and its binary chunk.
#[derive(Debug, Default)]
pub(super) struct Writer {
    pub(super) binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    extensions: BTreeSet<&'static str>,
    required: BTreeSet<&'static str>,
    root: Map<String, Value>,
}

impl Writer {
    /// Notes that an extension is used.
    pub(super) fn uses(&mut self, extension: &'static str) {
        self.extensions.insert(extension);
    }

    /// Notes that an extension is used, and that the document says something else to whoever does not know it.
    pub(super) fn requires(&mut self, extension: &'static str) {
        self.uses(extension);
        self.required.insert(extension);
    }

    /// Sets a member of the document; empty arrays are left out, as glTF wants it.
    pub(super) fn set(&mut self, key: &str, values: Vec<Value>) {
        if !values.is_empty() {
            self.root.insert(key.to_owned(), values.into());
        }
    }

    pub(super) fn set_value(&mut self, key: &str, value: Value) {
        self.root.insert(key.to_owned(), value);
    }

    /// Appends bytes, aligned to 4, and returns the index of their buffer view.
    pub(super) fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let start = self.binary.len();
        self.binary.extend(bytes);
        let length = self.binary.len() - start;
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views
            .push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length }));
        self.views.len() - 1
    }

    /// Appends `count` elements, four bytes a component, and returns the index of their
    /// accessor. There is no buffer view for nothing.
    pub(super) fn accessor(
        &mut self,
        kind: &str,
        component: u32,
        count: usize,
        words: impl Iterator<Item = [u8; 4]>,
    ) -> usize {
        let mut accessor = json!({ "type": kind, "componentType": component, "count": count });
        if count > 0 {
            accessor["bufferView"] = self.view(words.flatten()).into();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Vectors of floats.
    pub(super) fn floats<const N: usize>(
        &mut self,
        values: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> usize {
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        let count = values.len();
        self.accessor(kind, 5126, count, values.flatten().map(f32::to_le_bytes))
    }

    /// Adds the least and the greatest element to an accessor, as positions and times need them.
    pub(super) fn bound(&mut self, accessor: usize, least: &[f32], most: &[f32]) {
        self.accessors[accessor]["min"] = numbers(least);
        self.accessors[accessor]["max"] = numbers(most);
    }

    /// The JSON of the whole document and its binary chunk. `uri` says where the chunk is to
    /// be found if it is not part of the file.
    pub(super) fn finish(mut self, uri: impl FnOnce(&[u8]) -> Option<String>) -> (Value, Vec<u8>) {
        let generator = concat!("kaustik ", env!("CARGO_PKG_VERSION"));
        self.set_value("asset", json!({ "version": "2.0", "generator": generator }));
        let (views, accessors) = (
            std::mem::take(&mut self.views),
            std::mem::take(&mut self.accessors),
        );
        self.set("bufferViews", views);
        self.set("accessors", accessors);
        let used = self.extensions.iter().map(|&name| name.into()).collect();
        self.set("extensionsUsed", used);
        let required = self.required.iter().map(|&name| name.into()).collect();
        self.set("extensionsRequired", required);
        if !self.binary.is_empty() {
            let mut buffer = json!({ "byteLength": self.binary.len() });
            if let Some(uri) = uri(&self.binary) {
                buffer["uri"] = uri.into();
            }
            self.set("buffers", vec![buffer]);
        }
        (Value::Object(self.root), self.binary)
    }
}

/// A number that reads back with the same bits: the shortest decimal that has them where a
/// reader who rounds twice, and badly, cannot miss them. `null` if it is not finite, which
/// the check of the finished file finds.
pub(super) fn number(value: f32) -> Value {
    let exact = f64::from(value);
    let short = format!("{value}").parse().unwrap_or(exact);
    let safe = |f: f64| (f as f32).to_bits() == value.to_bits();
    if safe(short.next_down()) && safe(short.next_up()) {
        return short.into();
    }
    exact.into()
}

pub(super) fn numbers(values: &[f32]) -> Value {
    values.iter().map(|&value| number(value)).collect()
}

/// An object of its members, built where some may be left out.
#[derive(Debug, Default)]
pub(super) struct Object(Map<String, Value>);

impl Object {
    pub(super) fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.0.insert(key.to_owned(), value.into());
        self
    }

    /// Sets `key` if there is something to set.
    pub(super) fn maybe(self, key: &str, value: Option<impl Into<Value>>) -> Self {
        match value {
            Some(value) => self.with(key, value),
            None => self,
        }
    }

    /// Sets `name` unless it is empty.
    pub(super) fn named(self, name: &str) -> Self {
        self.maybe("name", (!name.is_empty()).then_some(name))
    }

    /// The object, if it has members.
    pub(super) fn some(self) -> Option<Value> {
        (!self.0.is_empty()).then_some(Value::Object(self.0))
    }
}

impl From<Object> for Value {
    fn from(object: Object) -> Self {
        Self::Object(object.0)
    }
}

/// `extras` with our own members, if there are any.
pub(super) fn extras(ours: Object) -> Option<Value> {
    ours.some().map(|ours| json!({ "kaustik": ours }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_with_their_bits() {
        let mut bits = 1_u32;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            if !value.is_finite() {
                continue;
            }
            let text = number(value).to_string();
            let read: Value = serde_json::from_str(&text).unwrap();
            let back = read.as_f64().unwrap() as f32;
            assert_eq!(back.to_bits(), value.to_bits(), "{text}");
        }
        assert_eq!(number(0.1).to_string(), "0.1");
        assert_eq!(number(-0.0).to_string(), "-0.0");
        assert!(number(f32::NAN).is_null());
    }
}
