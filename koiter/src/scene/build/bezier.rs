//! From `[[bezier_shell]]` and `[[procedure]]` to what is stepped.

use super::{Builder, vertices};
use crate::Vec3;
use crate::bezier::{BezierError, BezierShell, Section, SurfacePath, SurfacePoint, smooth_normals};
use crate::mesh::VertexId;
use crate::scene::bezier::{BezierModel, BezierPart, FineSurface, Procedure, ProcedureKind};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::{Shell, SymmetryPlane};
use crate::scene::spec::{BezierShellSpec, PatchSpec, ProcedureSpec, RowSpec};

impl Builder<'_> {
    pub(super) fn bezier(&self) -> Result<Option<BezierModel>, SceneError> {
        let specs = &self.spec.bezier_shell;
        let Some(first) = specs.first() else {
            return Ok(None);
        };
        let shells = (specs.iter().map(|spec| self.bezier_shell(spec)))
            .collect::<Result<Vec<Shell>, _>>()?;
        let symmetry_planes = self.symmetry_planes(&shells)?;
        let constraints = self.constraints(&shells)?;
        let loads = self.loads(&shells)?;
        let procedures = self.spec.procedure.iter();
        let procedures = procedures.map(|spec| self.procedure(spec, &shells));
        let procedures = procedures.collect::<Result<Vec<_>, _>>()?;
        let mut parts = Vec::new();
        for (index, (spec, shell)) in specs.iter().zip(shells).enumerate() {
            parts.push(BezierPart {
                normals: normals(&shell, index, &symmetry_planes),
                surface: self.fine_surface(spec, &shell)?,
                shell,
            });
        }
        let model = BezierModel {
            parts,
            element: first.element,
            damping: first.damping,
            subdivide: first.surface.subdivide,
            constraints,
            symmetry_planes,
            loads,
            procedures,
        };
        check_cuts(&model)?;
        Ok(Some(model))
    }

    fn bezier_shell(&self, spec: &BezierShellSpec) -> Result<Shell, SceneError> {
        self.shell_at(&format!("bezier_shell.{}", spec.name), &spec.as_shell())
    }

    fn fine_surface(
        &self,
        spec: &BezierShellSpec,
        shell: &Shell,
    ) -> Result<FineSurface, SceneError> {
        let Some(mesh) = &spec.surface.mesh else {
            return Ok(FineSurface::Subdivided);
        };
        let path = format!("bezier_shell.{}.surface.mesh", spec.name);
        Ok(FineSurface::Bound {
            surface: Box::new(self.mesh(&path, mesh)?),
            reach: (spec.surface.reach).unwrap_or_else(|| shell.surface.mean_edge_length()),
        })
    }

    fn procedure(&self, spec: &ProcedureSpec, shells: &[Shell]) -> Result<Procedure, SceneError> {
        let path = format!("procedure.{}", spec.name);
        let at = |name: &str| {
            let mut all = self.spec.procedure.iter();
            all.position(|other| other.name == name).unwrap_or_default()
        };
        let kind = if let Some(cut) = &spec.cut {
            ProcedureKind::Cut {
                shell: self.shell_index(&format!("{path}.cut.shell"), &cut.shell)?,
                path: cut.path.iter().map(|x| Vec3::from(*x)).collect(),
            }
        } else if let Some(open) = &spec.open {
            ProcedureKind::Open {
                cut: at(&open.cut),
                force: open.force,
                lift: open.lift,
                ramp: open.ramp,
                until: open.until,
            }
        } else if let Some(patch) = &spec.patch {
            self.patch(patch, at(&patch.cut), shells)?
        } else if let Some(close) = &spec.close {
            ProcedureKind::Close {
                cut: at(&close.cut),
            }
        } else if let Some(sew) = &spec.sew {
            let row = |key: &str, row: &RowSpec| -> Result<(usize, Vec<VertexId>), SceneError> {
                let path = format!("{path}.sew.{key}");
                let shell = self.shell_index(&format!("{path}.shell"), &row.shell)?;
                let select = format!("{path}.select");
                Ok((shell, vertices(&select, &row.select, &shells[shell])?))
            };
            ProcedureKind::Sew {
                first: row("first", &sew.first)?,
                second: row("second", &sew.second)?,
                reach: sew.reach,
            }
        } else {
            return Err(SceneError::new(Kind::MissingKey, "nothing is to be done").inside(&path));
        };
        Ok(Procedure {
            name: spec.name.clone(),
            at: spec.at,
            kind,
        })
    }

    fn patch(
        &self,
        patch: &PatchSpec,
        cut: usize,
        shells: &[Shell],
    ) -> Result<ProcedureKind, SceneError> {
        let of_cut = self.spec.procedure[cut].cut.as_ref();
        let shell = of_cut.map_or(Ok(0), |cut| self.shell_index("procedure", &cut.shell))?;
        let shell = &shells[shell];
        Ok(ProcedureKind::Patch {
            cut,
            width: patch.width,
            across: patch.across,
            section: Section {
                youngs_modulus: patch.young.unwrap_or(shell.youngs_modulus),
                poissons_ratio: shell.poissons_ratio,
                thickness: patch.thickness.unwrap_or(shell.thickness),
                density: shell.density,
            },
        })
    }
}

/// Normals of the start shape; at a plane of symmetry they lie in it.
fn normals(shell: &Shell, index: usize, planes: &[SymmetryPlane]) -> Vec<Vec3> {
    let mut normals = smooth_normals(&shell.surface);
    for plane in planes.iter().filter(|plane| plane.shell == index) {
        for vertex in &plane.vertices {
            let normal = &mut normals[vertex.0 as usize];
            normal[plane.axis] = 0.0;
            *normal = normal.normalize();
        }
    }
    normals
}

/// Finds the first cut of each shell on its start shape, so that a path which cannot be is told before the run.
fn check_cuts(model: &BezierModel) -> Result<(), SceneError> {
    let mut is_cut = vec![false; model.parts.len()];
    for procedure in &model.procedures {
        let ProcedureKind::Cut { shell, path } = &procedure.kind else {
            // What is sewn may hold the path of a later cut.
            if matches!(procedure.kind, ProcedureKind::Open { .. }) {
                continue;
            }
            return Ok(());
        };
        if std::mem::replace(&mut is_cut[*shell], true) {
            continue;
        }
        let part = &model.parts[*shell];
        let refuse = |error: BezierError, path: &str| {
            SceneError::new(Kind::Mesh, error.to_string()).inside(path)
        };
        let options = model.options(part.section());
        let made = BezierShell::new(&part.shell.surface, &part.normals, options)
            .map_err(|error| refuse(error, &format!("bezier_shell.{}.mesh", part.shell.name)))?;
        try_cut(&made, path)
            .map_err(|error| refuse(error, &format!("procedure.{}.cut.path", procedure.name)))?;
    }
    Ok(())
}

fn try_cut(shell: &BezierShell, path: &[Vec3]) -> Result<(), BezierError> {
    let points = (path
        .iter()
        .map(|x| shell.nearest_within_an_edge(x, |_| true)))
    .collect::<Result<Vec<SurfacePoint>, _>>()?;
    shell.cut(&SurfacePath::through(
        shell,
        &shell.rest_pose().positions,
        &points,
    )?)?;
    Ok(())
}
