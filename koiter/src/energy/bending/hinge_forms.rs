//! Second fundamental forms of faces from the angles of their hinges, for display.
//!
//! ```text
//! D⁻ᵀ II D⁻¹,    II = [[q₀ + q₁, q₀], [q₀, q₀ + q₂]],    q_c = 2 a_c sin(θ_c/2)
//! ```
//!
//! a_c rest altitude over edge c [m], θ_c angle of its hinge [rad], 0 on the boundary: as with directors in the middle
//! between the normals ([`super::curvatures`]).

use nalgebra::Vector3;

use crate::mesh::{EdgeId, TriMesh};
use crate::rest::RestFrame;

/// One form a face, components `11, 22, 12` [1/m]; `angles` are those of the inner edges in their order.
pub fn rest_forms_of_hinges(
    mesh: &TriMesh,
    frames: &[RestFrame],
    angles: &[f64],
) -> Vec<Vector3<f64>> {
    let mut inner = angles.iter();
    let of_edges: Vec<f64> = (0..mesh.num_edges() as u32)
        .map(|edge| match mesh.is_boundary_edge(EdgeId(edge)) {
            true => 0.0,
            false => *inner.next().expect("every inner edge has an angle"),
        })
        .collect();
    let form = |(frame, edges): (&RestFrame, &[EdgeId; 3])| {
        let lengths = frame.edge_lengths();
        let curvatures = Vector3::from_fn(|c, _| {
            let altitude = 2.0 * frame.area / lengths[c];
            2.0 * altitude * (0.5 * of_edges[edges[c].0 as usize]).sin()
        });
        let rows = frame.second_form_matrix();
        Vector3::from(rows.map(|row| Vector3::from(row).dot(&curvatures)))
    };
    frames.iter().zip(mesh.face_edges()).map(form).collect()
}
