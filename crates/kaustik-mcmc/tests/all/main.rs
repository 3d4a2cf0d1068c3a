//! Laws of the crate, tested from outside.
//!
//! `stationarity`, `exact`: every kernel and composite, to rounding error, on discrete targets.
//! `lazy`: lazy points have the law of eager ones, exactly; `law`: the same by statistics.
//! `unbiased`: weighted visits against sums, exactly; `estimators`: by statistics.
//! `roll_back`: rejection to the bit. `chain`: book-keeping. `kit`: the testing kit finds
//! what it should.

mod chain;
mod estimators;
mod exact;
mod hostile;
mod interleaved;
mod kernels;
mod kit;
mod law;
mod lazy;
mod mutation;
mod mutation_laws;
mod per_coordinate;
mod resume;
mod roll_back;
mod stationarity;
mod unbiased;
mod uncommitted;
