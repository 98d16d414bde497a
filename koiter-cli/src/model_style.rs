//! How curves of bending models look, the same in all figures.

use koiter::scene::model::BendingModel;
use koiter_render::{Line, Marker, Series};

/// A curve of a model.
pub(crate) fn series(model: BendingModel, points: Vec<[f64; 2]>) -> Series {
    let look = LOOKS.iter().find(|look| look.0 == model);
    let (_, color, marker) = look.expect("a test finds all models here");
    Series {
        name: model.info().name.to_owned(),
        points,
        color: Some(*color),
        marker: Some(*marker),
        ..Series::default()
    }
}

/// What was published, beside the curves: rings, through which they are seen.
pub(crate) fn published(points: Vec<[f64; 2]>) -> Series {
    Series {
        name: "published".to_owned(),
        points,
        color: Some([0; 3]),
        marker: Some(Marker::Ring),
        line: Line::None,
    }
}

/// A colour for each model, and a sign that no other model of its smooth energy has. Colours of Okabe and Ito (2008) for
/// the models that converge, of Tol (2021) for the others: colour-blind people tell them apart, with the signs.
const LOOKS: [(BendingModel, [u8; 3], Marker); 13] = [
    (BendingModel::Bac, [0, 114, 178], Marker::Circle),
    (BendingModel::Dcs, [213, 94, 0], Marker::Square),
    (BendingModel::Dso, [0, 158, 115], Marker::Triangle),
    (BendingModel::Dkt, [204, 121, 167], Marker::Diamond),
    (BendingModel::MeAverage, [90, 90, 90], Marker::Cross),
    (BendingModel::DsTheta, [51, 34, 136], Marker::Plus),
    (BendingModel::DsTan, [86, 180, 233], Marker::Cross),
    (BendingModel::ChEs, [136, 34, 85], Marker::Square),
    (BendingModel::ChFs, [230, 159, 0], Marker::Diamond),
    (BendingModel::QbCr, [153, 153, 51], Marker::TriangleDown),
    (BendingModel::QbPl, [204, 51, 17], Marker::Star),
    (BendingModel::QbInt, [68, 170, 153], Marker::Circle),
    (BendingModel::Ds2nd, [150, 110, 70], Marker::Triangle),
];

#[cfg(test)]
mod tests {
    use super::*;
    use koiter::scene::measure::shapes::SmoothEnergy;

    #[test]
    fn every_model_has_a_colour_and_in_its_panel_a_sign_of_its_own() {
        let bending = (BendingModel::ALL.into_iter()).filter(|model| *model != BendingModel::None);
        for model in bending {
            assert_eq!(
                LOOKS.iter().filter(|look| look.0 == model).count(),
                1,
                "{model:?}"
            );
        }
        for (k, (model, color, marker)) in LOOKS.iter().enumerate() {
            for (other, other_color, other_marker) in &LOOKS[..k] {
                assert_ne!(color, other_color, "{model:?} {other:?}");
                let shared = SmoothEnergy::of(*model) == SmoothEnergy::of(*other);
                assert!(!shared || marker != other_marker, "{model:?} {other:?}");
            }
        }
    }
}
