//! A film of integer sums, pixel filters, EXR and PNG files, image metrics.
//!
//! Why integers: a film that every thread of a render adds to must hold the same bits for any order of
//! adds, or no run could be repeated. Sums of floats depend on their order; sums of integers do not. So a
//! [`Film`] keeps 64-bit fixed-point sums, shared by reference, added to with relaxed atomics: one film
//! for all threads, no copy a thread, no lock.
//!
//! The way of a picture: [`Film::splat`] -> [`develop`] -> [`Image`] -> [`exr::write`] or [`png::write`];
//! and back: [`read()`] -> [`metrics::compare`].
//!
//! ```
//! use kaustik_film::{Film, Filter, Layout, Quantum, develop};
//! use kaustik_spectrum::Xyz;
//!
//! let layout = Layout::new(4, 2).with_filter(Filter::BOX);
//! let film = Film::with_layout(&layout, Quantum::from_mean(1.0))?;
//! std::thread::scope(|scope| {
//!     for y in 0..2 {
//!         let film = &film;
//!         scope.spawn(move || film.splat(0.5, f64::from(y) + 0.5, Xyz([1.0, 1.0, 1.0])));
//!     }
//! });
//! let image = develop(&[(&film, 1.0)])?;
//! assert_eq!((image.width(), image.height()), (4, 2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod average;
mod develop;
pub mod exr;
mod fence;
mod film;
mod filter;
mod image;
mod layout;
pub mod metrics;
mod outcome;
pub mod png;
mod quantum;
mod read;
mod tone;

pub use atomic::{Sink, WriteError, check_writable, write_file};
pub use average::Average;
pub use develop::{DevelopError, develop, develop_xyz};
pub use fence::is_fenced;
pub use film::Film;
pub use filter::{Filter, FilterError, Taps};
pub use image::{Channel, Image, ImageError, Layer};
pub use layout::{Bounds, Layout, Window};
pub use outcome::{Added, Counters, FilmError};
pub use quantum::Quantum;
pub use read::{DecodeError, Keep, Limits, ReadError, decode, read};
pub use tone::{Tone, ToneCurve, ToneError};
