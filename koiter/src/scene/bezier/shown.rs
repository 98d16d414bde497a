//! The fine surface of Bézier shells as frames show it: by parts, with fields.

use super::BezierModel;
use super::body::BezierBody;
use crate::Vec3;
use crate::bezier::{MappedSurface, PointFields, SurfacePoint};
use crate::scene::display::PartTopology;

/// A part of the fine surface.
#[derive(Clone, Debug)]
pub(super) struct ShownPart {
    /// Which part of the model it is.
    owner: usize,
    /// Its vertices, by their numbers in the fine surface.
    vertices: Vec<u32>,
    /// Its triangles, by numbers of its own.
    faces: Vec<[u32; 3]>,
}

impl ShownPart {
    /// The parts of a fine surface, in the order of their numbers; `owners` says whose each element is.
    pub(super) fn of(fine: &MappedSurface, owners: &[usize]) -> Vec<Self> {
        let of_face = |face: usize| owners[fine.elements()[face] as usize];
        let last = owners.iter().copied().max().unwrap_or(0);
        let part = |owner: usize| {
            let mut number = vec![u32::MAX; fine.points().len()];
            let (mut vertices, mut faces) = (Vec::new(), Vec::new());
            for (_, face) in (fine.faces().iter().enumerate()).filter(|(f, _)| of_face(*f) == owner)
            {
                faces.push(face.map(|v| {
                    if number[v as usize] == u32::MAX {
                        number[v as usize] = vertices.len() as u32;
                        vertices.push(v);
                    }
                    number[v as usize]
                }));
            }
            Self {
                owner,
                vertices,
                faces,
            }
        };
        (0..=last).map(part).collect()
    }
}

impl BezierBody {
    /// The parts with their present positions for a start.
    pub(in crate::scene) fn parts(&self, model: &BezierModel) -> Vec<PartTopology> {
        let positions = self.fine.positions(&self.moving.pose);
        let part = |shown: &ShownPart| {
            let shell = &model.parts[shown.owner].shell;
            PartTopology {
                name: shell.name.clone(),
                is_obstacle: false,
                faces: shown.faces.clone(),
                num_vertices: shown.vertices.len(),
                thickness: shell.thickness,
                start_positions: (shown.vertices.iter())
                    .map(|v| positions[*v as usize])
                    .collect(),
            }
        };
        self.shown.iter().map(part).collect()
    }

    /// Where on the shell a vertex lies, by its number among those of all parts.
    ///
    /// # Panics
    /// If there are not so many.
    pub(in crate::scene) fn shown_point(&self, vertex: usize) -> SurfacePoint {
        let mut shown = self.shown.iter().flat_map(|part| &part.vertices);
        let fine = *shown.nth(vertex).expect("the vertex is shown");
        self.fine.points()[fine as usize]
    }

    /// Positions of the vertices of all parts [m].
    pub(in crate::scene) fn display_positions(&self) -> Vec<Vec3> {
        let positions = self.fine.positions(&self.moving.pose);
        let vertices = self.shown.iter().flat_map(|part| &part.vertices);
        vertices.map(|v| positions[*v as usize]).collect()
    }

    /// Values on the faces of all parts: largest principal strain, energy of bending by area [J/m²].
    pub(in crate::scene) fn face_fields(&self) -> [(&'static str, Vec<f32>); 2] {
        let (shell, pose) = (&self.moving.shell, &self.moving.pose);
        let points = self.fine.points().iter();
        let at_vertices: Vec<PointFields> = points.map(|p| shell.fields(p, pose)).collect();
        let on_faces = |value: fn(&PointFields) -> f64| -> Vec<f32> {
            let mean = |part: &ShownPart, face: &[u32; 3]| {
                let corner = |v: u32| value(&at_vertices[part.vertices[v as usize] as usize]);
                (face.map(corner).iter().sum::<f64>() / 3.0) as f32
            };
            let parts = self.shown.iter();
            parts
                .flat_map(|part| part.faces.iter().map(move |face| mean(part, face)))
                .collect()
        };
        [
            ("strain", on_faces(|fields| fields.strain)),
            (
                "bending_energy_density",
                on_faces(|fields| fields.bending_energy_density),
            ),
        ]
    }
}
