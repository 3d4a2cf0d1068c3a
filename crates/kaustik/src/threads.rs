//! The threads of a render, and of what comes before it.

use crate::RenderError;

/// So many threads, or one a processor if that is 0.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, RenderError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| RenderError::Threads(error.to_string()))
}

/// Does work that uses threads (loading a file, building a scene) on so many, as a render does with
/// [`RenderSettings::threads`](crate::RenderSettings::threads); 0: one a processor. What it does must not depend on
/// their number.
///
/// # Errors
///
/// If they cannot be started.
pub fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> T + Send,
) -> Result<T, RenderError> {
    Ok(pool(threads)?.install(work))
}
