use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static FENCED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder of another library on a stranger's bytes. Should it panic, the panic ends here, as `None`.
pub(crate) fn fenced<T>(decode: impl FnOnce() -> T) -> Option<T> {
    let outer = FENCED.replace(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    FENCED.set(outer);
    decoded.ok()
}

/// Whether this thread is within a decoder whose panics end in an ordinary error. A program's panic hook may
/// say nothing then.
pub fn is_fenced() -> bool {
    FENCED.get()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_at_the_fence() {
        assert_eq!(fenced(|| 1 + 1), Some(2));
        assert_eq!(
            fenced(|| -> u32 {
                assert!(is_fenced());
                panic!("a decoder gives up")
            }),
            None
        );
        assert!(!is_fenced());
    }
}
