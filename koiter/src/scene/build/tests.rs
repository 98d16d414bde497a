use super::*;
use crate::mesh::SurfaceOptions;
use crate::scene::placement::{NoFiles, UnreadableMesh};
use crate::scene::schedule::Schedule;

const SCENE: &str = r#"
time = { end = 1.0, dt = 0.1 }
output.every_seconds = 0.25
[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }
mesh.translate = [0, 0, 1]
[[obstacle]]
name = "ball"
sphere = { radius = 0.3 }
translate = [0, 0, 0.5]
[[obstacle]]
name = "lid"
box = { size = [1, 1, 0.1] }
motion.translate = [[0, [0, 0, 0]], [1, [0, 0, -1]]]
[[constraint]]
name = "edge"
shell = "cloth"
select.box = { min = [0.5, -1, 0], max = [1, 1, 2] }
axes = "xz"
[[probe]]
name = "middle"
quantity = "displacement"
shell = "cloth"
select.nearest = [0, 0, 1]
[[probe]]
name = "pull"
quantity = "reaction"
constraint = "edge"
"#;

struct Files;

impl MeshSource for Files {
    fn read(&self, file: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        let unreadable = |message: String| UnreadableMesh {
            message,
            help: Some("look again".into()),
        };
        let faces = match file {
            "crossed.obj" => vec![[0, 1, 2], [1, 2, 3]],
            "large.obj" => vec![[0, 1, 2], [1, 3, 2]],
            _ => return Err(unreadable(format!("{file}: no such file"))),
        };
        let scale = if file == "large.obj" { 500.0 } else { 1.0 };
        let positions = positions.map(|x| Vec3::from(x) * scale).to_vec();
        Surface::new(positions, faces, options).map_err(|error| unreadable(error.to_string()))
    }

    fn read_text(&self, file: &str) -> Result<String, UnreadableMesh> {
        let text = match file {
            "faces.json" => r#"{"thickness": [1e-3, 3e-3], "density": [500, 100]}"#,
            "three.json" => r#"{"thickness": [1e-3, 3e-3, 1e-3]}"#,
            "negative.json" => r#"{"young": [1e6, -2]}"#,
            "slip.json" => "{\n\"thicknes\": [1]}",
            "form.json" => r#"{"first_form": [[1, 2, 1], [1, 0, 1]]}"#,
            _ => "",
        };
        Ok(text.to_owned())
    }
}

fn build(text: &str) -> Result<Scene, SceneError> {
    Scene::build(&SceneFile::parse("scene.toml", text, &[])?, &Files)
}

