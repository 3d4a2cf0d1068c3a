//! Finished renders on disk: one picture and one small file each.
//!
//! The picture is written first, the small file second and each under its final name only when it is
//! whole; so a small file that can be read stands for a finished render. It holds two lines of JSON: what the
//! render said, and the full key with the fingerprints of picture and first line. What was cut, changed or
//! belongs to other settings is rendered again.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use kaustik::film::{self, Image, Keep, Limits, exr, write_file};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::StudyError;
use crate::key::{Key, fingerprint};

/// Of files that a study wrote itself: pictures of [`Study::LARGEST`](crate::Study::LARGEST) pixels a side with all layers of a method.
const OWN: Limits = Limits {
    max_file_bytes: 1 << 33,
    max_side: Image::MAX_SIDE,
    max_samples: 1 << 30,
};

/// What is kept of a render beside its picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// By the study's clock, the pilot included.
    pub(crate) seconds: f64,
    /// Samples or mutations a pixel.
    pub(crate) per_pixel: f64,
    /// All that the render said of itself.
    pub(crate) statistics: Value,
}

/// A folder of finished renders.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    folder: PathBuf,
}

/// Larger small files are none of ours.
const LARGEST: u64 = 1 << 20;

impl Store {
    /// In this folder, which is made if it is not there.
    pub(crate) fn open(folder: &Path) -> Result<Self, StudyError> {
        std::fs::create_dir_all(folder).map_err(|source| StudyError::io(folder, source))?;
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    fn path(&self, key: &Key, kind: &str) -> PathBuf {
        self.folder.join(format!("{}.{kind}", key.name()))
    }

    /// Keeps a render.
    pub(crate) fn keep(&self, key: &Key, record: &Record, image: &Image) -> Result<(), StudyError> {
        let path = self.path(key, "exr");
        exr::write(&path, image)?;
        let bytes =
            read_file(&path, OWN.max_file_bytes).map_err(|source| StudyError::io(&path, source))?;
        let record = serde_json::to_string(record).map_err(|e| StudyError::page("record", e))?;
        let words = json!({
            "key": key.value().to_string(),
            "picture": fingerprint(bytes),
            "record": fingerprint(record.bytes()),
        });
        let text = format!("{record}\n{words}\n");
        write_file(&self.path(key, "jsonl"), |file| {
            file.write_all(text.as_bytes())
        })?;
        Ok(())
    }

    /// The small file of a finished render; `None` if there is none that can be trusted.
    pub(crate) fn record(&self, key: &Key) -> Option<Record> {
        let (record, print) = self.words(key)?;
        let bytes = read_file(&self.path(key, "exr"), OWN.max_file_bytes).ok()?;
        (fingerprint(bytes) == print).then_some(record)
    }

    /// A finished render with its picture.
    pub(crate) fn read(&self, key: &Key, keep: Keep) -> Option<(Record, Image)> {
        let (record, print) = self.words(key)?;
        let bytes = read_file(&self.path(key, "exr"), OWN.max_file_bytes).ok()?;
        if fingerprint(bytes.iter().copied()) != print {
            return None;
        }
        let image = film::decode(&bytes, &OWN, keep).ok()?;
        Some((record, image))
    }

    fn words(&self, key: &Key) -> Option<(Record, u64)> {
        let bytes = read_file(&self.path(key, "jsonl"), LARGEST).ok()?;
        let text = std::str::from_utf8(&bytes).ok()?;
        let (record, words) = text.split_once('\n')?;
        let words: Value = serde_json::from_str(words).ok()?;
        // as text: reading a number and writing it again may change its last digit
        let same = words.get("key")?.as_str() == Some(&key.value().to_string());
        if !same || words.get("record")?.as_u64() != Some(fingerprint(record.bytes())) {
            return None;
        }
        let print = words.get("picture")?.as_u64()?;
        Some((serde_json::from_str(record).ok()?, print))
    }
}

fn read_file(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path)?;
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}
