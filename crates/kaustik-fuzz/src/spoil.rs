//! From a sound file to a broken one.

use serde_json::{Value, json};

use crate::model::Model;
use crate::random::Random;

/// A sound file.
#[derive(Clone, Debug)]
pub(crate) enum Base {
    /// A scene, whose parts are broken by themselves.
    Model(Model),
    /// Bytes without a structure that is known here.
    Bytes(Vec<u8>),
}

/// File number `file` of the campaign of this seed.
pub(crate) fn file(bases: &[Base], seed: u64, file: u64) -> Vec<u8> {
    let random = &mut Random::new(seed, file);
    match random.pick(bases) {
        None => Vec::new(),
        Some(Base::Bytes(bytes)) => {
            let mut bytes = bytes.clone();
            for _ in 0..=random.below(3) {
                spoil_bytes(&mut bytes, random);
            }
            bytes
        }
        Some(Base::Model(model)) => spoil_model(model.clone(), random),
    }
}

fn spoil_model(mut model: Model, random: &mut Random) -> Vec<u8> {
    for _ in 0..=random.below(3) {
        match random.below(4) {
            0 => spoil_floats(&mut model.binary, random),
            1 => spoil_text(&mut model.json, random),
            _ => spoil_number(&mut model.json, random),
        }
    }
    let mut bytes = model.glb();
    match random.below(8) {
        0 => spoil_bytes(&mut bytes, random),
        1 => spoil_lengths(&mut bytes, random),
        2 => bytes.truncate(random.below(bytes.len())),
        // as text, with nothing for its buffer
        3 => bytes = model.json.to_string().into_bytes(),
        _ => {}
    }
    bytes
}

/// Numbers that have hurt somebody.
const FLOATS: [f32; 10] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    1e38,
    -1e38,
    1e-40,
    -0.0,
    f32::MAX,
    f32::MIN_POSITIVE,
    1e20,
];

fn spoil_floats(binary: &mut [u8], random: &mut Random) {
    for _ in 0..=random.below(8) {
        let at = 4 * random.below(binary.len() / 4);
        let value = match random.below(3) {
            0 => f32::from_bits(random.next() as u32),
            _ => random.pick(&FLOATS).copied().unwrap_or(0.0),
        };
        if let Some(bytes) = binary.get_mut(at..at + 4) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
    }
}

/// The length fields of the container and of its chunks.
fn spoil_lengths(bytes: &mut [u8], random: &mut Random) {
    let at = [4, 8, 12, 16].get(random.below(4)).copied().unwrap_or(8);
    let value = match random.below(4) {
        0 => u32::MAX,
        1 => u32::MAX - random.below(64) as u32,
        2 => random.below(64) as u32,
        _ => random.next() as u32,
    };
    if let Some(field) = bytes.get_mut(at..at + 4) {
        field.copy_from_slice(&value.to_le_bytes());
    }
}

fn spoil_bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len());
    let until = (at + 1 + random.below(16)).min(bytes.len());
    match random.below(7) {
        0 => bytes.truncate(at),
        1 => {
            let repeated: Vec<u8> = bytes.get(at..until).unwrap_or_default().to_vec();
            bytes.splice(at..at, repeated);
        }
        2 => {
            bytes.drain(at..until);
        }
        3 => {
            for byte in bytes.get_mut(at..until).unwrap_or_default() {
                *byte = 0xff;
            }
        }
        // headers say how large things are
        4 => {
            let at = random.below(bytes.len().min(64));
            if let Some(byte) = bytes.get_mut(at) {
                *byte = random.byte();
            }
        }
        _ => {
            for _ in 0..=random.below(8) {
                let at = random.below(bytes.len());
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.below(8);
                }
            }
        }
    }
}

