//! A suture: pairs of vertices become one.
//!
//! Elements keep their rest states, so what was made apart can be sewn together: a patch into a hole, or the lips of a cut.

use std::sync::Arc;

use super::change::{Change, Origin, Parent};
use super::{BezierError, BezierShell, Pose};
use crate::mesh::TriMesh;

/// The angle that a seam remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeamAngle {
    /// That of the rest shapes: closing a cut gives the shell back as it was.
    #[default]
    Rest,
    /// That of the moment of sewing: sewing bends nothing. For parts whose rest shapes do not stand as they are sewn.
    Current,
}

impl BezierShell {
    /// This shell and another one as a single shell of two pieces; the vertices of the other come behind. Elements keep
    /// their materials and thicknesses.
    ///
    /// # Errors
    /// A shell of another element.
    pub fn beside(&self, other: &Self) -> Result<Self, BezierError> {
        let kind = |shell: &Self| (shell.options().kind, shell.options().frame);
        if kind(self) != kind(other) {
            return Err(BezierError::OtherShell);
        }
        let first = self.mesh().num_vertices() as u32;
        let mut faces = self.mesh().faces().to_vec();
        faces.extend(
            other
                .mesh()
                .faces()
                .iter()
                .map(|face| face.map(|v| first + v)),
        );
        let mesh = TriMesh::new(first as usize + other.mesh().num_vertices(), faces)?;
        let rest = [self.rest(), other.rest()].concat();
        let elements = [self.elements(), other.elements()].concat();
        let known = |index: usize| Some(Arc::clone(&elements[index]));
        Self::of_elements(mesh, rest, *self.options(), known)
    }

    /// Sews vertices together, pair by pair; several pairs may share a vertex. Positions become means of what is joined,
    /// rotations those of the smallest vertex.
    ///
    /// Returns the change and the pose after it. Masses add up.
    ///
    /// # Errors
    /// A pair of no two vertices; a mesh that is not a manifold one, or an element two of whose corners would be one.
    pub fn sew(
        &self,
        pairs: &[[u32; 2]],
        pose: &Pose,
        angle: SeamAngle,
    ) -> Result<(Change, Pose), BezierError> {
        let vertices = self.mesh().num_vertices();
        let mut joined: Vec<u32> = (0..vertices as u32).collect();
        let first = |joined: &[u32], mut v: u32| {
            while joined[v as usize] != v {
                v = joined[v as usize];
            }
            v
        };
        for &pair in pairs {
            if pair[0] == pair[1] || pair.iter().any(|v| *v as usize >= vertices) {
                return Err(BezierError::NoSuchPair { pair, vertices });
            }
            let [a, b] = pair.map(|v| first(&joined, v));
            joined[a.max(b) as usize] = a.min(b);
        }
        let representative: Vec<u32> = (0..vertices as u32).map(|v| first(&joined, v)).collect();
        let mut number = vec![0; vertices];
        let mut origins = Vec::new();
        for v in (0..vertices as u32).filter(|v| representative[*v as usize] == *v) {
            number[v as usize] = origins.len() as u32;
            origins.push(Origin::vertex(v));
        }
        let new = |v: u32| number[representative[v as usize] as usize];
        let faces = (self.mesh().faces().iter())
            .map(|face| face.map(new))
            .collect();
        let mesh = TriMesh::new(origins.len(), faces)?;
        let mut rest = self.rest().to_vec();
        if angle == SeamAngle::Current {
            for (element, face) in rest.iter_mut().zip(self.mesh().faces()) {
                for (corner, &v) in face.iter().enumerate() {
                    let held_by = pose.rotations[representative[v as usize] as usize];
                    let turn = held_by.inverse() * pose.rotations[v as usize];
                    element.attached[corner] = turn * element.attached[corner];
                }
            }
        }
        let known =
            |index: usize| (angle == SeamAngle::Rest).then(|| Arc::clone(&self.elements()[index]));
        let change = Change {
            shell: Self::of_elements(mesh, rest, *self.options(), known)?,
            parents: (0..self.elements().len()).map(Parent::whole).collect(),
            present: (0..vertices as u32).map(new).collect(),
            origins,
            seam: Vec::new(),
        };
        let mut after = change.pose(pose);
        let mut counts = vec![0.0; after.len()];
        after.positions.fill(crate::Vec3::zeros());
        for v in 0..vertices {
            let of = new(v as u32) as usize;
            after.positions[of] += pose.positions[v];
            counts[of] += 1.0;
        }
        for (x, count) in after.positions.iter_mut().zip(counts) {
            *x /= count;
        }
        Ok((change, after))
    }
}
