//! `probes.csv`: a row a step.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use koiter::io::result::{ResultError, keep_lines};
use koiter::scene::Probe;
use koiter::scene::Simulation;
use serde_json::{Map, Value, json};

/// Columns of the probes with their values.
pub(crate) fn values_by_column(probes: &[Probe], simulation: &Simulation) -> Vec<(String, f64)> {
    let of_probe = |probe: &Probe| probe.columns().into_iter().zip(probe.measure(simulation));
    probes.iter().flat_map(of_probe).collect()
}

/// Writes the probes of a scene.
pub(crate) struct ProbeWriter<'a> {
    probes: &'a [Probe],
    file: Option<File>,
    last: Vec<Vec<f64>>,
}

impl<'a> ProbeWriter<'a> {
    /// Starts the file; without probes there is none.
    pub(crate) fn create(folder: &Path, probes: &'a [Probe]) -> io::Result<Self> {
        let mut file = None;
        if !probes.is_empty() {
            let mut created = File::create(folder.join("probes.csv"))?;
            let columns: Vec<String> = probes.iter().flat_map(Probe::columns).collect();
            writeln!(created, "time,{}", columns.join(","))?;
            file = Some(created);
        }
        Ok(Self {
            probes,
            file,
            last: Vec::new(),
        })
    }

    /// Goes on after `rows` rows with the last values of all columns.
    ///
    /// # Errors
    /// Fewer rows, other columns, a refusal of the system.
    pub(crate) fn resume(
        folder: &Path,
        probes: &'a [Probe],
        rows: usize,
        last_row: &[f64],
    ) -> Result<Self, ResultError> {
        let path = folder.join("probes.csv");
        let mut file = None;
        if !probes.is_empty() {
            keep_lines(&path, 1 + rows)?;
            let opened = OpenOptions::new().append(true).open(&path);
            file = Some(opened.map_err(|source| ResultError::Io {
                action: "open",
                path,
                source,
            })?);
        }
        let mut values = last_row.iter().copied();
        let last = probes
            .iter()
            .map(|probe| values.by_ref().take(probe.columns().len()).collect())
            .collect();
        Ok(Self { probes, file, last })
    }

    /// Brings all rows to the disk.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.as_ref().map_or(Ok(()), File::sync_data)
    }

    /// The values of the last row.
    pub(crate) fn last_row(&self) -> Vec<f64> {
        self.last.concat()
    }

    /// Measures and writes a row; it is on its way to the disk when this returns.
    pub(crate) fn write(&mut self, simulation: &Simulation, time: f64) -> io::Result<()> {
        self.last = self
            .probes
            .iter()
            .map(|probe| probe.measure(simulation))
            .collect();
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        // `{}` writes every digit that is needed to read the same number again.
        let values: Vec<String> = self.last.iter().flatten().map(f64::to_string).collect();
        let row = format!("{time},{}\n", values.join(","));
        file.write_all(row.as_bytes())
    }

    /// The last values by name: numbers, or lists of three.
    pub(crate) fn last_values(&self) -> Value {
        let value = |values: &Vec<f64>| match values[..] {
            [value] => json!(value),
            _ => json!(values),
        };
        let names = self.probes.iter().map(|probe| probe.name.clone());
        Value::Object(
            names
                .zip(self.last.iter().map(value))
                .collect::<Map<_, _>>(),
        )
    }
}
