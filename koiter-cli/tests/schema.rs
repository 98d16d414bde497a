//! `koiter schema` agrees with the scenes that ship and with the templates, by a validator that is not ours.
//!
//! Needs a Python with the package `jsonschema`: `KOITER_PYTHON` names the interpreter (default `python3`). Without it the
//! test passes and says so, unless `KOITER_REQUIRE_JSONSCHEMA=1`.

use std::path::{Path, PathBuf};
use std::process::Command;

fn run(program: &str, arguments: &[&str]) -> (bool, String, String) {
    let output = Command::new(program).args(arguments).output();
    output.map_or((false, String::new(), String::new()), |output| {
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        (
            output.status.success(),
            text(&output.stdout),
            text(&output.stderr),
        )
    })
}

/// What the validator says of a scene: empty if nothing is wrong.
fn complaints(python: &str, schema: &Path, scene: &Path) -> String {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/validate_scene.py");
    let arguments =
        [script, &schema.to_string_lossy(), &scene.to_string_lossy()].map(ToOwned::to_owned);
    let (done, stdout, stderr) = run(python, &arguments.each_ref().map(String::as_str));
    assert!(done, "{stderr}");
    stdout
}

#[test]
fn scenes_and_templates_are_valid_and_mistakes_are_not() {
    let python = std::env::var("KOITER_PYTHON").unwrap_or_else(|_| "python3".to_string());
    if !run(&python, &["-c", "import jsonschema, tomllib"]).0 {
        let required = std::env::var("KOITER_REQUIRE_JSONSCHEMA").is_ok_and(|value| value == "1");
        assert!(
            !required,
            "KOITER_REQUIRE_JSONSCHEMA=1, but {python} cannot import jsonschema"
        );
        eprintln!(
            "skipped: {python} has no jsonschema (pip install jsonschema, or set KOITER_PYTHON)"
        );
        return;
    }
    let koiter = env!("CARGO_BIN_EXE_koiter");
    let folder = tempfile::tempdir().unwrap();
    let schema = folder.path().join("schema.json");
    let (done, text, _) = run(koiter, &["schema"]);
    assert!(done);
    std::fs::write(&schema, text).unwrap();

    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut scenes: Vec<PathBuf> = std::fs::read_dir(shipped)
        .unwrap()
        .map(|entry| entry.unwrap().path().join("scene.toml"))
        .collect();
    let templates = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates");
    scenes.extend(
        std::fs::read_dir(templates)
            .unwrap()
            .map(|entry| entry.unwrap().path()),
    );
    assert!(scenes.len() >= 9, "{scenes:?}");
    for scene in &scenes {
        assert_eq!(
            complaints(&python, &schema, scene),
            "",
            "{}",
            scene.display()
        );
    }

    let sound = std::fs::read_to_string(&scenes[0]).unwrap();
    let wrong = folder.path().join("wrong.toml");
    for (line, words) in [
        ("no_such_key = 1", "no_such_key"),
        ("gravity = [0.0, 0.0]", "too short"),
        ("integrator = \"euler\"", "euler"),
        ("solver.max_iterations = \"many\"", "integer"),
        (
            "shell = [{ name = \"a\", material = \"coton\", mesh = {} }]",
            "coton",
        ),
        ("output = { color = \"red\" }", "red"),
    ] {
        let key = line.split([' ', '.']).next().unwrap();
        // In place of the key and of all tables, which come after the top-level keys.
        let head: Vec<&str> = sound
            .lines()
            .take_while(|line| !line.starts_with('['))
            .collect();
        let head: Vec<&str> = head
            .into_iter()
            .filter(|line| !line.starts_with(key))
            .collect();
        std::fs::write(&wrong, format!("{}\n{line}\n", head.join("\n"))).unwrap();
        let text = complaints(&python, &schema, &wrong);
        assert!(text.contains(words), "{line}: {text}");
    }
}
