//! The contract of the command line: exit statuses, streams, `--json`, messages.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn koiter(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
    command.args(arguments).output().expect("the binary runs")
}

fn status(output: &Output) -> i32 {
    output.status.code().expect("the program ends by itself")
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const SCENE: &str = r#"title = "Small"
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
fn write_scene(folder: &Path, text: &str) -> String {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// Runs the small scene into `out` without pictures.
fn run_small(folder: &Path, more: &[&str]) -> Output {
    let scene = write_scene(folder, SCENE);
    let out = folder.join("out").to_string_lossy().into_owned();
    let mut arguments = vec!["run", &scene, "--out", &out, "--no-film"];
    arguments.extend(more);
    koiter(&arguments)
}

#[test]
fn help_has_examples_for_every_verb() {
    for verb in [&[][..], &["run"], &["check"], &["render"], &["export"]] {
        let output = koiter(&[verb, &["--help"]].concat());
        assert_eq!(status(&output), 0);
        assert!(stdout(&output).contains("Examples:"), "{verb:?}");
        assert!(stderr(&output).is_empty());
    }
}

#[test]
fn wrong_arguments_have_status_2() {
    let cases: [&[&str]; 10] = [
        &[],
        &["fly"],
        &["run"],
        &["run", "sphere-drape", "--threads", "0"],
        &["run", "sphere-drape", "--threads", "65535"],
        &["run", "sphere-drape", "--film", "--no-film"],
        &["check", "sphere-drape", "--debug-mesh", "start.obj"],
        &["run", "sphere-drape", "--resume", "--restart"],
        &["render", "x", "-o", "a.png", "--size", "12"],
        &["export", "x", "--to", "docx", "-o", "a"],
    ];
    for arguments in cases {
        let output = koiter(arguments);
        assert_eq!(status(&output), 2, "{arguments:?}");
        assert!(
            stdout(&output).is_empty() && !stderr(&output).is_empty(),
            "{arguments:?}"
        );
    }
}

#[test]
fn a_scene_that_does_not_exist_is_answered_with_those_that_do() {
    let output = koiter(&["check", "spere-drape"]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("did you mean 'sphere-drape'?"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn mistakes_in_a_scene_point_at_line_and_column_with_help() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("material", "matrial", ":6:1]", "did you mean 'material'"),
        ("\"cotton\"", "\"coton\"", ":6:12]", "did you mean 'cotton'"),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", young = -1 }",
            ":6:41]",
            "larger than 0",
        ),
        ("dt = 0.02", "dt = 0", ":2:26]", "dt must be larger than 0"),
        ("dt = 0.02", "dt = ", ":2:", "not valid TOML"),
        (
            "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }",
            "mesh.file = \"no.obj\"",
            ":7:13]",
            "no.obj",
        ),
        (
            "axis = \"z\"",
            "select.vertices = [77]",
            ":18:19]",
            "vertex 77 does not exist",
        ),
    ];
    for (from, to, place, words) in cases {
        assert!(SCENE.contains(from), "{from}");
        let scene = write_scene(folder.path(), &SCENE.replacen(from, to, 1));
        for verb in ["check", "run"] {
            let output = koiter(&[verb, &scene]);
            let text = stderr(&output);
            assert_eq!(status(&output), 2, "{text}");
            assert!(
                text.contains(&format!("scene.toml{place}")) && text.contains(words),
                "{text}"
            );
            assert!(stdout(&output).is_empty());
        }
    }
}

#[test]
fn mistakes_in_an_override_point_into_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let output = koiter(&["check", &scene, "--set", "shell.cloth.bending=bca"]);
    let text = stderr(&output);
    assert_eq!(status(&output), 2);
    assert!(
        text.contains("[--set shell.cloth.bending=bca:1:21]"),
        "{text}"
    );
    assert!(text.contains("did you mean 'bac'?"), "{text}");
    let output = koiter(&["run", &scene, "--set", "output.camera=fornt"]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("unknown camera `fornt`"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn broken_scene_files_are_refused_in_one_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, b"title = \"a\"\n\xff\xfe").unwrap();
    let output = koiter(&["check", &path.to_string_lossy()]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("not UTF-8") && stderr(&output).contains("line 2"));
    let output = koiter(&[
        "check",
        &folder
            .path()
            .join("..")
            .join("nothing-here")
            .to_string_lossy(),
    ]);
    assert_eq!(status(&output), 2);
    std::fs::remove_file(&path).unwrap();
    let output = koiter(&["check", &folder.path().to_string_lossy()]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("cannot read the scene"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn check_prints_one_json_object() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let output = koiter(&["check", &scene, "--json"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["shells"][0]["faces"], 32);
    assert_eq!(report["steps"], 5);
    for key in [
        "vertices",
        "faces",
        "dofs",
        "energies",
        "estimated_memory_bytes",
        "hessian_nonzeros",
    ] {
        assert!(report.get(key).is_some(), "{key}");
    }
    assert!(stdout(&koiter(&["check", &scene])).contains("the scene is sound"));
}

#[test]
fn implausible_numbers_are_warned_about_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let output = koiter(&[
        "check",
        &scene,
        "--set",
        "shell.cloth.material.young=100",
        "--json",
    ]);
    assert_eq!(status(&output), 0);
    assert!(
        stderr(&output).contains("Young's modulus of 1e2 Pa is unusual"),
        "{}",
        stderr(&output)
    );
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn a_run_writes_frames_figures_probes_and_a_summary() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_small(folder.path(), &["--json"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert!(
        stderr(&output).is_empty(),
        "progress is for terminals: {}",
        stderr(&output)
    );
    let out = folder.path().join("out");
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: Value =
        serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary, written);
    assert_eq!(
        (
            &summary["steps"],
            &summary["converged"],
            &summary["intersections"]
        ),
        (&5.into(), &true.into(), &0.into())
    );
    assert!(summary["probes"]["height"].as_f64().unwrap() < 1.0);
    for key in [
        "time",
        "seconds",
        "seconds_by_part",
        "newton_iterations",
        "min_gap",
        "vertices",
        "faces",
        "dofs",
        "hessian_nonzeros",
        "peak_memory_bytes",
    ] {
        assert!(summary.get(key).is_some(), "{key}");
    }
    let stats = std::fs::read_to_string(out.join("stats.jsonl")).unwrap();
    assert_eq!(stats.lines().count(), 5);
    let line: Value = serde_json::from_str(stats.lines().last().unwrap()).unwrap();
    for key in [
        "step",
        "time",
        "dt",
        "newton_iterations",
        "energies",
        "seconds",
        "contacts",
        "min_gap",
        "line_search_steps",
        "converged",
    ] {
        assert!(line.get(key).is_some(), "{key}");
    }
    let probes = std::fs::read_to_string(out.join("probes.csv")).unwrap();
    assert_eq!(probes.lines().next(), Some("time,height"));
    assert_eq!(probes.lines().count(), 7);
    assert_eq!(std::fs::read_dir(out.join("frames")).unwrap().count(), 6);
    let manifest: Value =
        serde_json::from_slice(&std::fs::read(out.join("manifest.json")).unwrap()).unwrap();
    assert!(
        manifest["scene_text"]
            .as_str()
            .unwrap()
            .contains("cells = [4, 4]")
    );
}

#[test]
fn quiet_prints_nothing_and_until_ends_early() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_small(
        folder.path(),
        &["--quiet", "--until", "0.04", "--threads", "1"],
    );
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert!(stdout(&output).is_empty() && stderr(&output).is_empty());
    let stats = std::fs::read_to_string(folder.path().join("out/stats.jsonl")).unwrap();
    assert_eq!(stats.lines().count(), 2);
    let output = run_small(folder.path(), &["--until", "-1"]);
    assert_eq!(status(&output), 2);
}

#[test]
fn a_folder_with_other_content_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("thesis.tex"), "years of work").unwrap();
    let output = run_small(folder.path(), &[]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert!(out.join("thesis.tex").exists());
}

#[test]
fn a_run_ends_by_naming_its_pictures_and_render_and_export_read_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let scene = write_scene(folder.path(), SCENE);
    let result = path("out");
    let output = koiter(&["run", &scene, "--out", &result, "--until", "0.04"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let made: Vec<String> = stdout(&output)
        .lines()
        .filter_map(|line| line.strip_prefix("made: ").map(ToOwned::to_owned))
        .collect();
    assert_eq!(made.len(), 2, "{}", stdout(&output));
    assert!(
        made.iter()
            .all(|file| std::fs::metadata(file).unwrap().len() > 1000)
    );

    let small = ["--size", "64x48"];
    for (name, more) in [
        ("a.png", &["--frame", "1", "--color", "strain"][..]),
        ("b.gif", &["--camera", "top", "--wireframe"]),
    ] {
        let output = koiter(&[&["render", &result, "-o", &path(name)], &small[..], more].concat());
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        assert!(std::fs::metadata(path(name)).unwrap().len() > 100);
    }
    for (name, more, words) in [
        ("c.avi", &[][..], ".png"),
        ("c.png", &["--frame", "99"], "99"),
        ("c.png", &["--color", "wind"], "no field 'wind'"),
        ("c.gif", &["--frame", "1"], "--frame"),
        ("c.gif", &["--fps", "0"], "frames a second"),
    ] {
        let output = koiter(&[&["render", &result, "-o", &path(name)], &small[..], more].concat());
        assert_eq!(status(&output), 2, "{name} {more:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
        assert!(!Path::new(&path(name)).exists());
    }

    for (format, name, more, file) in [
        ("obj", "d.obj", &[][..], "d.obj"),
        ("ply", "d", &["--frame", "0"], "d.ply"),
        ("vtu", "e.vtu", &["--frame", "0"], "e.vtu"),
        ("vtu", "f.pvd", &[], "f_00002.vtu"),
    ] {
        let output = koiter(
            &[
                &["export", &result, "--to", format, "-o", &path(name)],
                more,
            ]
            .concat(),
        );
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        assert!(Path::new(&path(file)).exists(), "{file}");
    }
    let output = koiter(&["export", &result, "--to", "obj", "-o", &path("g.ply")]);
    assert_eq!(status(&output), 2);
    let output = koiter(&[
        "export",
        &path("nothing"),
        "--to",
        "obj",
        "-o",
        &path("g.obj"),
    ]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("no such folder"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_number_of_threads_does_not_change_the_frames() {
    let frames = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let output = run_small(folder.path(), &["--threads", threads]);
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        std::fs::read(folder.path().join("out/frames/00005.bin")).unwrap()
    };
    assert_eq!(frames("1"), frames("2"));
}

#[test]
fn an_intersecting_start_is_refused_by_name_with_a_coloured_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let crossing = "\n[[shell]]\nname = \"flag\"\nmaterial = \"cotton\"\nmesh.grid = { size = [0.3, 0.3], cells = [1, 1] }\n\
        mesh.rotate = { axis = [1, 0, 0], degrees = 90 }\nmesh.translate = [0.03, 0.02, 1]\n";
    let scene = write_scene(folder.path(), &format!("{SCENE}{crossing}"));
    let mesh = folder.path().join("start.ply");
    for verb in ["run", "check"] {
        let output = koiter(&[verb, &scene, "--debug-mesh", &mesh.to_string_lossy()]);
        let text = stderr(&output);
        assert_eq!(status(&output), 2, "{text}");
        assert!(
            text.contains("crosses") && text.contains("cloth") && text.contains("flag"),
            "{text}"
        );
        let ply = std::fs::read_to_string(&mesh).unwrap();
        assert!(
            ply.contains("element face 34")
                && ply.contains(" 220 30 30")
                && ply.contains(" 170 185 205"),
            "{ply}"
        );
        std::fs::remove_file(&mesh).unwrap();
    }
}

#[test]
fn reactions_carry_the_weight() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let output = koiter(&[
        "run",
        "cantilever",
        "--set",
        "resolution=tiny",
        "--out",
        &out,
        "--no-film",
        "--json",
    ]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let force = summary["probes"]["clamp_force"][2].as_f64().unwrap();
    // The tolerance is that of Newton's method, seen through the stiffness.
    let weight = 0.24 * 0.04 * 1e-3 * 500.0 * 9.81;
    assert!(
        (force / weight - 1.0).abs() < 1e-3,
        "{force} N against {weight} N"
    );
    let tip = summary["probes"]["tip"][2].as_f64().unwrap();
    // Statics: nothing moves, but the clamp is a spring.
    let stats = std::fs::read_to_string(format!("{out}/stats.jsonl")).unwrap();
    let lines: Vec<Value> = stats
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let times: Vec<&Value> = lines.iter().map(|line| &line["time"]).collect();
    assert_eq!(*times[2], 0.3, "not 0.30000000000000004");
    let energies = lines[9]["energies"].as_object().unwrap();
    let names: Vec<&str> = energies.keys().map(String::as_str).collect();
    assert_eq!(names, ["bending", "clamps", "gravity", "membrane"]);
    assert!(energies["clamps"].as_f64().unwrap() > 0.0);
    // The heavy elastica drops by 0.1400 m; twelve cells come within half a per cent.
    assert!((tip / -0.1400 - 1.0).abs() < 0.005, "{tip}");
}

#[test]
fn steps_that_do_not_converge_are_warned_about_once_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_small(folder.path(), &["--set", "solver.max_iterations=1"]);
    let text = stderr(&output);
    assert_eq!(status(&output), 1, "{text}");
    assert_eq!(text.matches("did not converge:").count(), 1, "{text}");
    assert!(text.contains("5 of 5 steps did not converge"), "{text}");
    let stats = std::fs::read_to_string(folder.path().join("out/stats.jsonl")).unwrap();
    assert_eq!(stats.matches("\"diagnosis\"").count(), 5);
}
