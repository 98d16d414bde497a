//! What cannot go on is refused with the reason, and nothing is lost by that.

use std::fs;

use super::{Bench, EndState, SCENE, status, stderr};

/// A run of three steps, which could go on.
fn begun() -> Bench {
    let bench = Bench::new();
    bench.finish("out", &["--until", "0.06"]);
    bench
}

/// The message of a refusal; the result must be as it was.
fn refused(bench: &Bench, more: &[&str]) -> String {
    let before = EndState::of(&bench.path("out"));
    let output = bench.run("out", more);
    let text = stderr(&output);
    assert_eq!(status(&output), 2, "{text}");
    let after = EndState::of(&bench.path("out"));
    assert_eq!(
        after.difference(&before),
        None,
        "changed by a refusal: {text}"
    );
    text
}

#[test]
fn another_scene_is_refused_with_the_key_and_both_values() {
    let bench = begun();
    let text = refused(&bench, &["--resume", "--set", "shell.cloth.thickness=2e-3"]);
    assert!(
        text.contains(
            "shell.cloth.thickness is 0.002 in this scene, but not set in the checkpoint"
        ),
        "{text}"
    );
    let text = refused(&bench, &["--resume", "--set", "output.every_steps=3"]);
    assert!(
        text.contains("output.every_steps is 3 in this scene, but 2"),
        "{text}"
    );
    fs::write(
        bench.path("scene.toml"),
        SCENE.replace("dt = 0.02", "dt = 0.01"),
    )
    .unwrap();
    let text = refused(&bench, &["--resume"]);
    assert!(
        text.contains("time.dt is 0.01 in this scene, but 0.02"),
        "{text}"
    );
}

#[test]
fn another_mesh_file_is_refused_by_the_name_of_its_shell() {
    let bench = Bench::new();
    let with_file = SCENE.replace(
        "mesh.grid = { size = [0.4, 0.4], cells = [8, 8] }",
        "mesh.file = \"cloth.obj\"",
    );
    let obj = "v 0 0 0\nv 0.2 0 0\nv 0.2 0.2 0\nv 0 0.2 0\nf 1 2 3\nf 1 3 4\n";
    fs::write(bench.path("scene.toml"), with_file).unwrap();
    fs::write(bench.path("cloth.obj"), obj).unwrap();
    bench.finish("out", &["--until", "0.06"]);
    fs::write(
        bench.path("cloth.obj"),
        obj.replace("0 0.2 0\nf", "0 0.21 0\nf"),
    )
    .unwrap();
    let text = refused(&bench, &["--resume"]);
    assert!(
        text.contains("the mesh of 'cloth' is another one"),
        "{text}"
    );
}

#[test]
fn what_changes_no_step_may_differ() {
    let bench = begun();
    let free = [
        "title=\"New\"",
        "output.camera=\"top\"",
        "output.checkpoint_seconds=5",
        "time.end=0.1",
    ];
    let mut arguments = vec!["--resume"];
    free.iter().for_each(|set| arguments.extend(["--set", set]));
    bench.finish("out", &arguments);
    let manifest = fs::read_to_string(bench.path("out/manifest.json")).unwrap();
    assert!(manifest.contains("\"title\": \"New\""), "{manifest}");
    bench.finish("whole", &["--until", "0.1"]);
    let (out, whole) = (bench.path("out"), bench.path("whole"));
    assert_eq!(EndState::of(&out).difference(&EndState::of(&whole)), None);
}

#[test]
fn a_finished_run_says_so_and_a_missing_one_begins() {
    let bench = Bench::new();
    let text = bench.finish("out", &["--resume", "--until", "0.06"]);
    assert!(
        text.contains("out has no checkpoint to resume from"),
        "{text}"
    );
    let before = EndState::of(&bench.path("out"));
    let text = bench.finish("out", &["--resume", "--until", "0.06"]);
    assert!(text.contains("finished already: 3 steps"), "{text}");
    assert_eq!(EndState::of(&bench.path("out")).difference(&before), None);
    // A finished result is replaced, as always.
    bench.finish("out", &["--until", "0.04"]);
}

#[test]
fn damaged_checkpoints_and_other_versions_are_refused() {
    let bench = begun();
    let path = bench.path("out/checkpoint.bin");
    let good = fs::read(&path).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    for bad in [&flipped[..], &good[..good.len() - 100], b"", b"KOITERCP"] {
        fs::write(&path, bad).unwrap();
        let text = refused(&bench, &["--resume"]);
        assert!(
            text.contains("checkpoint.bin is broken") && text.contains("--restart"),
            "{text}"
        );
    }
    let mut other = koiter::io::Checkpoint::from_bytes(&good).unwrap();
    other.version = "0.0.7".into();
    fs::write(&path, other.to_bytes()).unwrap();
    let text = refused(&bench, &["--resume"]);
    assert!(text.contains("written by Koiter 0.0.7, this is"), "{text}");
    // Figures that the checkpoint counts on are gone.
    fs::write(&path, &good).unwrap();
    fs::write(bench.path("out/stats.jsonl"), "{}\n").unwrap();
    let text = refused(&bench, &["--resume", "--until", "0.1"]);
    assert!(text.contains("1 complete lines, 3 are needed"), "{text}");
}

#[test]
fn a_damaged_frame_among_those_to_keep_is_refused_by_name() {
    let bench = begun();
    let path = bench.path("out/frames/00001.bin");
    let good = fs::read(&path).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    for bad in [&flipped[..], &good[..good.len() - 100], b""] {
        fs::write(&path, bad).unwrap();
        let text = refused(&bench, &["--resume", "--until", "0.1"]);
        assert!(
            text.contains("00001.bin is broken") && text.contains("--restart"),
            "{text}"
        );
    }
    fs::write(&path, &good).unwrap();
    bench.finish("out", &["--resume", "--until", "0.1"]);
}

