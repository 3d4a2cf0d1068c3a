#![expect(
    clippy::float_cmp,
    clippy::needless_pass_by_value,
    reason = "what is read must be the very numbers that were written; json! borrows its parts"
)]

mod animation;
mod any;
mod crafted;
mod decoders;
mod environment;
mod file;
mod formats;
mod geometry;
mod hierarchy;
mod hostile;
mod images;
mod linear;
mod mutate;
mod shapes;
mod surface;
mod translucent;
mod trip;
