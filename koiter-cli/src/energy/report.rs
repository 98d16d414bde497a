//! What was measured, for people and for scripts.

use koiter::Vec3;
use koiter::energy::bending::ExtraUnknowns;
use koiter::mesh::Surface;
use koiter::scene::measure::MeasuredShape;
use koiter::scene::model::BendingModel;
use serde_json::{Map, Value, json};

use super::director_file;

/// A bending model on the shape.
pub(super) struct Row {
    pub(super) model: BendingModel,
    /// Where its directors come from, in a word; empty for models without.
    pub(super) directors_from: &'static str,
    /// The shape, or why there is no energy.
    pub(super) shape: Result<MeasuredShape, String>,
}

/// A line a model; why one has no energy is said elsewhere.
pub(super) fn text(membrane: &MeasuredShape, rows: &[Row]) -> String {
    let mut lines = vec![
        "model       energy [J]    directors".to_owned(),
        format!("membrane    {:<12.6e}", membrane.energies().membrane),
    ];
    lines.extend(rows.iter().map(|row| {
        let name = row.model.info().name;
        match &row.shape {
            Ok(shape) => {
                // Without the sign of a zero.
                let energy = format!("{:.6e}", shape.energies().bending + 0.0);
                format!("{name:10}  {energy:<12}  {}", row.directors_from)
            }
            Err(_) => format!("{name:10}  {:<12}  not computed", "-"),
        }
    }));
    lines.join("\n")
}

/// One object; what there is not is null, with its reason.
pub(super) fn json(
    deformed: &Surface,
    membrane: &MeasuredShape,
    rows: &[Row],
    with_gradients: bool,
) -> Value {
    let mut stvk = json!({ "energy": membrane.energies().membrane });
    if with_gradients {
        stvk["gradient"] = points(&membrane.gradient().membrane);
    }
    let mut bending = Map::new();
    for row in rows {
        let entry = match &row.shape {
            Ok(shape) => measured(row, shape, deformed, with_gradients),
            Err(reason) if with_gradients => {
                json!({ "energy": null, "gradient": null, "reason": reason })
            }
            Err(reason) => json!({ "energy": null, "reason": reason }),
        };
        bending.insert(row.model.info().name.to_owned(), entry);
    }
    json!({ "membrane": { "stvk": stvk }, "bending": bending })
}

fn measured(row: &Row, shape: &MeasuredShape, deformed: &Surface, with_gradients: bool) -> Value {
    let measured = shape.energies();
    let unknowns = row.model.info().unknowns;
    let mut entry = json!({ "energy": measured.bending });
    if with_gradients {
        let gradient = shape.gradient();
        entry["gradient"] = points(&gradient.bending);
        if unknowns != ExtraUnknowns::None {
            entry["director_gradient"] = nodes(unknowns, &gradient.directors);
        }
    }
    if unknowns != ExtraUnknowns::None {
        entry["directors"] = director_file::json(unknowns, deformed, &measured.directors);
        entry["directors_from"] = json!(row.directors_from);
    }
    entry
}

fn points(points: &[Vec3]) -> Value {
    points.iter().map(|x| json!([x.x, x.y, x.z])).collect()
}

/// Values of nodes of one or three unknowns.
fn nodes(unknowns: ExtraUnknowns, values: &[f64]) -> Value {
    match unknowns.node_size() {
        1 => json!(values),
        _ => values.chunks_exact(3).map(|x| json!(x)).collect(),
    }
}
