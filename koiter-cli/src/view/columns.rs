//! Figures a step as one list a column: of `stats.jsonl` and `probes.csv`, read on where reading ended.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

use serde_json::{Map, Value, json};

/// Most bytes that are read at a time; what is left comes with the next call.
const MAX_BYTES: u64 = 256 << 20;
/// Most columns; files of runs have a few dozen.
const MAX_COLUMNS: usize = 500;

/// Columns of numbers. Where a row has none, there is NaN.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Bytes read so far: whole lines.
    offset: u64,
    rows: usize,
    columns: Vec<(String, Vec<f64>)>,
}

impl Columns {
    /// Reads the lines that came since; numbers in tables inside a line are columns named as `energies.bending`.
    ///
    /// # Errors
    /// A line that is not JSON, a refusal of the system.
    pub(super) fn read_json_lines(&mut self, path: &Path) -> Result<(), String> {
        self.read(path, |columns, line| {
            let value: Value = serde_json::from_slice(line).map_err(|error| error.to_string())?;
            let object = value.as_object().ok_or("it is no table")?;
            for (key, value) in object {
                match value {
                    Value::Number(_) => columns.put(key, value.as_f64()),
                    Value::Bool(value) => columns.put(key, Some(f64::from(u8::from(*value)))),
                    Value::Object(inner) => {
                        for (name, value) in inner {
                            columns.put(&format!("{key}.{name}"), value.as_f64());
                        }
                    }
                    _ => {}
                }
            }
            columns.rows += 1;
            Ok(())
        })
    }

    /// Reads the rows that came since; the first line has the names.
    ///
    /// # Errors
    /// A row of another length, a refusal of the system.
    pub(super) fn read_csv(&mut self, path: &Path) -> Result<(), String> {
        self.read(path, |columns, line| {
            let line = str::from_utf8(line).map_err(|error| error.to_string())?;
            let words: Vec<&str> = line.trim_end().split(',').collect();
            if columns.columns.is_empty() {
                columns.columns = (words.iter().take(MAX_COLUMNS))
                    .map(|name| ((*name).to_owned(), Vec::new()))
                    .collect();
                return Ok(());
            }
            if words.len() < columns.columns.len() {
                return Err(format!("it has {} values", words.len()));
            }
            for ((_, values), word) in columns.columns.iter_mut().zip(words) {
                values.push(word.parse().unwrap_or(f64::NAN));
            }
            columns.rows += 1;
            Ok(())
        })
    }

    /// One list a column; what is not finite is null.
    pub(super) fn to_json(&self) -> Value {
        let columns = self.columns.iter().map(|(name, values)| {
            // A column that later rows lack ends early.
            let missing = self.rows - values.len().min(self.rows);
            let values = values
                .iter()
                .copied()
                .chain(std::iter::repeat_n(f64::NAN, missing));
            (name.clone(), json!(values.collect::<Vec<f64>>()))
        });
        Value::Object(columns.collect::<Map<_, _>>())
    }

    fn put(&mut self, name: &str, value: Option<f64>) {
        let found = self.columns.iter().position(|(known, _)| known == name);
        let index = match found {
            Some(index) => index,
            None if self.columns.len() == MAX_COLUMNS => return,
            None => {
                self.columns.push((name.to_owned(), Vec::new()));
                self.columns.len() - 1
            }
        };
        let values = &mut self.columns[index].1;
        values.resize(self.rows, f64::NAN);
        values.push(value.unwrap_or(f64::NAN));
    }

    /// Hands on the lines that are complete. A file that became shorter is another one, read from its start.
    fn read(
        &mut self,
        path: &Path,
        mut take: impl FnMut(&mut Self, &[u8]) -> Result<(), String>,
    ) -> Result<(), String> {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let mut file = match File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                *self = Self::default();
                return Ok(());
            }
            Err(error) => return Err(named(&error)),
        };
        let metadata = file.metadata().map_err(|error| named(&error))?;
        if !metadata.is_file() {
            return Err(named(&"it is not a regular file"));
        }
        if metadata.len() < self.offset {
            *self = Self::default();
        }
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(self.offset))
            .map_err(|error| named(&error))?;
        let mut file = file.take(MAX_BYTES);
        file.read_to_end(&mut bytes)
            .map_err(|error| named(&error))?;
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            if !line.ends_with(b"\n") {
                break;
            }
            take(self, line)
                .map_err(|error| format!("{} in row {}", named(&error), self.rows + 1))?;
            self.offset += line.len() as u64;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn lines_are_read_as_they_come_and_only_whole_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stats.jsonl");
        let mut columns = Columns::default();
        columns.read_json_lines(&path).unwrap();
        assert_eq!(columns.to_json(), json!({}));
        fs::write(
            &path,
            "{\"time\":1,\"energies\":{\"a\":2},\"converged\":true}\n{\"time\":",
        )
        .unwrap();
        columns.read_json_lines(&path).unwrap();
        let one = json!({ "time": [1.0], "energies.a": [2.0], "converged": [1.0] });
        assert_eq!(columns.to_json(), one);
        let text = "{\"time\":1,\"energies\":{\"a\":2},\"converged\":true}\n{\"time\":2,\"min_gap\":null,\"kappa\":3}\n";
        fs::write(&path, text).unwrap();
        columns.read_json_lines(&path).unwrap();
        let two = json!({
            "time": [1.0, 2.0], "energies.a": [2.0, null], "converged": [1.0, null], "kappa": [null, 3.0]
        });
        assert_eq!(columns.to_json(), two);
        // Shorter: a run that began anew.
        fs::write(&path, "{\"time\":5}\n").unwrap();
        columns.read_json_lines(&path).unwrap();
        assert_eq!(columns.to_json(), json!({ "time": [5.0] }));
    }

    #[test]
    fn probes_have_a_column_each_and_damage_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("probes.csv");
        fs::write(&path, "time,tip.x\n0,1.5\n0.1,NaN\n").unwrap();
        let mut columns = Columns::default();
        columns.read_csv(&path).unwrap();
        assert_eq!(
            columns.to_json(),
            json!({ "time": [0.0, 0.1], "tip.x": [1.5, null] })
        );
        fs::write(&path, "time,tip.x\n0,1.5\n0.1,NaN\n7\n").unwrap();
        assert!(columns.read_csv(&path).unwrap_err().contains("in row 3"));
        let stats = folder.path().join("stats.jsonl");
        fs::write(&stats, "[1]\n").unwrap();
        assert!(Columns::default().read_json_lines(&stats).is_err());
    }
}
