//! Laws of the crate, tested from outside.
//!
//! `exact`: stationarity and balance to rounding error, on discrete targets.
//! `law`: statistical tests of lazy points against eager ones. `estimators`: weighted visits
//! against known integrals. `roll_back`: rejection to the bit. `chain`: book-keeping.

mod chain;
mod estimators;
mod exact;
mod law;
mod mutation;
mod mutation_laws;
mod per_coordinate;
mod roll_back;
