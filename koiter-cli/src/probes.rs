//! Values of probes by their columns.

use koiter::scene::{Probe, Simulation};

/// Columns of the probes with their values.
pub(crate) fn values_by_column(probes: &[Probe], simulation: &Simulation) -> Vec<(String, f64)> {
    let of_probe = |probe: &Probe| probe.columns().into_iter().zip(probe.measure(simulation));
    probes.iter().flat_map(of_probe).collect()
}
