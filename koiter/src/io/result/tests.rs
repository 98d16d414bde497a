use super::*;
use crate::Vec3;
use serde_json::json;
use std::fs;

const FACES: [[u32; 3]; 3] = [[0, 1, 2], [0, 2, 3], [4, 5, 6]];

fn manifest() -> Manifest {
    let part = |name: &str, kind, thickness, vertices, faces| Part {
        name: name.to_string(),
        kind,
        thickness,
        vertices,
        faces,
        solid: None,
    };
    Manifest {
        title: "A sheet over a floor".to_string(),
        scene_text: "title = \"é\"\n".to_string(),
        parts: vec![
            part("sheet", PartKind::Shell, 1e-3, 0..4, 0..2),
            part("floor", PartKind::Obstacle, 0.0, 4..7, 2..3),
        ],
        ..Manifest::default()
    }
}

fn frame(step: u64) -> Frame {
    let position = |v: u64| Vec3::new(v as f64 / 3.0, step as f64, -1e-300);
    Frame {
        step,
        time: step as f64 / 120.0,
        positions: (0..7).map(position).collect(),
        vertex_fields: vec![Field {
            name: "gap".into(),
            values: vec![0.5; 7],
        }],
        face_fields: vec![
            Field {
                name: "strain".into(),
                values: vec![0.0, 1.5, -2.5],
            },
            Field {
                name: "mean_curvature".into(),
                values: vec![1.0, 2.0, f32::INFINITY],
            },
        ],
        topology: None,
    }
}

fn written(frames: u64) -> (tempfile::TempDir, ResultWriter) {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = ResultWriter::create(folder.path(), &manifest(), &FACES).unwrap();
    for step in 0..frames {
        writer.write_frame(&frame(step)).unwrap();
        writer
            .append_stats(&json!({"step": step, "min_gap": f64::INFINITY}))
            .unwrap();
    }
    (folder, writer)
}

fn open_error(folder: &Path) -> String {
    ResultReader::open(folder).unwrap_err().to_string()
}

#[test]
fn what_was_written_is_read_back_bit_for_bit() {
    let (folder, writer) = written(3);
    writer.write_summary(&json!({"steps": 3})).unwrap();
    let reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!(*reader.manifest(), manifest());
    assert_eq!(reader.faces(), FACES);
    assert_eq!(reader.len(), 3);
    for step in 0..3 {
        assert_eq!(reader.frame(step as usize).unwrap(), frame(step));
        let info = reader.frame_info(step as usize).unwrap();
        assert_eq!((info.step, info.time), (step, step as f64 / 120.0));
    }
    assert_eq!(
        reader.frame(0).unwrap().field("strain").unwrap().values[1],
        1.5
    );
    assert_eq!(
        reader.stats().unwrap()[2],
        json!({"step": 2, "min_gap": null})
    );
    assert_eq!(reader.summary().unwrap(), Some(json!({"steps": 3})));
    let error = reader.frame(3).unwrap_err().to_string();
    assert!(
        error.contains("no frame 3") && error.contains("3 frames"),
        "{error}"
    );
}

#[test]
fn running_result_can_be_read_and_refreshed() {
    let (folder, mut writer) = written(1);
    let mut reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!(reader.summary().unwrap(), None);
    // A write that is under way is not a frame yet.
    fs::write(folder.path().join("frames/00001.bin.tmp"), b"half").unwrap();
    writer.write_frame(&frame(1)).unwrap();
    assert_eq!(reader.len(), 1);
    reader.refresh().unwrap();
    assert_eq!(reader.len(), 2);
}

