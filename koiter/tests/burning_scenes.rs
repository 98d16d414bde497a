//! Scenes with double layers: what is refused, what burns, and that a saved run goes on to the same bits.
#![cfg(feature = "io")]

use std::collections::BTreeMap;

use koiter::burning::{QuadMesh, Texture};
use koiter::io::Checkpoint;
use koiter::io::read::{parse_obj_quads, parse_png};
use koiter::io::result::{
    Frame, FrameTopology, Manifest, Part, PartKind, ResultReader, ResultWriter, Totals,
};
use koiter::mesh::{Surface, SurfaceOptions};
use koiter::scene::{MeshSource, Scene, SceneError, SceneFile, Simulation, UnreadableMesh};

const SCENE: &str = r#"
time = { end = 0.6, dt = 0.01 }

[[double_layer]]
name = "paper"
mesh.grid = { size = [0.3, 0.3], cells = [8, 8] }
mesh.rotate = { axis = [1, 0, 0], degrees = 90 }
thickness = 3.75e-3
area_density = 0.08
burning = { diffusivity = 2e-6 }
self_collision = { friction = 0.2 }

[[heat_source]]
name = "ball"
sphere = { center = [-0.2, 0, 0], radius = 0.04 }
motion.translate = [[0, [0, 0, 0]], [0.6, [0.4, 0, 0]]]
temperature = 1000
rate = 25

[[obstacle]]
name = "post"
sphere = { center = [0, 0.08, -0.05], radius = 0.05 }

[[constraint]]
name = "corner"
shell = "paper"
select.nearest = [-0.15, 0, 0.15]
motion.translate = [[0, [0, 0, 0]], [0.6, [0.02, 0, 0]]]
"#;

/// Files by name.
struct Files(Vec<(&'static str, Vec<u8>)>);

impl Files {
    fn bytes(&self, file: &str) -> Result<&[u8], UnreadableMesh> {
        let found = self.0.iter().find(|(name, _)| *name == file);
        found
            .map(|(_, bytes)| &bytes[..])
            .ok_or_else(|| told(&"there is no such file"))
    }
}

fn told(error: &dyn std::fmt::Display) -> UnreadableMesh {
    UnreadableMesh {
        message: error.to_string(),
        help: None,
    }
}

impl MeshSource for Files {
    fn read(&self, _: &str, _: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        Err(told(&"no triangles here"))
    }

    fn read_quads(&self, file: &str) -> Result<QuadMesh, UnreadableMesh> {
        parse_obj_quads(self.bytes(file)?).map_err(|error| told(&error))
    }

    fn read_texture(&self, file: &str) -> Result<Texture, UnreadableMesh> {
        parse_png(self.bytes(file)?).map_err(|error| told(&error))
    }
}

fn files() -> Files {
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let folded = quad.replace("1 2 3 4", "1 2 4 3");
    let across = "v .5 .5 -1\nv .5 .6 -1\nv .5 .6 1\nv .5 .5 1\nf 5 6 7 8\n";
    let png = include_bytes!("../../scenes/hot-sphere/patches.png");
    // Its header says 2 147 483 647 pixels a row.
    let mut huge = png.to_vec();
    huge[16..20].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff]);
    Files(vec![
        ("quad.obj", quad.into()),
        ("crossed.obj", format!("{quad}{across}").into_bytes()),
        ("cut.png", png[..png.len() / 2].to_vec()),
        ("huge.png", huge),
        ("folded.obj", folded.into()),
        ("no.png", b"not an image".to_vec()),
    ])
}

fn build(overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let file = SceneFile::parse("scene.toml", SCENE, &overrides)?;
    Scene::build(&file, &files())
}

fn simulation() -> Simulation {
    Simulation::new(build(&[]).unwrap().model).unwrap()
}

