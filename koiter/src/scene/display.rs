//! What is shown of a model: its shells, and obstacles as triangle meshes.

use super::bezier::BezierBody;
use super::model::{Model, Obstacle, ObstacleShape};
use super::simulation::Simulation;
use crate::Vec3;
use crate::audit::{RestFace, Solid};
use crate::burning::{DoubleLayer, RenderSurface};
use crate::mesh::generate;

/// A surface to show.
#[derive(Clone, Debug)]
pub struct PartTopology {
    /// Name in the scene.
    pub name: String,
    /// Whether it is an obstacle.
    pub is_obstacle: bool,
    /// Faces, counted from the part's first vertex.
    pub faces: Vec<[u32; 3]>,
    /// Number of vertices.
    pub num_vertices: usize,
    /// Thickness [m]; 0 for obstacles.
    pub thickness: f64,
    /// Vertices at time 0 before any motion [m].
    pub start_positions: Vec<Vec3>,
}

/// Planes are shown as squares this many times the extent of the shells.
const PLANE_EXTENT: f64 = 3.0;

pub(super) fn tessellate(model: &Model, bezier: Option<&BezierBody>) -> Vec<PartTopology> {
    let bezier = bezier.zip(model.bezier.as_ref());
    let bezier = bezier.map_or_else(Vec::new, |(body, model)| body.parts(model));
    let shells = model.shells.iter().map(|shell| PartTopology {
        name: shell.name.clone(),
        is_obstacle: false,
        faces: shell.surface.mesh.faces().to_vec(),
        num_vertices: shell.surface.mesh.num_vertices(),
        thickness: shell.thickness,
        start_positions: shell.surface.positions.clone(),
    });
    let extents = model.shells.iter().map(|s| {
        let (low, high) = s.surface.bounding_box();
        (high - low).norm()
    });
    let layers = model.double_layers.iter();
    let extent = extents
        .chain(
            layers
                .clone()
                .map(|layer| diagonal(&layer.setup.shell.particles)),
        )
        .chain(bezier.iter().map(|part| diagonal(&part.start_positions)))
        .fold(1e-3, f64::max);
    let layers = layers.map(|layer| {
        let shell = &layer.setup.shell;
        let whole = RenderSurface::new(&shell.mesh);
        layer_part(&layer.name, shell, &whole, &shell.particles)
    });
    shells
        .chain(layers)
        .chain(bezier)
        .chain(
            model
                .obstacles
                .iter()
                .map(|obstacle| obstacle_part(obstacle, extent)),
        )
        .collect()
}

/// Diagonal of the box around points [m].
fn diagonal(points: &[Vec3]) -> f64 {
    let low = points
        .iter()
        .fold(Vec3::repeat(f64::MAX), |low, x| low.inf(x));
    let high = points
        .iter()
        .fold(Vec3::repeat(f64::MIN), |high, x| high.sup(x));
    (high - low).norm()
}

/// What a surface shows of a double layer with particles at `positions` [m].
fn layer_part(
    name: &str,
    shell: &DoubleLayer,
    surface: &RenderSurface,
    positions: &[Vec3],
) -> PartTopology {
    PartTopology {
        name: name.to_owned(),
        is_obstacle: false,
        faces: surface.faces.clone(),
        num_vertices: surface.vertices.len(),
        thickness: shell.thickness,
        start_positions: surface.positions(shell, positions),
    }
}

fn obstacle_part(obstacle: &Obstacle, extent: f64) -> PartTopology {
    let (positions, faces) = match &obstacle.shape {
        ObstacleShape::Plane { point, normal } => {
            let across = if normal.x.abs() < 0.9 {
                Vec3::x()
            } else {
                Vec3::y()
            };
            let u = normal.cross(&across).normalize() * (0.5 * PLANE_EXTENT * extent);
            let v = normal.cross(&u);
            (
                vec![point - u - v, point + u - v, point + u + v, point - u + v],
                vec![[0, 1, 2], [0, 2, 3]],
            )
        }
        ObstacleShape::Sphere { center, radius } => {
            let ball = generate::icosphere(*radius, 4).expect("a sphere has a positive radius");
            (
                ball.positions.iter().map(|x| x + center).collect(),
                ball.mesh.faces().to_vec(),
            )
        }
        ObstacleShape::Capsule { ends, radius } => capsule(ends, *radius),
        ObstacleShape::Mesh(surface) => (surface.positions.clone(), surface.mesh.faces().to_vec()),
    };
    PartTopology {
        name: obstacle.name.clone(),
        is_obstacle: true,
        num_vertices: positions.len(),
        faces,
        thickness: 0.0,
        start_positions: positions,
    }
}

