//! Bézier shells from the command line: meshes from files, what is wrong with them, and what can be done with a result whose
//! faces change.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

fn koiter(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
    let command = command.current_dir(folder).args(arguments);
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().expect("the binary runs");
    let [stdout, stderr] = [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    (status.code(), stdout, stderr)
}

/// A tube about the z axis as an OBJ file, moved along it; in one place a triangle can be turned round.
fn tube(cells: [usize; 2], up: f64, turned: Option<usize>) -> String {
    let [around, along] = cells;
    let mut text = String::new();
    for row in 0..=along {
        for column in 0..around {
            let (sin, cos) = (TAU * column as f64 / around as f64).sin_cos();
            let z = up - 0.02 + 0.04 * row as f64 / along as f64;
            writeln!(text, "v {} {} {z}", 0.01 * cos, 0.01 * sin).unwrap();
        }
    }
    let vertex = |row: usize, column: usize| row * around + column % around + 1;
    for cell in 0..around * along {
        let (row, column) = (cell / around, cell % around);
        let [a, b] = [vertex(row, column), vertex(row, column + 1)];
        let [c, d] = [vertex(row + 1, column + 1), vertex(row + 1, column)];
        match turned == Some(cell) {
            false => writeln!(text, "f {a} {b} {c}").unwrap(),
            true => writeln!(text, "f {b} {a} {c}").unwrap(),
        }
        writeln!(text, "f {a} {c} {d}").unwrap();
    }
    text
}

const SCENE: &str = r#"title = "Tube"
time = { end = 0.16, dt = 0.02 }
gravity = [0, 0, 0]

[[bezier_shell]]
name = "tube"
mesh.file = "coarse.obj"
surface.mesh = { file = "fine.obj" }
material = { young = 5e5, poisson = 0.4, density = 1100 }
thickness = 2e-4
damping = 20

[[constraint]]
name = "foot"
shell = "tube"
select.box = { max = [1, 1, -0.0199] }
clamp = true

[[procedure]]
name = "incision"
at = 0.04
cut = { shell = "tube", path = [[0.01, 0, -0.011], [0.01, 0, 0.011]] }

[[procedure]]
name = "hooks"
at = 0.04
open = { cut = "incision", force = 1e-4, ramp = 0.1, until = 1 }
"#;

fn folder_with_meshes() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("coarse.obj", &tube([10, 12], 0.0, None));
    write("fine.obj", &tube([24, 30], 0.0, None));
    write("far.obj", &tube([24, 30], 0.5, None));
    write("turned.obj", &tube([10, 12], 0.0, Some(40)));
    write("lonely.obj", &(tube([10, 12], 0.0, None) + "v 1 2 3\n"));
    write("empty.obj", "");
    folder
}

#[test]
fn a_fine_mesh_from_a_file_is_carried_cut_and_written() {
    let folder = folder_with_meshes();
    let in_folder = |arguments: &[&str]| koiter(folder.path(), arguments);
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let (status, report, errors) = in_folder(&["check", "scene.toml"]);
    assert_eq!(status, Some(0), "{errors}");
    assert!(report.contains("a mesh of its own"), "{report}");
    let run = ["run", "scene.toml", "--out", "out", "--no-film"];
    let (status, report, errors) = in_folder(&run);
    assert_eq!(status, Some(0), "{errors}");
    assert!(report.contains("sleeping pairs"), "{report}");
    let (status, report, errors) = in_folder(&["check", "--result", "out"]);
    assert_eq!(status, Some(0), "{report}{errors}");
    let done: [&[&str]; 5] = [
        &["plot", "out", "-o", "figures.svg"],
        &["render", "out", "-o", "end.png", "--size", "160x120"],
        &["export", "out", "--to", "vtkhdf", "-o", "out.vtkhdf"],
        &[
            "export", "out", "--to", "glb", "--frame", "8", "-o", "end.glb",
        ],
        &["export", "out", "--to", "obj", "-o", "end.obj"],
    ];
    for arguments in done {
        let (status, _, errors) = in_folder(arguments);
        assert_eq!(status, Some(0), "{arguments:?}: {errors}");
    }
    // What cannot be is said.
    let refused: [(&[&str], &str); 3] = [
        (
            &["export", "out", "--to", "npz", "-o", "out.npz"],
            "faces change from frame to frame",
        ),
        (
            &["render", "out", "-o", "a.png", "--color", "mean_curvature"],
            "it has: strain",
        ),
        (&["modes", "scene.toml"], "no [[shell]]"),
    ];
    for (arguments, words) in refused {
        let (status, _, errors) = in_folder(arguments);
        assert_eq!(status, Some(2), "{arguments:?}: {errors}");
        assert!(errors.contains(words), "{errors}");
    }
}

#[test]
fn what_is_wrong_with_a_mesh_or_a_path_is_told_with_its_place() {
    let folder = folder_with_meshes();
    let path = "[[0.01, 0, -0.011], [0.01, 0, 0.011]]";
    let cases = [
        ("\"fine.obj\"", "\"far.obj\"", "bring the two meshes to one"),
        (
            "\"fine.obj\"",
            "\"empty.obj\"",
            "bezier_shell.tube.surface.mesh",
        ),
        ("\"coarse.obj\"", "\"turned.obj\"", "reverse one of them"),
        (
            "\"coarse.obj\"",
            "\"none.obj\"",
            "bezier_shell.tube.mesh.file",
        ),
        // Beyond the end of the tube, through its inside, back to where it began, within an element.
        (
            path,
            "[[0.01, 0, 0], [0.01, 0, 0.2]]",
            "from the shell, more than",
        ),
        (
            path,
            "[[0.01, 0, 0], [-0.01, 0, 0.01]]",
            "the path leaves the surface at",
        ),
        (
            path,
            "[[0.01, 0, 0], [0, 0.01, 0], [0.01, 0, 0]]",
            "make it longer",
        ),
        (path, "[[0.01, 0, 0], [0.01, 0, 1e-5]]", "make it longer"),
    ];
    for (from, to, words) in cases {
        assert!(SCENE.contains(from), "{from}");
        let scene = folder.path().join("scene.toml");
        std::fs::write(scene, SCENE.replacen(from, to, 1)).unwrap();
        for arguments in [
            &["check", "scene.toml"][..],
            &["run", "scene.toml", "--no-film"],
        ] {
            let (status, _, errors) = koiter(folder.path(), arguments);
            assert_eq!(status, Some(2), "{to}: {errors}");
            // Lines are wrapped: words may be apart.
            let errors = errors.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(errors.replace("│ ", "").contains(words), "{to}: {errors}");
        }
    }
    // A vertex without elements is left out, and a fine mesh may be moved far where that is asked for: both are told.
    let far = "\"far.obj\" }\nsurface.reach = 1.0\ncontact_thickness = 0";
    for (from, to, words) in [
        ("\"coarse.obj\"", "\"lonely.obj\"", "dropped 1 vertices"),
        (
            "\"fine.obj\" }",
            far,
            "was moved onto the elements by up to 5.000e-1 m",
        ),
    ] {
        let text = SCENE.replacen(from, to, 1) + "\n[contact]\nenabled = false\n";
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        let (status, _, errors) = koiter(folder.path(), &["check", "scene.toml"]);
        assert_eq!(status, Some(0), "{errors}");
        assert!(errors.contains(words), "{errors}");
    }
}