#[cfg(unix)]
#[test]
fn devices_in_the_place_of_files_are_refused() {
    let bench = begun();
    for (name, words) in [
        ("manifest.json", "manifest.json cannot be one"),
        ("topology.bin", "topology.bin is broken"),
        ("checkpoint.bin", "checkpoint.bin is broken"),
        ("frames/00000.bin", "00000.bin is broken"),
        ("stats.jsonl", "stats.jsonl is broken"),
        ("probes.csv", "probes.csv is broken"),
    ] {
        let (path, aside) = (bench.path("out").join(name), bench.path("aside"));
        fs::rename(&path, &aside).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        let output = bench.run("out", &["--resume", "--until", "0.1"]);
        let text = stderr(&output);
        assert_eq!(status(&output), 2, "{text}");
        for words in [words, "not a regular file"] {
            assert!(text.contains(words), "'{words}' is not in: {text}");
        }
        fs::rename(&aside, &path).unwrap();
    }
    bench.finish("out", &["--resume", "--until", "0.1"]);
}

#[test]
fn an_interrupted_run_of_the_same_scene_is_replaced_only_when_asked() {
    let bench = begun();
    let summary = bench.path("out/summary.json");
    // As a kill between the last checkpoint and the summary leaves it.
    let text = fs::read_to_string(&summary).unwrap();
    fs::write(
        &summary,
        text.replace("\"interrupted\": false", "\"interrupted\": true"),
    )
    .unwrap();
    let text = refused(&bench, &[]);
    assert!(
        text.contains("interrupted run of this scene, saved after step 3"),
        "{text}"
    );
    assert!(
        text.contains("--resume") && text.contains("--restart"),
        "{text}"
    );
    bench.finish("out", &["--restart", "--until", "0.04"]);
    assert_eq!(EndState::of(&bench.path("out")).stats.len(), 2);
}

/// Rewrites the summary as a kill after the last checkpoint leaves it.
fn mark_as_interrupted(bench: &Bench) {
    let path = bench.path("out/summary.json");
    let text = fs::read_to_string(&path).unwrap();
    let marked = text.replace("\"interrupted\": false", "\"interrupted\": true");
    assert_ne!(marked, text);
    fs::write(path, marked).unwrap();
}

#[test]
fn an_interrupted_run_of_other_settings_is_replaced_only_when_asked() {
    let bench = begun();
    mark_as_interrupted(&bench);
    let text = refused(&bench, &["--set", "time.dt=0.01"]);
    for words in [
        "time.dt is 0.01 in this scene, but 0.02",
        "--resume",
        "--restart",
    ] {
        assert!(text.contains(words), "{text}");
    }
    bench.finish(
        "out",
        &["--set", "time.dt=0.01", "--until", "0.02", "--restart"],
    );
}

#[test]
fn a_lost_checkpoint_does_not_cost_a_result_and_frames_are_not_replaced_silently() {
    let bench = begun();
    fs::remove_file(bench.path("out/checkpoint.bin")).unwrap();
    let text = refused(&bench, &["--resume", "--quiet"]);
    assert!(
        text.contains("checkpoint.bin is missing") && text.contains("--restart"),
        "{text}"
    );
    // As a kill before the first checkpoint leaves it.
    fs::remove_file(bench.path("out/summary.json")).unwrap();
    let text = bench.finish("out", &["--resume", "--quiet", "--until", "0.04"]);
    assert!(text.contains("replaces its 3 frames"), "{text}");
}

#[test]
fn what_is_missing_or_a_folder_has_status_2_and_advice() {
    let bench = begun();
    fs::remove_file(bench.path("out/topology.bin")).unwrap();
    let output = bench.run("out", &["--resume", "--until", "0.1"]);
    assert_eq!(status(&output), 2, "{}", stderr(&output));
    assert!(stderr(&output).contains("topology.bin") && stderr(&output).contains("--restart"));
    fs::remove_file(bench.path("out/checkpoint.bin")).unwrap();
    fs::create_dir(bench.path("out/checkpoint.bin")).unwrap();
    let output = bench.run("out", &["--resume"]);
    assert_eq!(status(&output), 2, "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn a_folder_that_another_run_writes_to_is_refused_before_it_is_read() {
    let bench = begun();
    mark_as_interrupted(&bench);
    let _lock = koiter::io::result::FolderLock::take(&bench.path("out")).unwrap();
    for more in [&[][..], &["--resume"], &["--restart"]] {
        let text = refused(&bench, more);
        assert!(text.contains("another run is writing to out"), "{text}");
    }
}

#[test]
fn a_finished_run_without_its_pictures_gets_them() {
    let bench = Bench::new();
    bench.finish("out", &["--until", "0.04", "--quiet"]);
    fs::write(bench.path("out/.film.partial.mp4"), "half").unwrap();
    let resume = || {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_koiter"))
            .args([
                "run",
                "scene.toml",
                "--out",
                "out",
                "--until",
                "0.04",
                "--resume",
            ])
            .current_dir(bench.folder.path())
            .output()
            .unwrap();
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        super::stdout(&output)
    };
    assert_eq!(resume().matches("made: ").count(), 2);
    assert!(bench.path("out/final.png").exists());
    assert!(!bench.path("out/.film.partial.mp4").exists());
    assert_eq!(resume().matches("made: ").count(), 0);
}