#[test]
fn foreign_folders_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.tex"), "x").unwrap();
    let error = ResultWriter::create(folder.path(), &manifest(), &FACES)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("not empty and not a Koiter result"),
        "{error}"
    );
    fs::write(
        folder.path().join("manifest.json"),
        "{\"name\": \"web app\"}",
    )
    .unwrap();
    assert!(ResultWriter::create(folder.path(), &manifest(), &FACES).is_err());
    assert!(open_error(folder.path()).contains("manifest.json is not ours"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn old_result_is_cleared_but_strange_files_stay() {
    let (folder, writer) = written(4);
    writer.write_summary(&json!({})).unwrap();
    fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    fs::write(folder.path().join("checkpoint.bin"), "old").unwrap();
    drop(writer);
    let mut writer = ResultWriter::create(folder.path(), &manifest(), &FACES).unwrap();
    writer.write_frame(&frame(9)).unwrap();
    let reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!(reader.len(), 1);
    assert!(reader.stats().unwrap().is_empty());
    assert_eq!(reader.summary().unwrap(), None);
    assert!(folder.path().join("notes.txt").exists());
    assert!(!folder.path().join("checkpoint.bin").exists());
}

/// Not on systems whose folders cannot be locked.
#[cfg(unix)]
#[test]
fn a_folder_has_one_writer_at_a_time() {
    let (folder, writer) = written(2);
    let create = || ResultWriter::create(folder.path(), &manifest(), &FACES);
    let resume = || ResultWriter::resume(folder.path(), &manifest(), 1, 1);
    for error in [create().unwrap_err(), resume().unwrap_err()] {
        assert!(error.to_string().contains("another run is writing to"));
    }
    assert_eq!(ResultReader::open(folder.path()).unwrap().len(), 2);
    drop(writer);
    assert_eq!(resume().unwrap().num_frames(), 1);
}

#[test]
fn resumed_run_drops_what_came_after() {
    let (folder, writer) = written(4);
    drop(writer);
    let stats = folder.path().join("stats.jsonl");
    let mut text = fs::read_to_string(&stats).unwrap();
    text.push_str("{\"step\": 4, \"cut");
    fs::write(&stats, text).unwrap();
    assert_eq!(
        ResultReader::open(folder.path())
            .unwrap()
            .stats()
            .unwrap()
            .len(),
        4
    );
    let mut writer = ResultWriter::resume(folder.path(), &manifest(), 2, 3).unwrap();
    writer.write_frame(&frame(77)).unwrap();
    writer.append_stats(&json!({"step": 77})).unwrap();
    let reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!(reader.len(), 3);
    assert_eq!(reader.frame(2).unwrap().step, 77);
    assert_eq!(reader.stats().unwrap()[3], json!({"step": 77}));
    drop(writer);
    assert!(
        ResultWriter::resume(folder.path(), &manifest(), 9, 0)
            .unwrap_err()
            .to_string()
            .contains("no frame 8")
    );
    assert!(
        ResultWriter::resume(folder.path(), &manifest(), 0, 99)
            .unwrap_err()
            .to_string()
            .contains("4 complete")
    );
}

#[test]
fn every_changed_or_missing_byte_is_noticed_and_the_file_named() {
    let (folder, _writer) = written(1);
    let reader = ResultReader::open(folder.path()).unwrap();
    for name in ["frames/00000.bin", "topology.bin"] {
        let path = folder.path().join(name);
        let good = fs::read(&path).unwrap();
        let read = || match name {
            "topology.bin" => ResultReader::open(folder.path()).map(|_| ()),
            _ => reader.frame(0).map(|_| ()),
        };
        read().unwrap();
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            fs::write(&path, &bad).unwrap();
            assert!(read().unwrap_err().to_string().contains(name), "byte {at}");
            fs::write(&path, &good[..at]).unwrap();
            assert!(
                read().unwrap_err().to_string().contains(name),
                "cut at {at}"
            );
        }
        fs::write(&path, &good).unwrap();
    }
}

#[test]
fn honest_checksum_does_not_make_a_dishonest_header_dangerous() {
    let good = frame(0).encode(3);
    for at in 12..good.len() - 4 {
        let mut bad = good.clone();
        bad[at] = 0xff;
        let end = bad.len() - 4;
        let checksum = crate::io::checksum::crc32(&bad[..end]).to_le_bytes();
        bad[end..].copy_from_slice(&checksum);
        // Any outcome but a panic or a huge reservation.
        let _ = Frame::decode(&bad);
    }
}

#[test]
fn missing_frames_and_folders_are_named() {
    let (folder, _writer) = written(3);
    fs::remove_file(folder.path().join("frames/00001.bin")).unwrap();
    let error = open_error(folder.path());
    assert!(
        error.contains("00001.bin") && error.contains("missing"),
        "{error}"
    );
    assert!(open_error(&folder.path().join("nowhere")).contains("no such folder"));
    assert!(open_error(&folder.path().join("frames")).contains("no manifest.json"));
}

#[test]
fn newer_format_is_named_as_such() {
    let (folder, _writer) = written(0);
    let path = folder.path().join("manifest.json");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(
        &path,
        text.replace("\"format_version\": 1", "\"format_version\": 2"),
    )
    .unwrap();
    assert!(open_error(folder.path()).contains("use a newer Koiter"));
    fs::write(&path, text.replace("\"parts\"", "\"pieces\"")).unwrap();
    assert!(open_error(folder.path()).contains("missing field `parts`"));
}

#[test]
fn contradictions_are_refused_before_writing() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |manifest: &Manifest, faces: &[[u32; 3]]| {
        ResultWriter::create(&folder.path().join("new"), manifest, faces)
            .unwrap_err()
            .to_string()
    };
    let mut gap = manifest();
    gap.parts[1].vertices = 5..7;
    assert!(refused(&gap, &FACES).contains("part 'floor' has vertices 5..7"));
    let mut thick = manifest();
    thick.parts[0].thickness = f64::NAN;
    assert!(refused(&thick, &FACES).contains("thickness NaN"));
    assert!(refused(&manifest(), &FACES[..2]).contains("3 faces, but there are 2"));
    let text = refused(&manifest(), &[[0, 1, 2], [0, 2, 4], [4, 5, 6]]);
    assert!(
        text.contains("face 1 of part 'sheet' uses vertex 4"),
        "{text}"
    );
    assert!(!folder.path().join("new").exists());

    let (_folder, mut writer) = written(0);
    let mut refused = |frame: &Frame| writer.write_frame(frame).unwrap_err().to_string();
    let mut bad = frame(0);
    bad.positions[6].z = f64::NAN;
    assert!(refused(&bad).contains("vertex 6 is at"));
    bad.positions.pop();
    assert!(refused(&bad).contains("6 positions for 7 vertices"));
    let mut bad = frame(0);
    bad.face_fields[0].values.pop();
    assert!(refused(&bad).contains("field 'strain' has 2 values for 3 faces"));
}

#[test]
fn unwritable_places_give_path_and_cause() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    let error = ResultWriter::create(&file.join("out"), &manifest(), &FACES)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("could not create the folder") && error.contains("out"),
        "{error}"
    );
}

/// On Linux, whatever is written to `/dev/full` meets a full disk.
#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_told_and_leaves_the_result_whole() {
    let (folder, mut writer) = written(1);
    let temporary = folder.path().join("frames/00001.bin.tmp");
    std::os::unix::fs::symlink("/dev/full", &temporary).unwrap();
    let error = writer.write_frame(&frame(1)).unwrap_err().to_string();
    assert!(
        error.contains("00001.bin: No space left on device"),
        "{error}"
    );
    let reader = ResultReader::open(folder.path()).unwrap();
    assert_eq!((reader.len(), writer.num_frames()), (1, 1));
    // With space again, the run can go on.
    writer.write_frame(&frame(1)).unwrap();
    assert_eq!(
        ResultReader::open(folder.path()).unwrap().frame(1).unwrap(),
        frame(1)
    );
}
