//! `koiter fit`: what a scene did with other values is found again, with its uncertainty.

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A strip that is clamped at one end; one static step a load.
const STRIP: &str = r#"
integrator = "quasi-static"
time = { end = 1.0, dt = 0.25 }
gravity_scale = [[0.0, 0.0], [1.0, 1.0]]
contact.enabled = false

[[shell]]
name = "strip"
material = { young = 4.7e7, poisson = 0.0, density = 500.0 }
thickness = 1e-3
mesh.grid = { size = [0.2, 0.04], cells = [10, 2], diagonals = "checkerboard" }

[[constraint]]
shell = "strip"
select.box = { max = [-0.079, 1.0, 1.0] }
clamp = true

[[probe]]
name = "tip"
quantity = "displacement"
shell = "strip"
select.box = { min = [0.099, -1.0, -1.0] }
"#;

fn koiter(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
    command
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn fit(folder: &Path, more: &[&str]) -> Output {
    let arguments = ["fit", "strip.toml", "--measured", "curve.csv", "--json"];
    koiter(folder, &[&arguments[..], more].concat())
}

fn found(output: &Output) -> Value {
    assert!(output.status.success(), "{}", errors(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs the strip with a Young's modulus of 3e7 Pa and writes how its tip sinks, with some noise, to `curve.csv`.
fn measure(folder: &Path, noise: f64) {
    std::fs::write(folder.join("strip.toml"), STRIP).unwrap();
    let set = "shell.strip.material.young=3e7";
    let run = koiter(
        folder,
        &[
            "run",
            "strip.toml",
            "--set",
            set,
            "--out",
            "out",
            "--no-film",
            "--quiet",
        ],
    );
    assert!(run.status.success(), "{}", errors(&run));
    let probes = std::fs::read_to_string(folder.join("out/probes.csv")).unwrap();
    let (heading, rows) = probes.split_once('\n').unwrap();
    let column = heading
        .split(',')
        .position(|name| name == "tip.z")
        .expect(heading);
    let mut curve = "time,tip.z\n".to_owned();
    for (number, row) in rows.lines().enumerate().skip(1) {
        let values: Vec<f64> = row.split(',').map(|word| word.parse().unwrap()).collect();
        let error = noise * [1.0, -1.0, -1.0, 1.0][number % 4];
        writeln!(curve, "{},{}", values[0], values[column] + error).unwrap();
    }
    std::fs::write(folder.join("curve.csv"), curve).unwrap();
}

#[test]
fn a_modulus_is_found_from_how_a_strip_droops() {
    let folder = tempfile::tempdir().unwrap();
    measure(folder.path(), 0.0);
    let json = found(&fit(
        folder.path(),
        &["--vary", "shell.strip.material.young=8e7"],
    ));
    let value = json["parameters"][0]["value"].as_f64().unwrap();
    // As exactly as equilibria are found: their tolerance is what is left of the curve.
    assert!((value / 3e7 - 1.0).abs() < 1e-4, "{json}");
    assert_eq!(json["converged"], true);
    measure(folder.path(), 1e-3);
    let json = found(&fit(
        folder.path(),
        &["--vary", "shell.strip.material.young=2e7"],
    ));
    let interval = &json["parameters"][0]["interval_95"];
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
    // A millimetre of some ten centimetres, four times: a few per cent.
    assert!(
        low < 3e7 && 3e7 < high && high / low < 1.2 && high / low > 1.005,
        "{json}"
    );
}

#[test]
fn a_frequency_tells_a_modulus() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("strip.toml"), STRIP).unwrap();
    let set = [
        "modes",
        "strip.toml",
        "--set",
        "gravity=[0,0,0]",
        "--count",
        "1",
        "--json",
    ];
    let modes: Value = serde_json::from_slice(&koiter(folder.path(), &set).stdout).unwrap();
    let text = modes.to_string();
    let frequency = modes["modes"][0]["frequency"].as_f64().expect(&text);
    // Frequencies go with the root of the modulus: one twice as high is four times the modulus.
    let curve = format!("mode,frequency\n1,{}\n", 2.0 * frequency);
    std::fs::write(folder.path().join("curve.csv"), curve).unwrap();
    let more = [
        "--set",
        "gravity=[0,0,0]",
        "--vary",
        "shell.strip.material.young=1e8",
    ];
    let json = found(&fit(folder.path(), &more));
    let value = json["parameters"][0]["value"].as_f64().unwrap();
    assert!((value / (4.0 * 4.7e7) - 1.0).abs() < 1e-4, "{json}");
    assert_eq!(json["parameters"][0]["interval_95"], Value::Null);
}

#[test]
fn what_cannot_be_fitted_is_told() {
    let folder = tempfile::tempdir().unwrap();
    measure(folder.path(), 0.0);
    let young = "shell.strip.material.young=3e7";
    for (more, said) in [
        (&["--vary", "shell.strip.material.young"][..], "no '='"),
        (&["--vary", "shell.strip.material.young=-1"], "above 0"),
        (&["--vary", young, "--vary", young], "given twice"),
        (&["--vary", "shell.strip.material.yuong=1"], "unknown key"),
        (
            &["--vary", young, "--set", "time.end=0.5"],
            "from 0 to 0.5 s",
        ),
        (
            &["--vary", "shell.strip.friction=0.3"],
            "does not determine 'shell.strip.friction'",
        ),
    ] {
        let output = fit(folder.path(), more);
        let text = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {text}");
        assert!(text.contains(said), "{more:?}: {text}");
    }
    std::fs::write(folder.path().join("curve.csv"), "time,tpi.z\n1,2\n").unwrap();
    let text = errors(&fit(folder.path(), &["--vary", young]));
    assert!(text.contains("did you mean 'tip.z'?"), "{text}");
    std::fs::write(folder.path().join("curve.csv"), "time,tip.z\n1,x\n").unwrap();
    let text = errors(&fit(folder.path(), &["--vary", young]));
    assert!(text.contains("line 2 is not 2 finite numbers"), "{text}");
}