#[test]
fn a_scene_becomes_a_model() {
    let scene = build(SCENE).unwrap();
    let shell = &scene.model.shells[0];
    let [steps] = scene.timeline.phases() else {
        panic!("{:?}", scene.timeline)
    };
    assert_eq!((steps.steps, steps.frame_steps), (10, 3));
    assert_eq!((shell.youngs_modulus, shell.thickness), (1e6, 1e-3));
    assert!(shell.surface.positions.iter().all(|x| x.z == 1.0));
    assert_eq!(shell.rest_positions, shell.surface.positions);
    let ObstacleShape::Sphere { center, radius } = &scene.model.obstacles[0].shape else {
        panic!("the ball is a sphere");
    };
    assert_eq!((*center, *radius), (Vec3::new(0.0, 0.0, 0.5), 0.3));
    let falling = Schedule {
        times: vec![0.0, 1.0],
        values: vec![Vec3::zeros(), -Vec3::z()],
    };
    assert_eq!(scene.model.obstacles[1].motion.translation, Some(falling));
    let constraint = &scene.model.constraints[0];
    assert_eq!(
        (constraint.vertices.len(), constraint.axes),
        (5, [true, false, true])
    );
    assert_eq!(
        scene.probes[0].columns(),
        ["middle.x", "middle.y", "middle.z"]
    );
    assert!(matches!(scene.probes[1].target, ProbeTarget::Reaction(0)));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn an_end_of_whole_steps_takes_exactly_these() {
    for (end, dt, steps) in [
        (0.3, 0.1, 3),
        (1.0, 0.3, 4),
        (0.8, 0.02, 40),
        (0.01, 0.02, 1),
    ] {
        let text = SCENE.replace("end = 1.0, dt = 0.1", &format!("end = {end}, dt = {dt}"));
        assert_eq!(
            build(&text).unwrap().timeline.num_steps(),
            steps,
            "{end} / {dt}"
        );
    }
}

#[test]
fn mistakes_that_only_meshes_show_point_at_their_line() {
    let grid = "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }";
    let cases = [
        (
            grid,
            "mesh.file = \"a.obj\"",
            "shell.cloth.mesh.file",
            (7, "\"a.obj\""),
            "no such file",
        ),
        (
            grid,
            "mesh.file = \"crossed.obj\"",
            "shell.cloth.mesh.file",
            (7, "\"crossed.obj\""),
            "look again",
        ),
        (
            "cells = [4, 4]",
            "cells = [4, 0]",
            "shell.cloth.mesh.grid",
            (7, "{ size = [1.0, 1.0], cells = [4, 0] }"),
            "at least 1",
        ),
        (
            "size = [1, 1, 0.1]",
            "size = [1, 1, 0]",
            "obstacle.lid.box",
            (15, "{ size = [1, 1, 0] }"),
            "positive",
        ),
        (
            "min = [0.5, -1, 0]",
            "min = [0.6, -1, 0]",
            "constraint.edge.select",
            (20, "select"),
            "no vertices",
        ),
        (
            "select.nearest = [0, 0, 1]",
            "select.vertices = [99]",
            "probe.middle.select.vertices",
            (26, "[99]"),
            "vertex 99",
        ),
        (
            "select.nearest = [0, 0, 1]",
            "select.boundary = 1",
            "probe.middle.select.boundary",
            (26, "1"),
            "loop 1",
        ),
        (
            "mesh.translate",
            "rest_mesh.grid = { size = [1, 1], cells = [5, 4] }\nmesh.translate",
            "shell.cloth.rest_mesh",
            (8, "rest_mesh"),
            "30 vertices",
        ),
        (
            "box = { size = [1, 1, 0.1] }",
            "mesh.grid = { size = [1, 1], cells = [2, 2] }\ndeform = [{ time = 1, mesh.file = \"large.obj\" }]",
            "obstacle.lid.deform.0.mesh.file",
            (16, "\"large.obj\""),
            "'large.obj' mesh must have the triangles of the obstacle's",
        ),
    ];
    for (from, to, path, place, words) in cases {
        assert!(SCENE.contains(from), "{from}");
        let error = build(&SCENE.replacen(from, to, 1)).unwrap_err();
        let said = format!(
            "{} | {}",
            error.message,
            error.help.as_deref().unwrap_or("")
        );
        let location = error.location.unwrap();
        assert_eq!(error.path, path, "{said}");
        assert_eq!((location.line(), location.text()), place, "{said}");
        assert!(said.contains(words), "{said}");
    }
    let file = SceneFile::parse(
        "s",
        &SCENE.replacen(grid, "mesh.file = \"large.obj\"", 1),
        &[],
    )
    .unwrap();
    assert!(Scene::build(&file, &NoFiles).is_err());
}

#[test]
fn implausible_numbers_are_warned_about_not_refused() {
    let grid = "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }";
    let cases = [
        (
            "\"cotton\"",
            "{ preset = \"cotton\", young = 10 }",
            "shell.cloth.material.young",
            "pascals",
        ),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", young = 7e13 }",
            "shell.cloth.material.young",
            "diamond",
        ),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", density = 0.2 }",
            "shell.cloth.material.density",
            "1 g/cm³",
        ),
        (
            "\"cotton\"",
            "\"cotton\"\nthickness = 0.1",
            "shell.cloth.thickness",
            "1 mm is 1e-3",
        ),
        (
            "\"cotton\"",
            "\"cotton\"\nbending = \"ds-2nd\"",
            "shell.cloth.bending",
            "use bac for results",
        ),
    ];
    for (from, to, path, words) in cases {
        let scene = build(&SCENE.replacen(from, to, 1)).unwrap();
        let [warning] = &scene.warnings[..] else {
            panic!("{:?}", scene.warnings)
        };
        assert_eq!(warning.path, path);
        assert!(
            warning.help.as_ref().unwrap().contains(words),
            "{warning:?}"
        );
        assert!(warning.location.is_some());
    }
    // Quadratic bending keeps the curvature of a mesh that has none.
    let flat = "\"cotton\"\nbending = \"qb-pl\"\nrest = \"mesh\"";
    let scene = build(&SCENE.replacen("\"cotton\"", flat, 1)).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let text = "time = { end = 1, dt = 1 }\n[[shell]]\nname = \"a\"\nmaterial = \"cotton\"\nmesh.file = \"large.obj\"\n";
    // 500 m for any shell, 50 m for one of a millimetre from a file; not if a unit or a scale was thought of.
    for (more, is_warned) in [
        ("", true),
        ("mesh.scale = 0.1", true),
        ("mesh.scale = 0.001", false),
        ("mesh.units = \"mm\"", false),
    ] {
        let scene = build(&format!("{text}{more}")).unwrap();
        assert_eq!(
            !scene.warnings.is_empty(),
            is_warned,
            "{more}: {:?}",
            scene.warnings
        );
    }
    let scene = build(text).unwrap();
    assert!(
        scene.warnings[0]
            .help
            .as_ref()
            .unwrap()
            .contains("units = \"mm\""),
        "{:?}",
        scene.warnings
    );
    assert!(SCENE.contains(grid));
}

