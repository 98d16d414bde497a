//! Runs the program on a small scene.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program.
pub(crate) fn koiter(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
    command.args(arguments).output().expect("the binary runs")
}

/// Exit status.
pub(crate) fn status(output: &Output) -> i32 {
    output.status.code().expect("the program ends by itself")
}

/// What it printed.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it complained about.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A cloth that falls to the floor.
pub(crate) const SCENE: &str = r#"title = "Small"
time = { end = 0.1, dt = 0.02 }

[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }
mesh.translate = [0, 0, 1]

[[obstacle]]
name = "floor"
plane = {}

[[probe]]
name = "height"
quantity = "position"
shell = "cloth"
axis = "z"
"#;

/// Writes a scene to a folder; returns its path.
pub(crate) fn write_scene(folder: &Path, text: &str) -> String {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// Runs the small scene into `out` without pictures.
pub(crate) fn run_small(folder: &Path, more: &[&str]) -> Output {
    let scene = write_scene(folder, SCENE);
    let out = folder.join("out").to_string_lossy().into_owned();
    let mut arguments = vec!["run", &scene, "--out", &out, "--no-film"];
    arguments.extend(more);
    koiter(&arguments)
}
