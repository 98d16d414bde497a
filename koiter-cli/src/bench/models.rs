//! What each bending model costs: evaluations on one thread, and the nonzeros of its Hessian.

use std::sync::Arc;

use koiter::assembly::{HessianBuilder, Pattern, PatternBuilder, PsdProjection, SymmetricMatrix};
use koiter::mesh::Surface;
use koiter::scene::measure::{FreeBending, Measurement};
use koiter::scene::model::BendingModel;

use super::sheet::{POISSONS_RATIO, THICKNESS, YOUNGS_MODULUS, flat_sheet, posed_positions};
use super::table::{Cell, Table};
use super::{fastest, on_threads};
use crate::arguments::{ModelsArguments, bending_models};
use crate::failure::Failure;

/// Nonzeros of the bending Hessian over those of DS(θ): "Better Bending" (2026), Table 7, the scene Sphere Drape with
/// 26.7, 9.4 and 4.7 million.
const PUBLISHED_NONZEROS: [(&str, f64); 5] = [
    ("bac", 26.7 / 9.4),
    ("dcs", 26.7 / 9.4),
    ("dso", 26.7 / 9.4),
    ("ds-theta", 1.0),
    ("qb-pl", 4.7 / 9.4),
];

pub(super) fn bench(options: &ModelsArguments) -> Result<Table, Failure> {
    let models = bending_models(&options.models).map_err(Failure::input)?;
    let mut table = Table::new(
        "bending models: evaluation on one thread, and the Hessian's nonzeros",
        &[
            ("faces", "triangles"),
            ("bending", "bending"),
            ("energy_microseconds_per_face", "energy, µs a triangle"),
            ("gradient_microseconds_per_face", "gradient"),
            ("hessian_microseconds_per_face", "exact Hessian"),
            ("projected_microseconds_per_face", "projected Hessian"),
            ("hessian_nonzeros", "nonzeros"),
            ("nonzeros_to_ds_theta", "to ds-theta"),
            ("published_nonzeros_to_ds_theta", "published"),
        ],
    );
    for &faces in &options.faces {
        let sheet = flat_sheet(faces)?;
        let hinges = Costs::of(&sheet, BendingModel::DsTheta, 1)?.nonzeros;
        for &model in &models {
            let costs = Costs::of(&sheet, model, options.repeats)?;
            table.push(costs.row(sheet.mesh.num_faces(), model.info().name, hinges));
        }
    }
    Ok(table)
}

struct Costs {
    /// Seconds of the energy, with gradient, with exact Hessian, with projected Hessian.
    seconds: [f64; 4],
    nonzeros: usize,
}

impl Costs {
    fn of(sheet: &Surface, model: BendingModel, repeats: usize) -> Result<Self, Failure> {
        let deformed = Surface {
            mesh: sheet.mesh.clone(),
            positions: posed_positions(sheet),
        };
        let measurement = Measurement {
            deformed: &deformed,
            rest_positions: &sheet.positions,
            rest_curved: false,
            model,
            thickness: THICKNESS,
            youngs_modulus: YOUNGS_MODULUS,
            poissons_ratio: POISSONS_RATIO,
        };
        let mut bending = measurement.free_bending().map_err(Failure::run)?;
        on_threads(1, || Self::measure(&mut bending, repeats))
    }

    fn measure(bending: &mut FreeBending, repeats: usize) -> Self {
        let mut matrix = bound_matrix(bending);
        let value = fastest(repeats, || {
            let energies = bending.energies.iter();
            std::hint::black_box(energies.map(|e| e.value(&bending.q)).sum::<f64>());
        });
        let gradient = fastest(repeats, || {
            let mut gradient = vec![0.0; bending.q.len()];
            for energy in &bending.energies {
                energy.add_gradient(&bending.q, &mut gradient);
            }
            std::hint::black_box(gradient);
        });
        // The exact one last: its entries are counted.
        let projected = fastest(repeats, || {
            assemble(bending, &mut matrix, PsdProjection::Clamp)
        });
        let exact = fastest(repeats, || {
            assemble(bending, &mut matrix, PsdProjection::Exact)
        });
        Self {
            seconds: [value, gradient, exact, projected],
            nonzeros: nonzeros(&matrix),
        }
    }

    fn row(&self, faces: usize, name: &str, hinges: usize) -> Vec<Cell> {
        let per_face = |seconds: f64| Cell::Figure(seconds * 1e6 / faces as f64);
        let published = PUBLISHED_NONZEROS.iter().find(|(model, _)| *model == name);
        let mut row = vec![faces.into(), name.into()];
        row.extend(self.seconds.map(per_face));
        row.extend([
            self.nonzeros.into(),
            (self.nonzeros as f64 / hinges as f64).into(),
            published.map_or(Cell::Text("–".into()), |(_, ratio)| (*ratio).into()),
        ]);
        row
    }
}

/// Nonzeros of the Hessian of bending, of both triangles, at the positions and directors of a measurement.
pub(super) fn hessian_nonzeros(measurement: &Measurement<'_>) -> Result<usize, Failure> {
    let mut bending = measurement.free_bending().map_err(Failure::run)?;
    let mut matrix = bound_matrix(&mut bending);
    assemble(&bending, &mut matrix, PsdProjection::Exact);
    Ok(nonzeros(&matrix))
}

fn bound_matrix(bending: &mut FreeBending) -> SymmetricMatrix {
    let mut builder = PatternBuilder::default();
    for energy in &bending.energies {
        energy.add_to_pattern(&bending.q, &mut builder);
    }
    let pattern = Arc::new(Pattern::new(&bending.layout, &builder.finish()));
    for energy in &mut bending.energies {
        energy.bind(&pattern);
    }
    SymmetricMatrix::zeros(pattern)
}

fn assemble(bending: &FreeBending, matrix: &mut SymmetricMatrix, projection: PsdProjection) {
    matrix.values.fill(0.0);
    let mut gradient = vec![0.0; bending.q.len()];
    let mut coupling = vec![0.0; bending.q.len()];
    for energy in &bending.energies {
        let mut hessian = HessianBuilder {
            matrix: &mut *matrix,
            layout: &bending.layout,
            prescribed_step: &[],
            coupling: &mut coupling,
        };
        energy.add_derivatives(&bending.q, projection, &mut gradient, &mut hessian);
    }
    std::hint::black_box(gradient);
}

/// Entries of both triangles that are not zero: a matrix may store more, as where a model does not couple coordinates.
fn nonzeros(matrix: &SymmetricMatrix) -> usize {
    let on_diagonal = matrix.pattern.diagonal_positions().iter();
    let diagonal = on_diagonal
        .filter(|&&p| matrix.values[p as usize] != 0.0)
        .count();
    2 * matrix.values.iter().filter(|value| **value != 0.0).count() - diagonal
}