#[test]
fn a_static_shell_that_nothing_holds_is_warned_about() {
    let free = |more: &str| {
        let text = format!(
            "time = {{ end = 1, dt = 1 }}\nintegrator = \"quasi-static\"\n[[shell]]\nname = \"a\"\n\
             material = \"cotton\"\nmesh.grid = {{ size = [1.0, 1.0], cells = [2, 2] }}\n{more}"
        );
        build(&text).unwrap()
    };
    let messages = |scene: &Scene| -> Vec<String> {
        let warnings = scene.warnings.iter();
        warnings.map(|warning| warning.message.clone()).collect()
    };
    let constraint = |axes: &str| {
        format!("[[constraint]]\nshell = \"a\"\nselect.vertices = [0]\naxes = \"{axes}\"\n")
    };
    let text = |along| {
        format!(
            "nothing holds shell 'a' along {along}: there is no static equilibrium, or more than one"
        )
    };
    assert_eq!(messages(&free("")), [text("x, y, z")]);
    assert_eq!(messages(&free(&constraint("z"))), [text("x, y")]);
    assert!(free(&constraint("xyz")).warnings.is_empty());
    // It may come to rest on the floor.
    let on_floor = free("[[obstacle]]\nname = \"floor\"\nplane = { point = [0, 0, -1] }\n");
    assert!(on_floor.warnings.is_empty());
    assert_eq!(
        on_floor.model.free_parts()[0].to_string(),
        "shell 'a' along x, y, z"
    );
}

/// Two triangles of half a square metre.
const SQUARE: &str = r#"
time = { end = 1.0, dt = 0.1 }
integrator = "implicit-euler"
[[shell]]
name = "cloth"
material = "cotton"
mesh.file = "large.obj"
mesh.scale = 2e-3
"#;

#[test]
fn values_of_faces_reach_masses_and_sections() {
    let text = format!("{SQUARE}faces = \"faces.json\"");
    let shell = &build(&text).unwrap().model.shells[0];
    assert_eq!((shell.thickness, shell.density), (2e-3, 300.0));
    let masses = [0, 1].map(|f| shell.face_thickness(f) * shell.face_density(f) * 0.5);
    assert_eq!(masses, [0.25, 0.15]);
    let section = shell.compose().unwrap().section;
    let rigidities = [0, 1].map(|f| section.flexural_rigidity(f));
    assert!((rigidities[1] / rigidities[0] - 27.0).abs() < 1e-12);
}

