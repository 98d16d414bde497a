//! How much memory a scene takes, estimated before it is taken.

use super::error::{SceneError, SceneErrorKind};
use super::model::{BendingModel, BezierPart, Model, ObstacleShape};
use super::sizes::{BYTES_A_DOF, BYTES_A_QUAD, PROGRAM_BYTES};
use super::spec::{MeshSpec, ObstacleSpec, SceneSpec, ShellSpec};
use crate::bezier::NODE_UNKNOWNS;
use crate::energy::bending::ExtraUnknowns;
use crate::mesh::generate::face_count;

/// Vertices and edges a face.
const VERTICES_A_FACE: f64 = 0.5;
const EDGES_A_FACE: f64 = 1.5;
/// Topology, collision mesh and trees of a face that is not solved for.
const BYTES_AN_OBSTACLE_FACE: f64 = 1_000.0;

/// What one shell or obstacle takes.
struct Share {
    path: String,
    faces: f64,
    bytes: f64,
}

/// Refuses generated meshes that will not fit, before they are made. Files count nothing yet.
pub(super) fn check_spec(spec: &SceneSpec, available: u64) -> Result<(), SceneError> {
    let shells = spec.shell.iter().map(|shell| {
        let ShellSpec { name, mesh, .. } = shell;
        let rest = shell.rest_mesh.as_ref().map_or(0.0, generated_faces);
        shell_share(name, shell.bending, generated_faces(mesh).max(rest))
    });
    let obstacles = spec.obstacle.iter().map(|obstacle| {
        let ObstacleSpec { name, mesh, .. } = obstacle;
        let sides = obstacle.cylinder.as_ref().map_or(0, |body| body.sides);
        let mesh = mesh.as_ref().map_or(0.0, generated_faces);
        obstacle_share(name, mesh + 4.0 * sides as f64)
    });
    let layers = spec.double_layer.iter().map(|layer| {
        let quads = match (&layer.mesh.grid, &layer.mesh.torus) {
            (Some(grid), _) => grid.cells[0] as f64 * grid.cells[1] as f64,
            (_, Some(torus)) => torus.around as f64 * torus.tube as f64,
            _ => 0.0,
        };
        layer_share(&layer.name, quads)
    });
    let bezier = spec.bezier_shell.iter().map(|shell| {
        let parts = shell.surface.subdivide as f64;
        bezier_share(&shell.name, generated_faces(&shell.mesh), parts * parts)
    });
    let all = shells.chain(layers).chain(bezier).chain(obstacles);
    check(all.collect(), available)
}

/// Refuses a model that will not fit, files included, before it is assembled.
pub(super) fn check_model(model: &Model, available: u64) -> Result<(), SceneError> {
    let shells = model.shells.iter().map(|shell| {
        let faces = shell.surface.mesh.num_faces() as f64;
        shell_share(&shell.name, shell.bending, faces)
    });
    let obstacles = model.obstacles.iter().map(|obstacle| {
        let faces = match &obstacle.shape {
            ObstacleShape::Mesh(surface) => surface.mesh.num_faces(),
            _ => 0,
        };
        obstacle_share(&obstacle.name, faces as f64)
    });
    let layers = model
        .double_layers
        .iter()
        .map(|layer| layer_share(&layer.name, layer.setup.shell.mesh.quads().len() as f64));
    let bezier = model.bezier.iter().flat_map(|bezier| {
        let parts = bezier.subdivide as f64;
        let share = move |part: &BezierPart| {
            let faces = part.shell.surface.mesh.num_faces() as f64;
            bezier_share(&part.shell.name, faces, parts * parts)
        };
        bezier.parts.iter().map(share)
    });
    let all = shells.chain(layers).chain(bezier).chain(obstacles);
    check(all.collect(), available)
}

/// Elements with their nodes of six unknowns, and the triangles they are divided into.
fn bezier_share(name: &str, elements: f64, fine: f64) -> Share {
    let unknowns = NODE_UNKNOWNS as f64 * VERTICES_A_FACE;
    Share {
        path: format!("bezier_shell.{name}.mesh"),
        faces: elements,
        bytes: elements * (unknowns * BYTES_A_DOF as f64 + fine * BYTES_AN_OBSTACLE_FACE),
    }
}

