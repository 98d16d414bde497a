//! `[[procedure]]`: what is done to Bézier shells at a time: cuts, pulls on lips, patches, sutures.

use schemars::JsonSchema;
use serde::Deserialize;

use super::SelectSpec;

/// `[[procedure]]`: exactly one of `cut`, `open`, `patch`, `close` and `sew`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProcedureSpec {
    /// Name, unique among the procedures.
    pub name: String,
    /// When it is done [s]: at the start of the first step that begins then or later.
    pub at: f64,
    /// A shell is cut along a path.
    #[serde(default)]
    pub cut: Option<CutSpec>,
    /// The lips of a cut are pulled apart.
    #[serde(default)]
    pub open: Option<OpenSpec>,
    /// A flat patch in the shape of a lens is sewn between the lips of a cut.
    #[serde(default)]
    pub patch: Option<PatchSpec>,
    /// The lips of a cut are sewn together.
    #[serde(default)]
    pub close: Option<CloseSpec>,
    /// Two rows of vertices are sewn together.
    #[serde(default)]
    pub sew: Option<SewSpec>,
}

/// `cut`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CutSpec {
    /// The shell.
    pub shell: String,
    /// Points of the start shape [m], two or more: from each to the next the cut follows the surface.
    pub path: Vec<[f64; 3]>,
}

/// `open`: forces that keep the directions they have when they begin.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpenSpec {
    /// Name of the procedure that made the cut.
    pub cut: String,
    /// Force on each vertex of a lip, in the surface, away from the other lip [N].
    pub force: f64,
    /// Force on each vertex of a lip along the normal [N].
    #[serde(default)]
    pub lift: f64,
    /// How long the force grows [s].
    #[serde(default)]
    pub ramp: f64,
    /// When it ends [s].
    pub until: f64,
}

/// `patch`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatchSpec {
    /// Name of the procedure that made the cut.
    pub cut: String,
    /// Width in the middle [m].
    pub width: f64,
    /// Elements from lip to lip.
    #[serde(default = "six")]
    pub across: usize,
    /// Young's modulus [Pa]; default: that of the shell that was cut.
    #[serde(default)]
    pub young: Option<f64>,
    /// Thickness [m]; default: that of the shell that was cut.
    #[serde(default)]
    pub thickness: Option<f64>,
}

/// `close`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CloseSpec {
    /// Name of the procedure that made the cut.
    pub cut: String,
}

/// `sew`: every vertex of the first row is joined with the nearest of the second.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SewSpec {
    /// The first row.
    pub first: RowSpec,
    /// The second row.
    pub second: RowSpec,
    /// How far apart two vertices may be that are joined [m].
    pub reach: f64,
}

/// Vertices of a shell.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RowSpec {
    /// The shell.
    pub shell: String,
    /// Which vertices.
    pub select: SelectSpec,
}

fn six() -> usize {
    6
}

impl ProcedureSpec {
    /// The keys that say what is done: exactly one in a sound scene.
    pub fn given_kinds(&self) -> Vec<&'static str> {
        [
            ("cut", self.cut.is_some()),
            ("open", self.open.is_some()),
            ("patch", self.patch.is_some()),
            ("close", self.close.is_some()),
            ("sew", self.sew.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
    }

    /// The cut that it needs.
    pub(in crate::scene) fn needed_cut(&self) -> Option<&str> {
        let open = self.open.as_ref().map(|open| &open.cut);
        let patch = self.patch.as_ref().map(|patch| &patch.cut);
        let close = self.close.as_ref().map(|close| &close.cut);
        open.or(patch).or(close).map(String::as_str)
    }
}