#[test]
fn mistakes_are_told_with_their_place() {
    for (overrides, path, words) in [
        (
            "double_layer.paper.burning.loss_lvel=0.5",
            "double_layer.paper.burning.loss_lvel",
            "unknown key",
        ),
        (
            "double_layer.paper.burning.smallest_mass=0",
            "double_layer.paper.burning.smallest_mass",
            "above 0",
        ),
        (
            "double_layer.paper.thickness=-1",
            "double_layer.paper.thickness",
            "larger than 0",
        ),
        (
            "double_layer.paper.projection.weights=[1,1,1,2]",
            "double_layer.paper.projection.weights",
            "at most 1",
        ),
        (
            "double_layer.paper.burning.strength=1e3",
            "double_layer.paper.burning.strength",
            "a key of [shell.burning]",
        ),
        (
            "double_layer.paper.projection={method=\"global\",iterations=20}",
            "double_layer.paper.projection.iterations",
            "global",
        ),
        (
            "double_layer.paper.projection.sweeps=0",
            "double_layer.paper.projection.sweeps",
            "at least 1",
        ),
        (
            "double_layer.paper.mesh.grid.cells=[0,3]",
            "double_layer.paper.mesh.grid",
            "at least 1",
        ),
        (
            "double_layer.paper.burning.loss_texture=\"no.png\"",
            "double_layer.paper.burning.loss_texture",
            "not a PNG",
        ),
        (
            "double_layer.paper.burning.loss_texture=\"none.png\"",
            "double_layer.paper.burning.loss_texture",
            "no such file",
        ),
        (
            "double_layer.paper.burning.loss_texture=\"cut.png\"",
            "double_layer.paper.burning.loss_texture",
            "not a PNG",
        ),
        (
            "heat_source.ball.texture=\"huge.png\"",
            "heat_source.ball.texture",
            "not a PNG",
        ),
        (
            "double_layer.paper.self_collision.distance=0",
            "double_layer.paper.self_collision.distance",
            "larger than 0",
        ),
        (
            "double_layer.paper.self_collision.friction=2",
            "double_layer.paper.self_collision.friction",
            "from 0 to 1",
        ),
        (
            "double_layer.paper.projection={method=\"mass-spring\",sweeps=3}",
            "double_layer.paper.projection.sweeps",
            "mass-spring",
        ),
        (
            "double_layer.paper.projection.stiffness=5",
            "double_layer.paper.projection.stiffness",
            "successive",
        ),
        (
            "heat_source.ball.rate=0",
            "heat_source.ball.rate",
            "larger than 0",
        ),
        (
            "constraint.corner.shell=\"papr\"",
            "constraint.corner.shell",
            "no double layer",
        ),
        (
            "constraint.corner.axes=\"x\"",
            "constraint.corner.axes",
            "no meaning",
        ),
    ] {
        let error = build(&[overrides]).unwrap_err();
        assert_eq!(error.path, path, "{overrides}: {error}");
        assert!(error.to_string().contains(words), "{overrides}: {error}");
    }
}

#[test]
fn meshes_of_files_are_checked_and_shells_do_not_stand_beside() {
    let mesh = |file: &str| {
        let scene = SCENE.replace(
            "mesh.grid = { size = [0.3, 0.3], cells = [8, 8] }",
            &format!("mesh.file = \"{file}\""),
        );
        let file = SceneFile::parse("scene.toml", &scene, &[])?;
        Scene::build(&file, &files())
    };
    assert_eq!(
        mesh("quad.obj").unwrap().model.double_layers[0]
            .setup
            .shell
            .num_springs(),
        10
    );
    let error = mesh("folded.obj").unwrap_err();
    assert!(error.to_string().contains("folded"), "{error}");
    let error = mesh("crossed.obj").unwrap_err();
    assert!(error.to_string().contains("crosses itself"), "{error}");
    assert_eq!(error.path, "double_layer.paper.mesh");
    let shell = "[[shell]]\nname = \"cloth\"\nmaterial = \"cotton\"\nmesh.grid = { size = [1, 1], cells = [2, 2] }\n";
    let both = SceneFile::parse("scene.toml", &format!("{SCENE}{shell}"), &[]).unwrap_err();
    assert_eq!(both.path, "shell.0");
    let alone = format!(
        "{shell}time = {{ end = 1, dt = 0.1 }}\n[[heat_source]]\nname = \"h\"\ntemperature = 900\nrate = 1\n"
    );
    assert!(SceneFile::parse("scene.toml", &alone, &[]).is_err());
}

#[test]
fn a_texture_on_a_mesh_without_coordinates_has_no_place() {
    let scene = SCENE.replace(
        "mesh.grid = { size = [0.3, 0.3], cells = [8, 8] }",
        "mesh.file = \"quad.obj\"",
    );
    let texture = ["double_layer.paper.burning.diffusivity_texture=\"whole.png\"".to_owned()];
    let file = SceneFile::parse("scene.toml", &scene, &texture).unwrap();
    let mut files = files();
    let png = include_bytes!("../../scenes/hot-sphere/patches.png");
    files.0.push(("whole.png", png.to_vec()));
    let error = Scene::build(&file, &files).unwrap_err();
    assert_eq!(error.path, "double_layer.paper.burning.diffusivity_texture");
    assert!(error.to_string().contains("vt"), "{error}");
}

