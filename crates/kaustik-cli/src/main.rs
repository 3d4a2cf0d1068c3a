//! The `kaustik` command.

fn main() {}