#[test]
fn materials_and_rest_forms_that_cannot_be_are_refused_at_their_key() {
    let layers = |poisson: &str| {
        format!(
            "[shell.material]\nmodel = \"layered\"\npoisson = 0.3\ndensity = 1\n\
             layers = [{{ thickness = 1e-3, young = 1e6{poisson} }}]"
        )
    };
    let cases = [
        (
            "faces = \"three.json\"",
            "cloth.faces",
            "has 3 values, but the mesh has 2 faces | each list of the file has one value a face",
        ),
        (
            "faces = \"negative.json\"",
            "cloth.faces",
            "'young' of face 1 is -2",
        ),
        (
            "faces = \"slip.json\"",
            "cloth.faces",
            "did you mean 'thickness'",
        ),
        (
            "faces = \"form.json\"",
            "cloth.faces",
            "face 0 is not positive definite",
        ),
        (
            "rest_curvature = [1, 0]\nbending = \"ds-theta\"",
            "cloth.bending",
            "rest curvature",
        ),
        (
            "rest_stretch = [0, 1]",
            "cloth.rest_stretch.0",
            "rest_stretch[0] must be larger than 0",
        ),
        (
            "rest_strech = [1, 1]",
            "cloth.rest_strech",
            "did you mean 'rest_stretch'",
        ),
        (
            "material.shear = 1e6",
            "cloth.material.shear",
            "model = \"orthotropic\"",
        ),
        (
            "material.model = \"orthotropic\"",
            "cloth.material",
            "'young_across' is missing",
        ),
        (
            "material.model = \"neo-hokean\"",
            "cloth.material.model",
            "did you mean 'neo-hookean'",
        ),
        (
            "material.axis = [0, 0, 1]\nrest_curvature = [1, 0]",
            "cloth.material.axis",
            "upright on face 0",
        ),
        (
            &layers(", poisson = 0.2"),
            "cloth.material.layers.0.poisson",
            "must share",
        ),
        (
            "material.model = \"orthotropic\"\nmaterial.young_across = 1e5\nmaterial.shear = 1e4\nmaterial.poisson = 9",
            "cloth.material",
            "Poisson's ratio must lie between",
        ),
    ];
    for (keys, path, words) in cases {
        let base = match keys.contains("material") {
            true => SQUARE.replace(
                "material = \"cotton\"",
                match keys.contains("layered") {
                    true => "",
                    false => "material.preset = \"cotton\"",
                },
            ),
            false => SQUARE.to_owned(),
        };
        let error = build(&format!("{base}{keys}")).unwrap_err();
        let said = format!(
            "{} | {}",
            error.message,
            error.help.as_deref().unwrap_or("")
        );
        assert!(said.contains(words), "{keys}: {said}");
        assert!(
            error.path.starts_with(&format!("shell.{path}")),
            "{keys}: {}",
            error.path
        );
        assert!(error.location.is_some(), "{keys}");
    }
    assert!(
        build(&format!(
            "{}{}",
            SQUARE.replace("material = \"cotton\"", ""),
            layers("")
        ))
        .is_ok()
    );
}

#[test]
fn a_path_by_arc_length_is_no_phase() {
    let text = "contact.enabled = false\n[[shell]]\nname = \"a\"\nmaterial = \"cotton\"\n\
                mesh.grid = { size = [1.0, 1.0], cells = [2, 2] }\n\
                [[phase]]\nname = \"path\"\nend = 1\ndt = 1\nintegrator = \"arc-length\"\n";
    let error = build(text).unwrap_err();
    assert_eq!((error.kind, error.path.as_str()), (Kind::Conflict, "phase"));
    assert!(error.message.contains("no phases"), "{}", error.message);
}