fn layer_share(name: &str, quads: f64) -> Share {
    Share {
        path: format!("double_layer.{name}.mesh"),
        faces: 4.0 * quads,
        bytes: quads * BYTES_A_QUAD as f64,
    }
}

fn shell_share(name: &str, bending: BendingModel, faces: f64) -> Share {
    let extra = bending.info().unknowns;
    let extra_nodes = match extra {
        ExtraUnknowns::None => 0.0,
        ExtraUnknowns::VertexDirectors => VERTICES_A_FACE,
        ExtraUnknowns::EdgeAngles | ExtraUnknowns::EdgePoints => EDGES_A_FACE,
    };
    let dofs_a_face = 3.0 * VERTICES_A_FACE + extra_nodes * extra.node_size() as f64;
    Share {
        path: format!("shell.{name}.mesh"),
        faces,
        bytes: faces * dofs_a_face * BYTES_A_DOF as f64,
    }
}

fn obstacle_share(name: &str, faces: f64) -> Share {
    Share {
        path: format!("obstacle.{name}"),
        faces,
        bytes: faces * BYTES_AN_OBSTACLE_FACE,
    }
}

fn check(shares: Vec<Share>, available: u64) -> Result<(), SceneError> {
    let total = PROGRAM_BYTES as f64 + shares.iter().map(|share| share.bytes).sum::<f64>();
    // A count that is not a number belongs to a mesh that its generator refuses.
    if total.is_nan() || total <= available as f64 {
        return Ok(());
    }
    let faces: f64 = shares.iter().map(|share| share.faces).sum();
    let largest = shares
        .into_iter()
        .max_by(|a, b| a.bytes.total_cmp(&b.bytes));
    let faces = match faces < 1e5 {
        true => format!("{faces:.0}"),
        false => format!("{faces:.1e}"),
    };
    let message = format!(
        "the scene has about {faces} triangles and needs about {} of memory; the limit is {}",
        readable_bytes(total),
        readable_bytes(available as f64)
    );
    let path = largest.map_or(String::new(), |share| share.path);
    Err(SceneError::new(SceneErrorKind::TooLarge, message)
        .inside(&path)
        .with_help("make the mesh coarser"))
}

/// `1.5 GB` and the like; for what no machine has, `3.6e16 GB`.
pub fn readable_bytes(bytes: f64) -> String {
    match bytes {
        b if b >= 1e15 => format!("{:.1e} GB", b * 1e-9),
        b if b >= 1e9 => format!("{:.1} GB", b * 1e-9),
        b if b >= 1e6 => format!("{:.0} MB", b * 1e-6),
        b => format!("{:.0} kB", b * 1e-3),
    }
}

/// Faces of a mesh that is generated; 0 for a file.
fn generated_faces(spec: &MeshSpec) -> f64 {
    let radians = |degrees: f64| degrees.to_radians();
    let counts = [
        spec.grid
            .as_ref()
            .map(|g| face_count::cells(g.cells[0], g.cells[1])),
        spec.irregular
            .as_ref()
            .map(|g| face_count::irregular(g.size[0], g.size[1], g.max_area)),
        spec.disc.as_ref().map(|g| face_count::disc(g.rings)),
        spec.cylinder
            .as_ref()
            .map(|g| face_count::cells(g.around, g.along)),
        spec.cone
            .as_ref()
            .map(|g| face_count::cells(g.around, g.along)),
        spec.icosphere
            .as_ref()
            .map(|g| face_count::icosphere(g.subdivisions)),
        spec.torus
            .as_ref()
            .map(|g| face_count::cells(g.around, g.tube)),
        spec.vee
            .as_ref()
            .map(|g| 2.0 * face_count::cells(g.along, g.across)),
        spec.hat
            .as_ref()
            .map(|g| face_count::hat(g.around, g.rings)),
        spec.panel
            .as_ref()
            .map(|g| face_count::cells(g.cells[0], g.cells[1])),
        spec.zone
            .as_ref()
            .map(|g| face_count::cells(g.cells[0], g.cells[1])),
        spec.cap.as_ref().map(|g| {
            let hole = g.hole_degrees.map_or(0.0, radians);
            let angle = radians(g.degrees);
            match g.inset {
                None => face_count::spherical_cap(angle, hole, g.rings),
                Some(inset) => face_count::inset_cap(g.radius, angle, hole, inset, g.rings),
            }
        }),
    ];
    counts.into_iter().flatten().sum()
}

