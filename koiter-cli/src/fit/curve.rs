//! A measured curve: a CSV file of what probes would say over time, or of natural frequencies.

use std::path::Path;

use koiter::io::{MAX_SCENE_BYTES, read_bounded};

use crate::failure::Failure;

/// What was measured.
#[derive(Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) kind: CurveKind,
    /// Times [s], or numbers of modes from 1.
    pub(super) places: Vec<f64>,
    /// Name of each column, and a value a place.
    pub(super) columns: Vec<(String, Vec<f64>)>,
}

/// What the first column counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CurveKind {
    /// Time; the other columns are columns of probes.
    OverTime,
    /// Modes; the other column is their frequency [Hz].
    Frequencies,
}

impl Curve {
    /// Reads the file.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
        let bytes = read_bounded(path, MAX_SCENE_BYTES)
            .map_err(|error| wrong(format!("cannot read the curve: {error}")))?;
        let text = String::from_utf8(bytes).map_err(|_| wrong("it is not a text".to_owned()))?;
        Self::parse(&text).map_err(|what| {
            wrong(what).with_help(
                "write a line of headings, time,PROBE or mode,frequency, and a line of numbers a measurement",
            )
        })
    }

    fn parse(text: &str) -> Result<Self, String> {
        let lines = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (_, heading) = lines.next().ok_or("it is empty")?;
        let names: Vec<&str> = heading.split(',').map(str::trim).collect();
        let kind = match names[..] {
            ["time", _, ..] => CurveKind::OverTime,
            ["mode", "frequency"] => CurveKind::Frequencies,
            _ => return Err(format!("its headings are '{heading}'")),
        };
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (number, line) in lines {
            let values: Option<Vec<f64>> = (line.split(','))
                .map(|word| {
                    word.trim()
                        .parse()
                        .ok()
                        .filter(|value: &f64| value.is_finite())
                })
                .collect();
            let values = values.filter(|values| values.len() == names.len());
            let expected = names.len();
            rows.push(values.ok_or(format!("line {number} is not {expected} finite numbers"))?);
        }
        if rows.is_empty() {
            return Err("it has no measurements".to_owned());
        }
        let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
        let places = column(0);
        let is_mode = |place: &f64| (1.0..=1000.0).contains(place) && place.fract() == 0.0;
        if kind == CurveKind::Frequencies && !places.iter().all(is_mode) {
            return Err("modes are counted 1, 2, 3, …".to_owned());
        }
        let named = names.iter().enumerate().skip(1);
        Ok(Self {
            kind,
            places,
            columns: named
                .map(|(index, name)| ((*name).to_owned(), column(index)))
                .collect(),
        })
    }

    /// Number of measured values.
    pub(super) fn len(&self) -> usize {
        self.places.len() * self.columns.len()
    }

    /// What each column is divided by, so that columns of different units count alike: its largest value.
    pub(super) fn scales(&self) -> Vec<f64> {
        let largest =
            |values: &Vec<f64>| values.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        let scales = self.columns.iter().map(|(_, values)| largest(values));
        scales
            .map(|scale| if scale > 0.0 { scale } else { 1.0 })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_headings_and_finite_numbers() {
        let curve = Curve::parse("# a test\ntime, tip.z\n0.5, -1e-2\n\n1.0,-2e-2\n").unwrap();
        assert_eq!(
            (curve.kind, &curve.places[..]),
            (CurveKind::OverTime, &[0.5, 1.0][..])
        );
        assert_eq!(curve.columns, [("tip.z".to_owned(), vec![-1e-2, -2e-2])]);
        assert_eq!(curve.scales(), [2e-2]);
        let modes = Curve::parse("mode,frequency\n1,3.5\n2,22").unwrap();
        assert_eq!((modes.kind, modes.len()), (CurveKind::Frequencies, 2));
        for (text, said) in [
            ("", "empty"),
            ("time\n1", "headings"),
            ("x,y\n1,2", "headings"),
            ("time,a\n", "no measurements"),
            ("time,a\n1", "line 2"),
            ("time,a\n1,nan", "line 2"),
            ("mode,frequency\n0,1", "counted"),
        ] {
            let error = Curve::parse(text).unwrap_err();
            assert!(error.contains(said), "{text:?}: {error}");
        }
    }
}
