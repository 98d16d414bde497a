//! How curves of bending models look, the same in all figures.

use koiter_render::{Marker, Series};

/// A curve of a model.
pub(super) fn series(model: &str, points: Vec<[f64; 2]>) -> Series {
    let (color, marker) = look(model);
    Series {
        name: model.to_owned(),
        points,
        color: Some(color),
        marker: Some(marker),
    }
}

/// Colours that stay apart for colour-blind people within each family (Okabe and Ito, 2008), and signs.
fn look(model: &str) -> ([u8; 3], Marker) {
    match model {
        "bac" => ([0, 114, 178], Marker::Circle),
        "dcs" => ([213, 94, 0], Marker::Square),
        "dso" => ([0, 158, 115], Marker::Triangle),
        "dkt" => ([204, 121, 167], Marker::Diamond),
        "me-average" => ([90, 90, 90], Marker::Cross),
        "ds-theta" => ([0, 114, 178], Marker::Circle),
        "ds-tan" => ([86, 180, 233], Marker::Plus),
        "ch-es" => ([213, 94, 0], Marker::Square),
        "ch-fs" => ([230, 159, 0], Marker::Diamond),
        "qb-cr" => ([90, 90, 90], Marker::Cross),
        "qb-pl" => ([0, 158, 115], Marker::Triangle),
        "qb-int" => ([204, 121, 167], Marker::TriangleDown),
        _ => ([150, 60, 60], Marker::TriangleDown),
    }
}

/// Whether a model discretises the Koiter energy; the others discretise the Squared Curvature energy.
pub(super) fn is_koiter(model: &str) -> bool {
    matches!(model, "bac" | "dcs" | "dso" | "dkt" | "me-average")
}