#[cfg(test)]
mod tests {
    use super::super::placement::place;
    use super::super::{NoFiles, Scene, SceneErrorKind, SceneFile};
    use super::*;

    fn scene(mesh: &str) -> SceneFile {
        let text = format!(
            "time = {{ end = 1.0, dt = 0.1 }}\n[[shell]]\nname = \"cloth\"\nmaterial = \"cotton\"\nmesh.{mesh}\n"
        );
        SceneFile::parse("scene.toml", &text, &[]).unwrap()
    }

    #[test]
    fn ten_million_triangles_are_refused_before_they_are_made() {
        let file = scene("grid = { size = [1.0, 1.0], cells = [2000, 2500] }");
        let error = Scene::build_within(&file, &NoFiles, 8_000_000_000).unwrap_err();
        assert_eq!(error.kind, SceneErrorKind::TooLarge);
        assert_eq!(error.path, "shell.cloth.mesh");
        assert_eq!(
            error.message,
            "the scene has about 1.0e7 triangles and needs about 180.0 GB of memory; the limit is 8.0 GB"
        );
        assert_eq!(error.location.unwrap().line(), 5);
    }

    #[test]
    fn sizes_are_readable() {
        let cases = [
            (1.5e9, "1.5 GB"),
            (20.4e6, "20 MB"),
            (1e3, "1 kB"),
            (3.6e34, "3.6e25 GB"),
        ];
        for (bytes, text) in cases {
            assert_eq!(readable_bytes(bytes), text);
        }
    }

    #[test]
    fn every_generator_is_counted_before_it_runs() {
        for mesh in [
            "grid = { size = [1.0, 1.0], cells = [20, 30] }",
            "irregular = { size = [1.0, 1.0], max_area = 1e-3, seed = 1 }",
            "disc = { radius = 1.0, rings = 12 }",
            "cylinder = { radius = 1.0, height = 2.0, around = 40, along = 20 }",
            "cylinder = { radius = 1.0, height = 2.0, around = 40, along = 20, corrugation = { waves = 5, depth = 0.2 } }",
            "cone = { base_radius = 1.0, height = 2.0, around = 40, along = 20 }",
            "icosphere = { radius = 1.0, subdivisions = 3 }",
            "torus = { major_radius = 1.0, minor_radius = 0.3, around = 40, tube = 20 }",
            "vee = { length = 1.0, width = 0.5, degrees = 90.0, along = 20, across = 10 }",
            "hat = { radius = 1.0, height = 1.2, brim = 0.5, slope = 0.1, around = 40, rings = 20 }",
            "panel = { radius = 1.0, length = 2.0, degrees = [0.0, 40.0], cells = [20, 30] }",
            "zone = { radius = 1.0, longitudes = [0.0, 90.0], latitudes = [0.0, 72.0], cells = [20, 30] }",
            "cap = { radius = 1.0, degrees = 80.0, hole_degrees = 10.0, rings = 15 }",
            "cap = { radius = 0.1, degrees = 72.0, hole_degrees = 8.0, inset = 0.012, rings = 15 }",
        ] {
            let spec = &scene(mesh).spec.shell[0].mesh;
            let expected = generated_faces(spec);
            let made = place(spec, &NoFiles).unwrap().mesh.num_faces() as f64;
            // Upper bounds, not so far up that a scene that fits is refused.
            assert!(
                (made..=2.0 * made).contains(&expected),
                "{mesh}: {made} of {expected}"
            );
        }
    }
}
