//! The contract of the command line: exit statuses, streams, `--json`.

mod program;

use std::path::Path;

use serde_json::Value;

use program::{SCENE, koiter, run_small, status, stderr, stdout, write_scene};

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
fn a_run_says_what_limited_it_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let near_the_floor = SCENE.replace("[0, 0, 1]", "[0, 0, 0.03]");
    let scene = write_scene(folder.path(), &near_the_floor);
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let output = koiter(&["run", &scene, "--out", &out, "--no-film"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "where the time went: ",
        "slowest step: ",
        "smallest gap: ",
        "of 'cloth' against 'floor'",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let stats = std::fs::read_to_string(Path::new(&out).join("stats.jsonl")).unwrap();
    let lines: Vec<Value> = stats
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let last = lines.last().unwrap();
    let contacts = &last["contacts_by_bodies"]["cloth with floor"];
    assert!(
        contacts.as_u64().is_some_and(|count| count > 0) && contacts == &last["contacts"],
        "{last}"
    );
    assert!(
        last["largest_forces"].as_array().unwrap().len() > 1,
        "{last}"
    );
    assert!(
        last["residual_at"]
            .as_str()
            .unwrap()
            .ends_with("of 'cloth'"),
        "{last}"
    );
    // In one of the steps the cloth would have gone through the floor.
    let mut limits = lines
        .iter()
        .flat_map(|line| line["limits"].as_array().unwrap());
    let limit = limits.find(|limit| limit["by"] == "contact");
    let limit = limit.expect("the floor cuts a step short");
    assert!(limit["at"].as_str().unwrap().contains("'floor'"), "{limit}");
    assert!(
        limit["smallest_fraction"].as_f64().unwrap() < 1.0,
        "{limit}"
    );
}

#[test]
fn a_step_that_does_not_converge_says_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_small(folder.path(), &["--set", "solver.max_iterations=1"]);
    assert_eq!(status(&output), 1);
    let warning = stderr(&output);
    for part in [
        "step 1 did not converge",
        "largest at vertex",
        "Try ",
        "solver.max_iterations",
    ] {
        assert!(
            warning.to_lowercase().contains(&part.to_lowercase()),
            "{part}: {warning}"
        );
    }
    assert!(stdout(&output).contains("where the time went"));
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
        ("glb", "h.glb", &[], "h.glb"),
        ("glb", "i", &["--frame", "1", "--color", "strain"], "i.glb"),
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
    for more in [
        &["--to", "obj", "-o", &path("g.ply")][..],
        &["--to", "glb", "-o", &path("g.glb"), "--color", "strain"],
        &[
            "--to",
            "glb",
            "-o",
            &path("g.glb"),
            "--frame",
            "0",
            "--color",
            "wind",
        ],
        &["--to", "glb", "-o", &path("g.glb"), "--frame", "99"],
    ] {
        let output = koiter(&[&["export", &result], more].concat());
        assert_eq!(status(&output), 2, "{more:?}: {}", stderr(&output));
    }
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

#[test]
fn phases_of_a_run_go_on_in_one_result() {
    let folder = tempfile::tempdir().unwrap();
    let phases = "phase = [{ name = \"rest\", integrator = \"quasi-static\", gravity = [0, 0, 0], end = 0.2, dt = 0.1 },\n\
                  { name = \"fall\", end = 0.23, dt = 0.01, every_steps = 2 }]\n\
                  constraint = [{ shell = \"cloth\", select.boundary = 0, until = 0.2 }]";
    let text = SCENE.replace("time = { end = 0.1, dt = 0.02 }", phases);
    let scene = write_scene(folder.path(), &text);
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let run = |more: &[&str]| {
        let output = koiter(&[&["run", &scene, "--out", &out, "--no-film"], more].concat());
        assert_eq!(status(&output), 0, "{}", stderr(&output));
    };
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let times = || -> Vec<f64> {
        let lines = read("stats.jsonl");
        let lines = lines
            .lines()
            .map(|line| serde_json::from_str(line).unwrap());
        lines
            .map(|line: Value| line["time"].as_f64().unwrap())
            .collect()
    };
    run(&["--until", "0.21"]);
    assert_eq!(times(), [0.1, 0.2, 0.21]);
    run(&["--resume"]);
    assert_eq!(times(), [0.1, 0.2, 0.21, 0.22, 0.23]);
    // The start, both steps of the first phase, every second of the other, and the end.
    let reader = koiter::io::result::ResultReader::open(&folder.path().join("out")).unwrap();
    let frames: Vec<f64> = (0..reader.len())
        .map(|k| reader.frame(k).unwrap().time)
        .collect();
    assert_eq!(frames, [0.0, 0.1, 0.2, 0.22, 0.23]);
    assert!(
        read("probes.csv")
            .lines()
            .last()
            .unwrap()
            .starts_with("0.23,")
    );
    let check = koiter(&["check", &scene, "--json"]);
    let report: Value = serde_json::from_str(&stdout(&check)).unwrap();
    assert_eq!(report["steps"], 5);
    assert_eq!(report["phases"][1]["steps"], 3);
    assert_eq!(report["phases"][0]["integrator"], "quasi-static");
    let coarse = koiter(&["check", &scene, "--set", "phase.fall.dt=0.02", "--json"]);
    let report: Value = serde_json::from_str(&stdout(&coarse)).unwrap();
    assert_eq!(report["phases"][1]["dt"], 0.015);
    assert!(
        stdout(&koiter(&["check", &scene])).contains("phase fall: from 0.2 s, 3 steps of 0.01 s")
    );
}
