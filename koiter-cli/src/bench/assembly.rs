//! Membrane and BAC bending: energy, gradient and projected Hessian into the assembled matrix.

use super::sheet::Sheet;
use super::table::Table;
use super::{fastest, on_threads, thread_counts};
use crate::arguments::SizeArguments;
use crate::failure::Failure;

pub(super) fn bench(options: &SizeArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "assembly of membrane and BAC: energy, gradient and projected Hessian into the matrix",
        &[
            ("faces", "triangles"),
            ("threads", "threads"),
            ("seconds", "s"),
            ("microseconds_per_face", "µs a triangle"),
            ("energy_microseconds_per_face", "energy only, µs"),
            ("gradient_microseconds_per_face", "with gradient, µs"),
            ("speedup", "speed-up"),
        ],
    );
    for &faces in &options.faces {
        let mut sheet = Sheet::new(faces)?;
        let mut single = None;
        for threads in thread_counts() {
            let [full, value, gradient] = on_threads(threads, || {
                let full = fastest(options.repeats, || {
                    sheet.assemble();
                });
                let value = fastest(options.repeats, || {
                    for energy in &sheet.energies {
                        std::hint::black_box(energy.value(&sheet.q));
                    }
                });
                let gradient = fastest(options.repeats, || {
                    let mut gradient = vec![0.0; sheet.q.len()];
                    for energy in &sheet.energies {
                        energy.add_gradient(&sheet.q, &mut gradient);
                    }
                    std::hint::black_box(gradient);
                });
                [full, value, gradient]
            })?;
            let per_face = |seconds: f64| seconds * 1e6 / sheet.num_faces as f64;
            let single = *single.get_or_insert(full);
            table.push([
                sheet.num_faces.into(),
                threads.into(),
                full.into(),
                per_face(full).into(),
                per_face(value).into(),
                per_face(gradient).into(),
                (single / full).into(),
            ]);
        }
    }
    Ok(table)
}
