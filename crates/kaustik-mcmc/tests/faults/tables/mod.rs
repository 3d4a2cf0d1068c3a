//! The faults, by what they break. A new one is one more entry: see [`Fault`] for what its
//! fields mean. A new table is one more constant and its name in [`TABLES`].

mod decision;
mod kit;
mod ladder;
mod learning;
mod methods;
mod point;
mod population;
mod sums;
mod written;

use crate::Fault;

/// Short for an entry: its name, the file, what stands there, what shall, who finds it.
const fn fault(
    name: &'static str,
    file: &'static str,
    find: &'static str,
    replace: &'static str,
    caught_by: &'static str,
) -> Fault {
    Fault {
        name,
        file,
        find,
        replace,
        caught_by,
    }
}

/// All of them.
pub(crate) const TABLES: &[&[Fault]] = &[
    decision::DECISION,
    decision::CHAIN,
    decision::KERNEL,
    point::POINT,
    point::MUTATION,
    sums::START,
    sums::SUMS,
    ladder::EXCHANGE,
    ladder::STONES,
    population::POPULATION,
    methods::MIXTURE,
    methods::SECOND,
    methods::SCOUT,
    methods::REDISTRIBUTION,
    learning::ADAPTATION,
    learning::DIAGNOSTICS,
    learning::STRATIFICATION,
    learning::COORDINATES,
    written::WRITTEN,
    kit::KIT,
];
