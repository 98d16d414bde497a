//! What is validated: scenes, what is read off them, and published values.

/// A published problem.
pub(super) struct Case {
    /// What it is asked for by.
    pub(super) name: &'static str,
    /// One line.
    pub(super) title: &'static str,
    /// The text of its scene.
    pub(super) scene: &'static str,
    /// What is set in it, as by `--set`.
    pub(super) set: &'static [&'static str],
    /// The key that refines the mesh.
    pub(super) cells_key: &'static str,
    /// Its values, a number or a list: each level halves the cells of the one before.
    pub(super) levels: &'static [&'static [usize]],
    /// What is asked of the scene.
    pub(super) question: Question,
    /// Published values: a table with a heading.
    pub(super) table: &'static str,
    /// What the figures of the finest mesh may be off by; along a path at every point, over its largest reference.
    pub(super) tolerance: f64,
    /// Whether the extrapolated figure will do: where triangles of constant strain converge slowly.
    pub(super) by_extrapolation: bool,
}

/// What is asked of a scene.
#[derive(Clone, Copy)]
pub(super) enum Question {
    /// Probes at the end: (column, factor, row of the table).
    End(&'static [(&'static str, f64, &'static str)]),
    /// Probes after every step, a row of the table each.
    Path {
        /// What the load is, with its unit, for figures.
        load: &'static str,
        /// Unit of what is compared.
        unit: &'static str,
        /// (column, factor, offset, side, column of the table).
        probes: &'static [(&'static str, f64, f64, Side, &'static str)],
    },
    /// Angular frequencies after `skipped` motions without resistance: rows of the table that begin with the name.
    Vibration {
        /// How many motions have no resistance.
        skipped: usize,
        /// The plate in the table.
        plate: &'static str,
    },
    /// The lowest buckling factor: a row of the table.
    Buckling(&'static str),
}

/// To which side a path goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// To that of the table.
    Known,
    /// What buckles may do so to either: the side of the end of the path counts as that of the table.
    Either,
}

/// A figure to compare.
pub(super) struct Quantity {
    pub(super) name: String,
    pub(super) reference: f64,
    /// Load and value, for a path.
    pub(super) curve: Vec<[f64; 2]>,
}

impl Case {
    /// The first key of the shell, such as `shell.plate`.
    pub(super) fn shell(&self) -> String {
        let mut parts = self.cells_key.splitn(3, '.');
        let mut next = || parts.next().unwrap_or_default();
        format!("{}.{}", next(), next())
    }

    /// What is compared, in order.
    pub(super) fn quantities(&self) -> Vec<Quantity> {
        let rows: Vec<Vec<&str>> = (self.table.lines().skip(1))
            .map(|line| line.split(',').collect())
            .collect();
        let named = |name: &str| {
            let row = rows.iter().find(|row| row[0] == name);
            number(row.unwrap_or_else(|| panic!("the table has a row '{name}'"))[1])
        };
        let single = |name: &str| Quantity {
            name: name.to_owned(),
            reference: named(name),
            curve: Vec::new(),
        };
        match self.question {
            Question::End(probes) => probes.iter().map(|(_, _, name)| single(name)).collect(),
            Question::Buckling(name) => vec![single(name)],
            Question::Vibration { plate, .. } => (rows.iter())
                .filter(|row| row[0] == plate)
                .map(|row| Quantity {
                    name: format!("{plate} {}", row[1]),
                    reference: number(row[2]),
                    curve: Vec::new(),
                })
                .collect(),
            Question::Path { probes, .. } => (probes.iter())
                .map(|(.., column)| self.path_quantity(&rows, column))
                .collect(),
        }
    }

    fn path_quantity(&self, rows: &[Vec<&str>], column: &str) -> Quantity {
        let heading = self.table.lines().next().unwrap_or_default();
        let at = heading.split(',').position(|name| name == column);
        let at = at.unwrap_or_else(|| panic!("the table has a column '{column}'"));
        let curve: Vec<[f64; 2]> = (rows.iter())
            .map(|row| [number(row[0]), number(row[at])])
            .collect();
        Quantity {
            name: column.to_owned(),
            reference: curve.last().map_or(f64::NAN, |point| point[1]),
            curve,
        }
    }
}

fn number(text: &str) -> f64 {
    text.parse().expect("tables hold numbers")
}
