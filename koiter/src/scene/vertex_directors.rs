//! Shells that bend with directors at their vertices.

use nalgebra::Vector3;

use super::assemble::write_points;
use super::elastic::{HeldDirectors, rest_surface};
use super::model::Shell;
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout, Energy};
use crate::energy::bending::{DiscreteKirchhoff, vertex_normals};
use crate::integrate::{ShellPart, relax_directors};
use crate::mesh::Surface;
use crate::rest::RestError;

/// Bending with vertex directors: finds the rest directors where the rest shape is curved, relaxes the directors of the
/// start shape in `q`, and adds their inertia.
pub(super) fn kirchhoff_bending(
    shell: &Shell,
    part: &mut ShellPart,
    held: &HeldDirectors<'_>,
    layout: &DofLayout,
    q: &mut [f64],
    masses: &mut [f64],
) -> Result<Box<dyn Energy>, RestError> {
    add_inertia(shell, part, masses);
    let num_faces = part.mesh.num_faces();
    let prescribed = part.rest_forms.clone();
    let mut energy = Assembled::new(
        DiscreteKirchhoff::new(
            &part.mesh,
            part.first_vertex,
            part.first_extra,
            part.frames.clone(),
            vec![[Vector3::zeros(); 3]; num_faces],
            part.section.clone(),
        ),
        layout,
    );
    let directors = part.extra_dofs();
    if shell.rest_curved {
        let rest = rest_surface(shell);
        let mut rest_q = q.to_vec();
        write_points(&mut rest_q, part.first_vertex, &rest.positions);
        write_points(&mut rest_q, part.first_extra, &vertex_normals(&rest));
        let held_at_rest = held(part, &rest_q);
        relax_directors(
            &mut energy,
            layout,
            directors.clone(),
            &held_at_rest,
            &mut rest_q,
        )?;
        let forms: Vec<[Vector3<f64>; 3]> = (0..num_faces)
            .map(|f| {
                let of_shape = energy.local().second_forms(f, &energy.gather(f, &rest_q));
                of_shape.map(|form| form + prescribed[f])
            })
            .collect();
        part.rest_forms = forms.iter().map(|f| (f[0] + f[1] + f[2]) / 3.0).collect();
        energy.local_mut().set_rest_forms(forms);
        if shell.surface.positions == shell.rest_positions && !shell.has_prescribed_curvature() {
            // The exact minimum, round-off included.
            q[directors.clone()].copy_from_slice(&rest_q[directors]);
            return Ok(Box::new(energy));
        }
    } else {
        let forms = prescribed.iter().map(|form| [*form; 3]).collect();
        energy.local_mut().set_rest_forms(forms);
    }
    let start = Surface {
        mesh: part.mesh.clone(),
        positions: shell.surface.positions.clone(),
    };
    write_points(q, part.first_extra, &vertex_normals(&start));
    relax_directors(&mut energy, layout, directors, &held(part, q), q)
        .map_err(RestError::of_shape_itself)?;
    Ok(Box::new(energy))
}

/// ρ h³/12 times a third of the rest area of the faces around: the kinetic energy of `h³/12 ∫ ρ |ḋ|²`, lumped.
fn add_inertia(shell: &Shell, part: &ShellPart, masses: &mut [f64]) {
    for (face, frame) in part.frames.iter().enumerate() {
        let scale = shell.face_density(face) * shell.face_thickness(face).powi(3) / 12.0;
        for v in part.mesh.faces()[face] {
            let start = (part.first_extra.0 + 3 * v) as usize;
            for mass in &mut masses[start..start + 3] {
                *mass += scale * frame.area / 3.0;
            }
        }
    }
}

/// The director of a clamped vertex: it keeps the direction it has when the clamp begins, turned with its motion.
#[derive(Clone)]
pub(super) struct HeldDirector {
    /// The director.
    pub(super) dof: Dof,
    /// Index of the constraint.
    pub(super) constraint: usize,
    /// When the clamp begins.
    pub(super) start: Vec3,
}

impl HeldDirector {
    pub(super) fn new(constraint: usize, dof: Dof, q: &[f64]) -> Self {
        let start = Self::read(dof, q);
        Self {
            dof,
            constraint,
            start,
        }
    }

    /// The clamp begins at `q`.
    pub(super) fn begin(&mut self, q: &[f64]) {
        self.start = Self::read(self.dof, q);
    }

    fn read(dof: Dof, q: &[f64]) -> Vec3 {
        let start = dof.0 as usize;
        Vec3::from_column_slice(&q[start..start + 3]).normalize()
    }
}
