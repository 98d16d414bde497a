//! `koiter bench discrete-shells`: the figures of the scenes of "Discrete Shells" (2003), beside an independent implementation
//! (`benchmarks/discrete-shells/SOURCE.md`), each with what it is to be.

mod beams;
mod conservation;
mod hats;
mod paper;
mod run;

use super::gates::Gates;
use super::table::Table;
use crate::arguments::{DiscreteShellsArguments, DiscreteShellsCase};
use crate::failure::Failure;

pub(super) fn bench(options: &DiscreteShellsArguments) -> Result<Table, Failure> {
    let mut gates = Gates::new("Discrete Shells");
    for case in &options.cases {
        match case {
            DiscreteShellsCase::Conservation => conservation::check(&mut gates)?,
            DiscreteShellsCase::Beams => beams::check(&mut gates)?,
            DiscreteShellsCase::Paper => paper::check(&mut gates)?,
            DiscreteShellsCase::Hats => hats::check(&mut gates)?,
        }
    }
    Ok(gates.table)
}
