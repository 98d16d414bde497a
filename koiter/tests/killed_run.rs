//! A run that is killed at any moment leaves a result folder that opens, with whole frames only.
#![cfg(feature = "io")]

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use koiter::Vec3;
use koiter::io::result::{Frame, Manifest, Part, PartKind, ResultReader, ResultWriter};

/// Set for the child process, which is this test again: it writes frames into the folder until it is killed.
const FOLDER: &str = "KOITER_TEST_KILLED_RUN_FOLDER";
const NUM_VERTICES: usize = 30_000;

fn write_until_killed(folder: &Path) {
    let part = Part {
        name: "dust".to_string(),
        kind: PartKind::Shell,
        thickness: 1e-3,
        vertices: 0..NUM_VERTICES,
        faces: 0..1,
        solid: None,
    };
    let manifest = Manifest {
        parts: vec![part],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder, &manifest, &[[0, 1, 2]]).unwrap();
    // An end, in case the parent dies first.
    let start = Instant::now();
    for step in 0.. {
        if start.elapsed() > Duration::from_secs(20) {
            return;
        }
        let positions = vec![Vec3::repeat(step as f64); NUM_VERTICES];
        writer
            .write_frame(&Frame {
                step,
                positions,
                ..Frame::default()
            })
            .unwrap();
        writer
            .append_stats(&serde_json::json!({ "step": step }))
            .unwrap();
    }
}

#[test]
fn killed_run_leaves_whole_frames() {
    if let Ok(folder) = std::env::var(FOLDER) {
        return write_until_killed(Path::new(&folder));
    }
    let folder = tempfile::tempdir().unwrap();
    let mut most_frames = 0;
    for round in 0..12 {
        // Each round writes the folder anew, so that clearing is interrupted too.
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "killed_run_leaves_whole_frames"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // The first round has time for a frame on a slow disk; the others are cut at many different moments.
        let patience = Instant::now() + Duration::from_secs(15);
        while round == 0
            && !folder.path().join("frames/00001.bin").exists()
            && Instant::now() < patience
        {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(7 * round));
        child.kill().unwrap();
        child.wait().unwrap();

        let reader = match ResultReader::open(folder.path()) {
            Ok(reader) => reader,
            // Killed between clearing the old result and writing the new topology: still ours, to be written anew.
            Err(error) if error.to_string().contains("topology.bin") => continue,
            Err(error) => panic!("round {round}: {error}"),
        };
        for index in 0..reader.len() {
            let frame = reader.frame(index).unwrap();
            assert_eq!(frame.step, index as u64);
            assert!(
                frame
                    .positions
                    .iter()
                    .all(|x| *x == Vec3::repeat(index as f64))
            );
        }
        assert!(reader.stats().unwrap().len() <= reader.len());
        most_frames = most_frames.max(reader.len());
    }
    assert!(most_frames >= 2, "the test is empty: {most_frames} frames");
}