impl Obstacle {
    /// The exact shape of an obstacle that is shown with faces which only come near it, as it stands at time 0.
    pub fn solid(&self) -> Option<Solid> {
        let at_start = |x: &Vec3| -> [f64; 3] { self.motion.apply(*x, 0.0).into() };
        match &self.shape {
            ObstacleShape::Plane { point, normal } => Some(Solid::HalfSpace {
                point: at_start(point),
                normal: (*normal).into(),
            }),
            ObstacleShape::Sphere { center, radius } => Some(Solid::Ball {
                center: at_start(center),
                radius: *radius,
            }),
            ObstacleShape::Capsule { ends, radius } => Some(Solid::Capsule {
                ends: ends.each_ref().map(at_start),
                radius: *radius,
            }),
            ObstacleShape::Mesh(_) => None,
        }
    }
}

impl Simulation {
    /// Positions of the vertices of all parts [m].
    pub fn display_positions(&self) -> Vec<Vec3> {
        let shown = |shell: usize| {
            let positions = self.shell_positions(shell);
            match self.heated_shell(shell) {
                Some(burning) => burning.surface().positions_by(|v| positions[v]),
                None => positions,
            }
        };
        let mut positions: Vec<Vec3> = (0..self.model.shells.len()).flat_map(shown).collect();
        for (part, layer) in self.model.double_layers.iter().zip(self.double_layers()) {
            let particles = &layer.state().positions;
            positions.extend(layer.surface().positions(&part.setup.shell, particles));
        }
        if let Some(body) = &self.bezier {
            positions.extend(body.display_positions());
        }
        let shown = self.parts().iter().filter(|part| part.is_obstacle);
        let obstacles = self.model.obstacles.iter().zip(shown);
        for (obstacle, part) in obstacles {
            positions.extend(obstacle.points_at(&part.start_positions, self.time()));
        }
        positions
    }

    /// The surfaces to show as they are now, where their faces change from step to step: those that burn and those of Bézier shells
    /// that are cut have their present positions for a start. `None`: [`Self::parts`] are right throughout.
    pub fn present_parts(&self) -> Option<Vec<PartTopology>> {
        let obstacles = self.parts().iter().filter(|part| part.is_obstacle);
        if let (Some(body), Some(model)) = (&self.bezier, &self.model.bezier) {
            let is_whole = model.procedures.is_empty();
            let changing = || body.parts(model).into_iter().chain(obstacles.cloned());
            return (!is_whole).then(|| changing().collect());
        }
        if self.burning.is_empty() && self.heated.is_empty() {
            return None;
        }
        let shells = self
            .parts()
            .iter()
            .take(self.model.shells.len())
            .enumerate();
        let shells = shells.map(|(shell, part)| match self.heated_shell(shell) {
            None => part.clone(),
            Some(burning) => {
                let (surface, positions) = (burning.surface(), self.shell_positions(shell));
                PartTopology {
                    faces: surface.faces.clone(),
                    num_vertices: surface.vertices.len(),
                    start_positions: surface.positions_by(|v| positions[v]),
                    ..part.clone()
                }
            }
        });
        let layers = self.model.double_layers.iter().zip(&self.burning.shells);
        let layers = layers.map(|(part, layer)| {
            let (shell, positions) = (&part.setup.shell, &layer.state().positions);
            layer_part(&part.name, shell, layer.surface(), positions)
        });
        Some(shells.chain(layers).chain(obstacles.cloned()).collect())
    }

    /// What the faces of all parts are at rest: those of shells in their rest metric, those of obstacles at the start.
    pub fn rest_faces(&self) -> Vec<RestFace> {
        let frames = self
            .system
            .space
            .shells
            .iter()
            .flat_map(|shell| &shell.frames);
        let of_shells = frames.map(|frame| RestFace {
            area: frame.area,
            edges: frame.edge_lengths(),
        });
        // Double layers and obstacles: what they are at the start.
        let others = self.parts().iter().skip(self.model().shells.len());
        let of_others = others.flat_map(|part| {
            let corners = |face: &[u32; 3]| face.map(|v| part.start_positions[v as usize]);
            (part.faces.iter()).map(move |face| RestFace::from_corners(&corners(face)))
        });
        of_shells.chain(of_others).collect()
    }
}

/// A sphere whose vertices are moved to the end of the axis on their side.
fn capsule(ends: &[Vec3; 2], radius: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let ball = generate::icosphere(radius, 4).expect("a capsule has a positive radius");
    let axis = ends[1] - ends[0];
    let place = |x: &Vec3| x + if x.dot(&axis) < 0.0 { ends[0] } else { ends[1] };
    (
        ball.positions.iter().map(place).collect(),
        ball.mesh.faces().to_vec(),
    )
}
