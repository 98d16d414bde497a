//! `probes.csv`: a row a step.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use crate::io::result::{ResultError, keep_lines};
use crate::scene::{Probe, Simulation};

const NAME: &str = "probes.csv";

/// Writes the probes of a scene.
#[derive(Debug)]
pub(super) struct ProbeWriter {
    probes: Vec<Probe>,
    file: Option<File>,
    path: PathBuf,
    last: Vec<Vec<f64>>,
}

impl ProbeWriter {
    /// Starts the file; without probes there is none.
    pub(super) fn create(folder: &Path, probes: Vec<Probe>) -> Result<Self, ResultError> {
        let mut writer = Self {
            probes,
            file: None,
            path: folder.join(NAME),
            last: Vec::new(),
        };
        if !writer.probes.is_empty() {
            let columns: Vec<String> = writer.probes.iter().flat_map(Probe::columns).collect();
            let begun = File::create(&writer.path).and_then(|mut file| {
                writeln!(file, "time,{}", columns.join(","))?;
                Ok(file)
            });
            writer.file = Some(begun.map_err(|source| writer.refused(source))?);
        }
        Ok(writer)
    }

    /// Goes on after `rows` rows with the last values of all columns.
    ///
    /// # Errors
    /// Fewer rows, other columns, a refusal of the system.
    pub(super) fn resume(
        folder: &Path,
        probes: Vec<Probe>,
        rows: usize,
        last_row: &[f64],
    ) -> Result<Self, ResultError> {
        let path = folder.join(NAME);
        let mut file = None;
        if !probes.is_empty() {
            keep_lines(&path, 1 + rows)?;
            let opened = OpenOptions::new().append(true).open(&path);
            file = Some(opened.map_err(|source| ResultError::Io {
                action: "open",
                path: path.clone(),
                source,
            })?);
        }
        let mut values = last_row.iter().copied();
        let last = probes
            .iter()
            .map(|probe| values.by_ref().take(probe.columns().len()).collect())
            .collect();
        Ok(Self {
            probes,
            file,
            path,
            last,
        })
    }

    /// Brings all rows to the disk.
    pub(super) fn sync(&self) -> Result<(), ResultError> {
        let synced = self.file.as_ref().map_or(Ok(()), File::sync_data);
        synced.map_err(|source| self.refused(source))
    }

    /// The values of the last row.
    pub(super) fn last_row(&self) -> Vec<f64> {
        self.last.concat()
    }

    /// Measures and writes a row; it is on its way to the disk when this returns.
    pub(super) fn write(&mut self, simulation: &Simulation, time: f64) -> Result<(), ResultError> {
        self.last = self
            .probes
            .iter()
            .map(|probe| probe.measure(simulation))
            .collect();
        if self.file.is_none() {
            return Ok(());
        }
        // `{}` writes every digit that is needed to read the same number again.
        let values: Vec<String> = self.last.iter().flatten().map(f64::to_string).collect();
        let row = format!("{time},{}\n", values.join(","));
        let written = (self.file.iter_mut()).try_for_each(|file| file.write_all(row.as_bytes()));
        written.map_err(|source| self.refused(source))
    }

    fn refused(&self, source: io::Error) -> ResultError {
        ResultError::Io {
            action: "write",
            path: self.path.clone(),
            source,
        }
    }

    /// The last values by name: numbers, or lists of three.
    pub(super) fn last_values(&self) -> Value {
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
