//! What a uri of a scene file means: bytes that it holds itself, or a relative path.

use base64::Engine as _;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use base64::{alphabet, engine::DecodePaddingMode};

use super::json::{Cursor, shorten};
use super::{ErrorKind, LoadError};

/// The path of a relative uri, or the bytes of a data uri.
#[derive(Debug, PartialEq)]
pub(super) enum Uri {
    /// Percent-decoded once, or as it is written if its escapes are none (exporters write "10%.bin"); it has no scheme and is not absolute, and its `..` do not climb
    /// above where it starts.
    Relative(String),
    /// The payload of a data uri.
    Data(Vec<u8>),
}

impl Uri {
    pub(super) fn read(place: &Cursor<'_>) -> Result<Self, LoadError> {
        let text = place.string()?;
        if let Some(rest) = strip_scheme(text, "data") {
            return data(rest).map(Self::Data).ok_or_else(|| {
                let found = format!("\"{}\"", shorten(text));
                place.error(ErrorKind::Value, found, "a well-formed data uri")
            });
        }
        let path = percent_decode(text).and_then(|bytes| String::from_utf8(bytes).ok());
        let path = path.unwrap_or_else(|| text.to_owned());
        match outside(text, &path) {
            None => Ok(Self::Relative(path)),
            Some(why) => Err(place
                .error(
                    ErrorKind::Forbidden,
                    format!("\"{}\" ({why})", shorten(text)),
                    "a relative path inside the folder of the scene file",
                )
                .help("copy the file beside the scene and refer to it by its name")),
        }
    }
}

/// Why a path must not be followed, if so. Both spellings are looked at, since what hides
/// behind a percent escape counts as well.
fn outside(raw: &str, path: &str) -> Option<&'static str> {
    if has_scheme(raw) || has_scheme(path) {
        return Some("it has a scheme");
    }
    if path.starts_with(['/', '\\']) {
        return Some("it is absolute");
    }
    if path.is_empty() || path.contains('\0') {
        return Some("it names no file");
    }
    let mut depth = 0_i64;
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => depth -= 1,
            _ => depth += 1,
        }
        if depth < 0 {
            return Some("it leaves the folder");
        }
    }
    None
}

/// Does the text begin with a uri scheme (RFC 3986, 3.1)? A drive letter is one, too.
fn has_scheme(text: &str) -> bool {
    let Some((scheme, _)) = text.split_once(':') else {
        return false;
    };
    let tail = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(tail)
}

fn strip_scheme<'a>(text: &'a str, scheme: &str) -> Option<&'a str> {
    let (found, rest) = text.split_once(':')?;
    found.eq_ignore_ascii_case(scheme).then_some(rest)
}

/// Padding is optional, as files in the wild leave it out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The payload of `[type][;base64],payload`.
fn data(rest: &str) -> Option<Vec<u8>> {
    let (kind, payload) = rest.split_once(',')?;
    if kind.to_ascii_lowercase().ends_with(";base64") {
        return BASE64.decode(payload).ok();
    }
    percent_decode(payload)
}

/// Decodes `%xx` once.
fn percent_decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        if byte != b'%' {
            bytes.push(byte);
            rest = tail;
            continue;
        }
        let hex = tail.get(..2).and_then(|h| std::str::from_utf8(h).ok())?;
        if !hex.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        bytes.push(u8::from_str_radix(hex, 16).ok()?);
        rest = &tail[2..];
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(uri: &str) -> Result<Uri, ErrorKind> {
        Uri::read(&Cursor::root(&json!(uri))).map_err(|e| e.kind())
    }

    #[test]
    fn relative_paths_are_decoded_once() {
        let path = |p: &str| Ok(Uri::Relative(p.into()));
        assert_eq!(read("a.bin"), path("a.bin"));
        assert_eq!(read("a%20b%2525.bin"), path("a b%25.bin"));
        assert_eq!(read("textures/../a.bin"), path("textures/../a.bin"));
        assert_eq!(read("%C3%A9.png"), path("é.png"));
    }

    #[test]
    fn what_leads_outside_is_refused() {
        for uri in [
            "/etc/passwd",
            "%2Fetc/passwd",
            "../secret",
            "a/../../secret",
            "%2e%2e/secret",
            "%2e%2e%2fsecret",
            "..\\secret",
            "\\\\server\\share",
            "C:\\secret",
            "file:///etc/passwd",
            "FILE:/etc/passwd",
            "file%3a///etc/passwd",
            "http://example.org/a.bin",
            "",
            "a%00.bin",
        ] {
            assert_eq!(read(uri), Err(ErrorKind::Forbidden), "{uri}");
        }
    }

    /// Blender names the buffer of "example 10%.blend" so.
    #[test]
    fn what_is_no_escape_is_read_as_it_is_written() {
        for uri in ["example 10%.bin", "a%2.bin", "a%ff.bin", "%2e%2e/a%.bin"] {
            assert_eq!(read(uri), Ok(Uri::Relative(uri.into())));
        }
        for uri in ["../10%.bin", "/10%.bin", "c:10%.bin", "..\\10%"] {
            assert_eq!(read(uri), Err(ErrorKind::Forbidden), "{uri}");
        }
    }

    #[test]
    fn data_uris_are_decoded_or_refused() {
        let bytes = |b: &[u8]| Ok(Uri::Data(b.to_vec()));
        assert_eq!(read("data:;base64,AAEC"), bytes(&[0, 1, 2]));
        assert_eq!(read("data:image/png;base64,AA=="), bytes(&[0]));
        assert_eq!(read("data:image/png;base64,AA"), bytes(&[0]));
        assert_eq!(read("DATA:,a%20b"), bytes(b"a b"));
        assert_eq!(read("data:;base64,*"), Err(ErrorKind::Value));
        assert_eq!(read("data:nothing"), Err(ErrorKind::Value));
    }
}