/// The pointers of all values that `wanted` holds for.
fn places(value: &Value, wanted: &impl Fn(&Value) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut pending = vec![(String::new(), value)];
    while let Some((pointer, value)) = pending.pop() {
        if wanted(value) {
            found.push(pointer.clone());
        }
        match value {
            Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    pending.push((format!("{pointer}/{i}"), item));
                }
            }
            Value::Object(members) => {
                for (key, member) in members {
                    let key = key.replace('~', "~0").replace('/', "~1");
                    pending.push((format!("{pointer}/{key}"), member));
                }
            }
            _ => {}
        }
    }
    found
}

fn spoil_number(json: &mut Value, random: &mut Random) {
    let places = places(json, &Value::is_number);
    let Some(place) = random.pick(&places) else {
        return;
    };
    let whole = [
        json!(0),
        json!(1),
        json!(-1),
        json!(3),
        json!(255),
        json!(1_u64 << 31),
        json!(1_u64 << 33),
        json!(1_u64 << 62),
        json!(u64::MAX),
        json!(u64::MAX - 7),
        json!(1e38),
        json!(-1e38),
        json!(1e-40),
        json!(1e300),
        json!(0.5),
    ];
    let chosen = random.pick(&whole).cloned().unwrap_or(Value::Null);
    if let Some(value) = json.pointer_mut(place) {
        *value = match random.below(3) {
            0 => json!(random.below(8)),
            _ => chosen,
        };
    }
}

/// Words of the format, and others that no file should have.
const WORDS: [&str; 22] = [
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT4",
    "MASK",
    "BLEND",
    "OPAQUE",
    "perspective",
    "orthographic",
    "point",
    "spot",
    "directional",
    "TRIANGLES",
    "INDICES",
    "ATTRIBUTES",
    "OCTAHEDRAL",
    "QUATERNION",
    "EXPONENTIAL",
    "../secret",
    "data:;base64,AAAA",
    "",
];

/// Puts a word in the place of a text; or drops or doubles a part of any value, or puts something odd in its place.
fn spoil_text(json: &mut Value, random: &mut Random) {
    let everywhere = places(json, &|value| !value.is_null());
    let texts = places(json, &Value::is_string);
    let replace = random.below(3) > 0;
    let Some(place) = random.pick(if replace { &texts } else { &everywhere }) else {
        return;
    };
    let word = random.pick(&WORDS).copied().unwrap_or("");
    let odd = [
        json!(null),
        json!([]),
        json!({}),
        json!(true),
        json!(word),
        json!([[[]]]),
    ];
    let odd = random.pick(&odd).cloned().unwrap_or(Value::Null);
    let Some(value) = json.pointer_mut(place) else {
        return;
    };
    match (replace, value) {
        (true, value) => *value = json!(word),
        (false, Value::Array(items)) if !items.is_empty() => {
            let at = random.below(items.len());
            if random.below(2) == 0 {
                items.remove(at);
            } else {
                items.push(items[at].clone());
            }
        }
        (false, Value::Object(members)) if !members.is_empty() => {
            let keys: Vec<String> = members.keys().cloned().collect();
            if let Some(key) = random.pick(&keys) {
                members.remove(key);
            }
        }
        (false, value) => *value = odd,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::Kind;
    use crate::{model, picture};

    /// The same seed breaks in the same way; most files differ from their base.
    #[test]
    fn breaking_is_repeatable_and_breaks() {
        let models: Vec<Base> = model::all().into_iter().map(Base::Model).collect();
        let pictures: Vec<Base> = picture::all(Kind::Png)
            .into_iter()
            .map(Base::Bytes)
            .collect();
        for bases in [models, pictures] {
            let sound: Vec<Vec<u8>> = bases
                .iter()
                .map(|base| match base {
                    Base::Model(model) => model.glb(),
                    Base::Bytes(bytes) => bytes.clone(),
                })
                .collect();
            let mut changed = 0;
            for i in 0..200 {
                let bytes = file(&bases, 5, i);
                assert!(bytes == file(&bases, 5, i));
                changed += usize::from(!sound.contains(&bytes));
            }
            assert!(changed > 180, "{changed}");
        }
    }
}
