use serde_json::Value;

use super::budget::Budget;
use super::json::shorten;
use super::{ErrorKind, LoadError};

/// Parses JSON text within the budget. The tree costs far more than the text (an object of
/// one short key takes some 700 bytes), so the structure is counted first.
pub(super) fn parse(text: &[u8], budget: &mut Budget) -> Result<Value, LoadError> {
    budget.take("", tree_size(text))?;
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    serde_json::from_slice(text).map_err(|e| {
        let message = e.to_string();
        let found = message.split(" at line ").next().unwrap_or(&message);
        let place = format!("line {}, column {}", e.line(), e.column());
        let found = format!("broken JSON ({})", shorten(found));
        LoadError::new(ErrorKind::Syntax, place, found, "well-formed JSON")
    })
}

/// An upper bound on the bytes of the parsed tree: a node of the standard map holds up to 11
/// entries of 56 bytes, a vector grows by doubling.
fn tree_size(text: &[u8]) -> u64 {
    let (mut objects, mut values, mut quoted, mut escaped) = (0_u64, 1_u64, false, false);
    for &byte in text {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'{' => objects += 1,
            b',' | b'[' | b':' => values += 1,
            _ => {}
        }
    }
    text.len() as u64 + 720 * objects + 128 * values
}
