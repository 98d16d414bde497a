//! What is to be said of each bending model.

use super::model::BendingModel;
use crate::energy::bending::ExtraUnknowns;

/// A bending model in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BendingModelInfo {
    /// Name in scene files.
    pub name: &'static str,
    /// What it is, in a line.
    pub what: &'static str,
    /// What it has as unknowns beside the positions of the vertices.
    pub unknowns: ExtraUnknowns,
    /// A key of docs/references.bib, and the equation; empty for the absence of a model.
    pub source: &'static str,
}

impl BendingModel {
    /// All models.
    pub const ALL: [Self; 14] = [
        Self::Bac,
        Self::Dcs,
        Self::Dso,
        Self::Dkt,
        Self::Ds2nd,
        Self::MeAverage,
        Self::DsTheta,
        Self::DsTan,
        Self::ChEs,
        Self::ChFs,
        Self::QbCr,
        Self::QbPl,
        Self::QbInt,
        Self::None,
    ];

    /// What is to be said of the model.
    pub fn info(self) -> BendingModelInfo {
        match self {
            Self::Bac => BendingModelInfo {
                name: "bac",
                what: "Bending-Active Cosserat: directors on edges, tangent profile; converges, and folds never close",
                unknowns: ExtraUnknowns::EdgeAngles,
                source: "better-bending-2026, Eq. 48",
            },
            Self::Dcs => BendingModelInfo {
                name: "dcs",
                what: "Discrete Cosserat shell: directors on edges, sine profile; converges, sharp folds lose their stiffness",
                unknowns: ExtraUnknowns::EdgeAngles,
                source: "better-bending-2026, Eq. 31, after weischedel-2012",
            },
            Self::Dso => BendingModelInfo {
                name: "dso",
                what: "Discrete shape operator: directors on edges, profile the angle itself; converges",
                unknowns: ExtraUnknowns::EdgeAngles,
                source: "better-bending-2026, Eq. 34, after grinspun-2006",
            },
            Self::Dkt => BendingModelInfo {
                name: "dkt",
                what: "Discrete Kirchhoff triangle: directors on vertices; converges, accurate on coarse meshes too, not for sharp folds",
                unknowns: ExtraUnknowns::VertexDirectors,
                source: "better-bending-2026, Eq. 28, after batoz-1980",
            },
            Self::Ds2nd => BendingModelInfo {
                name: "ds-2nd",
                what: "Second-order discrete shells: quadratic patches; for study only: its energy is wrong and depends on the mesh and on a barrier",
                unknowns: ExtraUnknowns::EdgePoints,
                source: "better-bending-2026, Eq. 21, after le-2023",
            },
            Self::MeAverage => BendingModelInfo {
                name: "me-average",
                what: "Averaged mid-edge normals: positions only, any material; converges on aligned regular meshes only",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 36, after chen-2018",
            },
            Self::DsTheta => BendingModelInfo {
                name: "ds-theta",
                what: "Discrete Shells hinge, quadratic in the angle: cheap, the familiar baseline; does not converge",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 7, after grinspun-2003",
            },
            Self::DsTan => BendingModelInfo {
                name: "ds-tan",
                what: "Discrete Shells hinge, tangent of the half angle: hinges never close; does not converge",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 8, after tamstorf-2013",
            },
            Self::ChEs => BendingModelInfo {
                name: "ch-es",
                what: "Corotational hinge, curvature of edges: converges on aligned regular meshes only",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 9, after liang-2025",
            },
            Self::ChFs => BendingModelInfo {
                name: "ch-fs",
                what: "Corotational hinge, curvatures of faces: converges on aligned regular meshes only",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 13, after liang-2025",
            },
            Self::QbCr => BendingModelInfo {
                name: "qb-cr",
                what: "Quadratic bending of hinges: constant Hessian, fewest entries; flat rest shapes; does not converge",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 15, after bergou-2006",
            },
            Self::QbPl => BendingModelInfo {
                name: "qb-pl",
                what: "Quadratic bending of vertices: constant Hessian; flat rest shapes; close on good meshes, buckles early",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 39, after bergou-2006, stein-2018",
            },
            Self::QbInt => BendingModelInfo {
                name: "qb-int",
                what: "Quadratic bending of vertices, intrinsic Delaunay Laplacian: as qb-pl, also on bad meshes",
                unknowns: ExtraUnknowns::None,
                source: "better-bending-2026, Eq. 39, after sharp-2020",
            },
            Self::None => BendingModelInfo {
                name: "none",
                what: "no bending energy: a pure membrane",
                unknowns: ExtraUnknowns::None,
                source: "",
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "serde")]
    #[test]
    fn names_are_those_of_scene_files_and_sources_are_in_the_bibliography() {
        let bibliography = include_str!("../../../docs/references.bib");
        for model in BendingModel::ALL {
            let info = model.info();
            assert_eq!(serde_json::to_value(model).unwrap(), info.name);
            for key in info
                .source
                .split(", ")
                .filter(|part| part.ends_with(char::is_numeric))
            {
                let key = key.trim_start_matches("after ");
                let is_equation = key.starts_with("Eq.");
                assert!(
                    is_equation || bibliography.contains(&format!("{{{key},")),
                    "{key}"
                );
            }
        }
        for preset in crate::material::presets::ALL {
            let (key, _) = preset.source.split_once(", ").unwrap();
            assert!(bibliography.contains(&format!("{{{key},")), "{key}");
        }
    }
}
