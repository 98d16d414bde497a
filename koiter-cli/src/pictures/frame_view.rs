//! A frame of a result as the renderer wants it.

use koiter::io::result::{Frame, Part, PartKind, ResultReader};
use koiter_render::{Bounds, FieldView, Ground, PartView, Rgb, Scene, level_floor};

/// The parts of a frame and their faces, each by its own vertex numbers.
struct Topology {
    parts: Vec<Part>,
    faces: Vec<Vec<[u32; 3]>>,
}

impl Topology {
    fn new(reader: &ResultReader, frame: &Frame) -> Self {
        let parts = reader.parts_in(frame).to_vec();
        let local = |part: &Part| {
            let offset = part.vertices.start as u32;
            let faces = &reader.faces_in(frame)[part.faces.clone()];
            faces
                .iter()
                .map(|corners| corners.map(|vertex| vertex - offset))
                .collect()
        };
        Self {
            faces: parts.iter().map(local).collect(),
            parts,
        }
    }
}

/// A frame with its coordinates as arrays.
pub(super) struct FrameView {
    topology: Topology,
    positions: Vec<[f64; 3]>,
    /// Values of the field at the faces of all parts.
    field: Option<Vec<f64>>,
}

impl FrameView {
    /// `field` is left out if the frame does not have it.
    pub(super) fn new(reader: &ResultReader, frame: Frame, field: Option<&str>) -> Self {
        let topology = Topology::new(reader, &frame);
        let values = field.and_then(|name| frame.field(name));
        Self {
            topology,
            field: values.map(|field| field.values.iter().map(|&value| value.into()).collect()),
            positions: frame.positions.into_iter().map(Into::into).collect(),
        }
    }

    /// What the camera should frame: everything but the floor.
    pub(super) fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for (_, positions) in self.shown() {
            positions
                .iter()
                .for_each(|&position| bounds.include(position));
        }
        bounds
    }

    /// Values of the field on shells.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        let shells = self
            .topology
            .parts
            .iter()
            .filter(|part| part.kind == PartKind::Shell);
        let field = self.field.as_deref();
        shells
            .flat_map(move |part| field.map_or(&[][..], |values| &values[part.faces.clone()]))
            .copied()
    }

    /// The scene, with a level floor as the renderer's ground.
    pub(super) fn scene(&self) -> Scene<'_> {
        let mut parts = Vec::new();
        let mut shells = 0;
        for (index, positions) in self.shown() {
            let part = &self.topology.parts[index];
            let faces = &self.topology.faces[index];
            if part.kind == PartKind::Obstacle {
                parts.push(PartView::obstacle(positions, faces));
                continue;
            }
            let field = self
                .field
                .as_ref()
                .map(|values| FieldView::PerFace(&values[part.faces.clone()]));
            parts.push(PartView {
                color: Rgb::of_part(shells),
                field,
                ..PartView::shell(positions, faces)
            });
            shells += 1;
        }
        let floors = (0..self.topology.parts.len()).filter_map(|index| self.floor(index));
        let ground = floors.reduce(f64::max).map_or(Ground::None, Ground::At);
        Scene { parts, ground }
    }

    /// Parts other than floors, by index, with their positions.
    fn shown(&self) -> impl Iterator<Item = (usize, &[[f64; 3]])> {
        (0..self.topology.parts.len())
            .filter(|&index| self.floor(index).is_none())
            .map(|index| (index, self.positions_of(index)))
    }

    fn positions_of(&self, index: usize) -> &[[f64; 3]] {
        &self.positions[self.topology.parts[index].vertices.clone()]
    }

    fn floor(&self, index: usize) -> Option<f64> {
        match self.topology.parts[index].kind {
            PartKind::Obstacle => {
                level_floor(self.positions_of(index), &self.topology.faces[index])
            }
            _ => None,
        }
    }
}
