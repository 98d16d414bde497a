//! Contact of a sheet folded to a stack of eight layers, one and a half millimetres apart, that collapses.

use koiter::Vec3;
use koiter::assembly::{
    DofLayout, Energy, HessianBuilder, Pattern, PatternBuilder, PsdProjection, SymmetricMatrix,
};
use koiter::contact::{CollisionBody, CollisionMesh, Contact};
use koiter::mesh::Surface;
use koiter::mesh::generate::{GridDiagonals, grid};

use super::table::{Cell, Table};
use super::{fastest, on_threads, thread_counts};
use crate::arguments::SizeArguments;
use crate::failure::Failure;

/// Layers of the stack.
const LAYERS: f64 = 8.0;
/// Distance of layers [m].
const SPACING: f64 = 1.5e-3;
/// Gap at which the barrier begins [m].
const D_HAT: f64 = 2e-3;
/// The share of each layer in which it rises to the next.
const RISE: f64 = 0.25;

pub(super) fn bench(options: &SizeArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "contact of a folded stack: barrier reach 2 mm, layers 1.5 mm apart, a step that collapses it",
        &[
            ("faces", "triangles"),
            ("threads", "threads"),
            ("static_seconds", "broad phase, s"),
            ("swept_seconds", "swept, s"),
            ("candidates", "candidates"),
            ("ccd_million_per_second", "ACCD, M/s"),
            ("active", "contacts"),
            ("active_set_seconds", "active set, s"),
            ("value_microseconds", "energy, µs"),
            ("gradient_microseconds", "gradient, µs"),
            ("hessian_microseconds", "Hessian, µs"),
            ("projected_microseconds", "projected, µs"),
        ],
    );
    for &faces in &options.faces {
        let cells = ((faces as f64 / 2.0).sqrt().round() as usize).max(1);
        let sheet = grid(1.0, 1.0, cells, cells, GridDiagonals::Checkerboard)
            .map_err(|error| Failure::input(error.to_string()))?;
        let mut stack = Stack::new(&sheet);
        for threads in thread_counts() {
            let row = on_threads(threads, || stack.measure(options.repeats))?;
            let count: [Cell; 2] = [sheet.mesh.num_faces().into(), threads.into()];
            table.push(count.into_iter().chain(row));
        }
    }
    Ok(table)
}

struct Stack {
    layout: DofLayout,
    contact: Contact,
    q: Vec<f64>,
    /// The motion that collapses the stack.
    step: Vec<f64>,
}

impl Stack {
    fn new(sheet: &Surface) -> Self {
        let mut layout = DofLayout::new();
        let first_dof = layout.push_nodes(sheet.mesh.num_vertices(), 3, true);
        let body = CollisionBody {
            name: "stack".into(),
            first_dof,
            num_vertices: sheet.mesh.num_vertices(),
            edges: sheet.mesh.edges().to_vec(),
            faces: sheet.mesh.faces().to_vec(),
            rest_positions: sheet.positions.clone(),
            offset: 0.0,
            is_obstacle: false,
            friction: 0.0,
        };
        let mesh = CollisionMesh::new(vec![body]);
        let contact = Contact::new(mesh, vec![], layout.clone(), D_HAT, 1.0);
        let q: Vec<f64> = (sheet.positions.iter()).flat_map(folded).collect();
        let step = (0..q.len())
            .map(|i| if i % 3 == 2 { -0.9 * q[i] } else { 0.0 })
            .collect();
        Self {
            layout,
            contact,
            q,
            step,
        }
    }

    fn measure(&mut self, repeats: usize) -> [Cell; 10] {
        let (contact, q, step) = (&mut self.contact, &self.q, &self.step);
        let at_rest = fastest(repeats, || contact.prepare(q));
        let mut candidates = None;
        let swept = fastest(repeats, || candidates = contact.count_candidates(q, step));
        let candidates = candidates.unwrap_or(0);
        contact.find_candidates(q, step);
        let (x, dx) = (contact.positions(q), contact.positions(step));
        let ccd = fastest(repeats, || {
            std::hint::black_box(contact.approaches(&x, &dx));
        });
        contact.prepare(q);
        let refresh = fastest(repeats, || contact.refresh(q));
        let active = contact.statistics().contacts;
        let per_contact = |seconds: f64| Cell::Figure(seconds * 1e6 / active.max(1) as f64);
        let value = fastest(repeats, || {
            std::hint::black_box(contact.value(q));
        });
        let gradient = fastest(repeats, || {
            contact.add_gradient(q, &mut vec![0.0; q.len()]);
        });
        let mut builder = PatternBuilder::default();
        contact.add_to_pattern(q, &mut builder);
        let mut matrix =
            SymmetricMatrix::zeros(Pattern::new(&self.layout, &builder.finish()).into());
        let [exact, projected] = [PsdProjection::Exact, PsdProjection::Clamp].map(|projection| {
            fastest(repeats, || {
                let mut hessian = HessianBuilder {
                    matrix: &mut matrix,
                    layout: &self.layout,
                    prescribed_step: &[],
                    coupling: &mut [],
                };
                contact.add_derivatives(q, projection, &mut vec![0.0; q.len()], &mut hessian);
            })
        });
        [
            at_rest.into(),
            swept.into(),
            candidates.into(),
            (candidates as f64 / ccd / 1e6).into(),
            active.into(),
            refresh.into(),
            per_contact(value),
            per_contact(gradient),
            per_contact(exact),
            per_contact(projected),
        ]
    }
}

/// A point of the unit square on the folded stack.
fn folded(x: &Vec3) -> [f64; 3] {
    let along = (x.x + 0.5) * LAYERS;
    let layer = along.floor().min(LAYERS - 1.0);
    let part = along - layer;
    let forward = layer % 2.0 == 0.0;
    let across = if forward { part } else { 1.0 - part } / LAYERS;
    let rise = ((part - (1.0 - RISE)) / RISE).max(0.0);
    [across, x.y, SPACING * (layer + rise * rise)]
}
