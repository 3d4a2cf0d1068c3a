use crate::Stream;

/// A point of the primary sample space, read coordinate by coordinate.
///
/// Access is random: a coordinate that is never asked for shifts nothing, and asking
/// twice for the same one within an evaluation gives the same number, unless the
/// implementation says otherwise.
pub trait Coordinates {
    /// The coordinate `index` of `stream`, uniform in [0, 1) under plain Monte Carlo.
    fn get(&mut self, stream: Stream, index: u32) -> f64;
}