#[test]
fn everything_may_burn_and_nothing_may_ignite() {
    let end = |overrides: &[&str]| {
        let mut simulation = Simulation::new(build(overrides).unwrap().model).unwrap();
        for _ in 0..60 {
            simulation.step(0.01).unwrap();
        }
        let figures = simulation.burning_measures();
        assert!(
            figures.iter().all(|(_, value)| value.is_finite()),
            "{figures:?}"
        );
        let positions = simulation.display_positions();
        assert!(
            positions
                .iter()
                .flat_map(|x| x.iter())
                .all(|x| x.is_finite())
        );
        (simulation, figures.into_iter().collect::<BTreeMap<_, _>>())
    };
    let (burnt, figures) = end(&[
        "double_layer.paper.temperature=1500",
        "double_layer.paper.burning.cooling_rate=0",
    ]);
    assert_eq!([figures["kept_area"], figures["pieces"]], [0.0, 0.0]);
    let part = &burnt.present_parts().unwrap()[0];
    assert_eq!((part.num_vertices, part.faces.len()), (0, 0));
    let (whole, figures) = end(&["heat_source.ball.temperature=450"]);
    assert_eq!(
        [figures["kept_area"], figures["mean_mass_ratio"]],
        [1.0, 1.0]
    );
    assert!(figures["highest_temperature"] > 350.0, "{figures:?}");
    assert_eq!(whole.present_parts().unwrap()[0].faces.len(), 4 * 64);
}

#[test]
fn a_run_from_any_checkpoint_has_the_same_bits() {
    let mut through = simulation();
    for _ in 0..40 {
        through.step(0.01).unwrap();
    }
    let mut paused = simulation();
    for _ in 0..40 {
        paused.step(0.01).unwrap();
        let checkpoint = Checkpoint {
            version: String::new(),
            scene_text: String::new(),
            bodies: Vec::new(),
            snapshot: paused.snapshot(),
            totals: Totals::default(),
        };
        let again = Checkpoint::from_bytes(&checkpoint.to_bytes()).unwrap();
        paused = simulation();
        paused.restore(&again.snapshot).unwrap();
    }
    assert_eq!(through.snapshot(), paused.snapshot());
    let kept = through.double_layers()[0].measures().kept_area;
    assert!(kept < 0.95, "the ball has burnt a part: {kept}");
    let mut wrong = through.snapshot();
    wrong.double_layers[0].temperatures.pop();
    assert!(through.restore(&wrong).is_err());
    assert_eq!(through.snapshot(), paused.snapshot());
}

#[test]
fn frames_have_the_faces_that_are_left() {
    let mut simulation = simulation();
    let whole = simulation.present_parts().unwrap();
    assert_eq!(whole[0].faces.len(), 4 * 64);
    for _ in 0..60 {
        simulation.step(0.01).unwrap();
    }
    let parts = simulation.present_parts().unwrap();
    let faces = parts.iter().map(|part| part.faces.len()).sum::<usize>();
    assert!(parts[0].faces.len() < 4 * 64);
    let vertices: usize = parts.iter().map(|part| part.num_vertices).sum();
    assert_eq!(simulation.display_positions().len(), vertices);
    let fields = simulation.face_fields();
    let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["temperature", "mass_ratio"]);
    assert!(fields.iter().all(|(_, values)| values.len() == faces));
}

#[test]
fn a_frame_with_faces_of_its_own_is_read_back_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    let part = |vertices: usize, faces: usize| Part {
        name: "paper".to_owned(),
        kind: PartKind::Shell,
        thickness: 1e-3,
        vertices: 0..vertices,
        faces: 0..faces,
        solid: None,
    };
    let manifest = Manifest {
        parts: vec![part(4, 2)],
        ..Manifest::default()
    };
    let mut writer =
        ResultWriter::create(folder.path(), &manifest, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let frame = Frame {
        positions: vec![koiter::Vec3::x(); 3],
        topology: Some(FrameTopology {
            parts: vec![part(3, 1)],
            faces: vec![[0, 2, 1]],
        }),
        ..Frame::default()
    };
    writer.write_frame(&frame).unwrap();
    let burnt = Frame {
        topology: Some(FrameTopology {
            parts: vec![part(0, 0)],
            faces: vec![],
        }),
        ..Frame::default()
    };
    writer.write_frame(&burnt).unwrap();
    let mut wrong = frame.clone();
    wrong.topology.as_mut().unwrap().faces[0][0] = 7;
    assert!(writer.write_frame(&wrong).is_err(), "a face of no vertex");
    let reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!(reader.frame(0).unwrap(), frame);
    assert_eq!(reader.faces_in(&frame), [[0, 2, 1]]);
    assert_eq!(reader.parts_in(&frame)[0].name, "paper");
    assert!(reader.frame(1).unwrap().positions.is_empty());
}
