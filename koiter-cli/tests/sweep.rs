//! `koiter sweep`: families of runs, gone on with where they were.

mod program;

use std::path::Path;

use program::{SCENE, koiter, run_small, status, stderr, stdout, write_scene};
use serde_json::Value;

/// Sweeps the small scene over two thicknesses and two heights.
fn sweep(folder: &Path, more: &[&str]) -> std::process::Output {
    let scene = write_scene(folder, SCENE);
    let out = folder.join("family").to_string_lossy().into_owned();
    let mut arguments = vec![
        "sweep",
        &scene,
        "--out",
        &out,
        "--until",
        "0.04",
        "--vary",
        "shell.cloth.thickness=5e-4,1e-3",
        "--vary",
        "shell.cloth.mesh.translate=[0, 0, 1],[0, 0, 2]",
    ];
    arguments.extend(more);
    koiter(&arguments)
}

#[test]
fn every_combination_is_a_run_and_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let output = sweep(folder.path(), &["--json", "--jobs", "2"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let table: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let runs = table["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    let column = |name: &str| -> Vec<&Value> { runs.iter().map(|run| &run[name]).collect() };
    assert_eq!(
        column("shell.cloth.thickness"),
        ["5e-4", "5e-4", "1e-3", "1e-3"]
    );
    assert!(column("status").iter().all(|status| **status == 0));
    // What falls freely for two steps of implicit Euler is lower by 3 g dt².
    let fallen = 3.0 * 9.81 * 0.02 * 0.02;
    for (run, start) in runs.iter().zip([1.0, 2.0, 1.0, 2.0]) {
        assert!((run["height"].as_f64().unwrap() - (start - fallen)).abs() < 1e-6);
    }
    let family = folder.path().join("family");
    let csv = std::fs::read_to_string(family.join("table.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5);
    assert!(csv.contains("\"[0, 0, 2]\""));
    assert!(family.join("grid.png").exists());
}

#[test]
fn a_run_of_a_sweep_is_that_of_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(status(&run_small(folder.path(), &["--until", "0.04"])), 0);
    assert_eq!(status(&sweep(folder.path(), &[])), 0);
    let frame =
        |run: &str| std::fs::read(folder.path().join(run).join("frames/00002.bin")).unwrap();
    // Cotton is a millimetre thick unless a scene says otherwise.
    assert_eq!(frame("out"), frame("family/2-1e_3-_0__0__1_"));
}

#[test]
fn a_sweep_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(status(&sweep(folder.path(), &[])), 0);
    let family = folder.path().join("family");
    let frame = |run: &str| {
        let path = family.join(run).join("frames/00002.bin");
        std::fs::metadata(path).unwrap().modified().unwrap()
    };
    let kept = "0-5e_4-_0__0__1_";
    let before = frame(kept);
    // One run is lost; the others are finished and stay.
    let lost = "3-1e_3-_0__0__2_";
    std::fs::remove_dir_all(family.join(lost)).unwrap();
    let again = sweep(folder.path(), &[]);
    assert_eq!(status(&again), 0, "{}", stderr(&again));
    assert_eq!(frame(kept), before);
    assert!(family.join(lost).join("summary.json").exists());
}

#[test]
fn the_commands_can_be_listed_and_are_quoted_for_a_shell() {
    let folder = tempfile::tempdir().unwrap();
    let output = sweep(folder.path(), &["--list"]);
    let text = stdout(&output);
    assert_eq!(text.lines().count(), 4);
    assert!(text.lines().all(|line| line.starts_with("koiter run ")));
    assert!(text.contains("'shell.cloth.mesh.translate=[0, 0, 2]'"));
    assert!(!folder.path().join("family").exists());
}

#[test]
fn mistakes_are_told_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let output = sweep(folder.path(), &["--vary", "shell.cloth.bending=bac,bca"]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("bca"), "{}", stderr(&output));
    assert!(!folder.path().join("family").exists());
    let output = sweep(folder.path(), &["--vary", "bending"]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("there is no '='"));
}

#[test]
fn a_run_that_fails_stays_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let vary = ["--vary", "solver.max_iterations=1,200"];
    let scene = SCENE.replace("[0, 0, 1]", "[0, 0, 0.001]");
    let scene = write_scene(folder.path(), &scene);
    let out = folder.path().join("family").to_string_lossy().into_owned();
    let fixed = ["sweep", &scene, "--out", &out, "--json"];
    let output = koiter(&[&fixed[..], &vary].concat());
    assert_eq!(status(&output), 1, "{}", stderr(&output));
    let table: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(table["runs"][0]["status"], 1);
    assert_eq!(table["runs"][1]["status"], 0);
    assert!(stderr(&output).contains("1 of 2 runs failed"));
}
