/// What has become of a segment's light at partly transparent surfaces so far.
///
/// One number `u` for the whole segment, asked for at the first such surface, stops it where
/// the share that has passed falls to u.
pub(crate) struct Passage<U> {
    ask: Option<U>,
    threshold: f64,
    passed: f64,
}

impl<U: FnOnce() -> f64> Passage<U> {
    /// At the start of a segment.
    #[inline]
    pub(crate) fn new(u: U) -> Self {
        Self {
            ask: Some(u),
            threshold: 0.0,
            passed: 1.0,
        }
    }

    /// Does the segment end at a surface of this opacity?
    pub(super) fn is_stopped_by(&mut self, opacity: f32) -> bool {
        if opacity >= 1.0 {
            return true;
        }
        if opacity <= 0.0 {
            return false;
        }
        if let Some(u) = self.ask.take() {
            self.threshold = u();
        }
        self.passed *= 1.0 - f64::from(opacity);
        self.passed <= self.threshold
    }
}
