//! `koiter check --result`: what a run wrote is clean, and what is planted in it is found.

mod program;

use std::path::{Path, PathBuf};

use koiter::Vec3;
use koiter::io::result::{ResultReader, ResultWriter};
use serde_json::Value;

use program::{koiter, run_small, status, stderr, stdout};

/// A run of the small scene; its folder.
fn small_result(folder: &Path) -> PathBuf {
    let output = run_small(folder, &["--quiet"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    folder.join("out")
}

/// The report as JSON, and the exit status.
fn check(result: &Path) -> (Value, i32) {
    let output = koiter(&["check", "--result", &result.to_string_lossy(), "--json"]);
    let report = serde_json::from_slice(&output.stdout);
    (report.expect("one JSON object"), status(&output))
}

/// Puts a changed frame in the place of the last.
fn plant(result: &Path, change: impl Fn(&mut Vec<Vec3>)) {
    let reader = ResultReader::open(result).unwrap();
    let (last, lines) = (reader.len() - 1, reader.stats().unwrap().len());
    let mut frame = reader.frame(last).unwrap();
    change(&mut frame.positions);
    let mut writer = ResultWriter::resume(result, reader.manifest(), last, lines).unwrap();
    writer.write_frame(&frame).unwrap();
}

#[test]
fn what_a_run_wrote_is_clean() {
    let folder = tempfile::tempdir().unwrap();
    let result = small_result(folder.path());
    let (report, status_code) = check(&result);
    assert_eq!(
        (status_code, &report["clean"]),
        (0, &true.into()),
        "{report}"
    );
    assert_eq!(report["compared_with"], "rest shape");
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), ResultReader::open(&result).unwrap().len());
    let ratio = frames[0]["smallest_area_ratio"].as_f64().unwrap();
    // The rest shape is kept in single precision.
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    let text = stdout(&koiter(&["check", "--result", &result.to_string_lossy()]));
    assert!(text.contains("nothing intersects"), "{text}");
    // A result without a rest shape is compared with its first frame.
    std::fs::remove_file(result.join("rest.bin")).unwrap();
    let (report, status_code) = check(&result);
    assert_eq!(
        (status_code, report["compared_with"].as_str()),
        (0, Some("first readable frame"))
    );
}

#[test]
fn planted_faults_are_found_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let result = small_result(folder.path());
    let found = |key: &str| -> String {
        let (report, status_code) = check(&result);
        assert_eq!(
            (status_code, &report["clean"]),
            (1, &false.into()),
            "{report}"
        );
        let frames = report["frames"].as_array().unwrap();
        let (last, before) = frames.split_last().unwrap();
        assert!(before.iter().all(|row| row[key] == 0), "{report}");
        assert!(last[key].as_u64().unwrap() > 0, "{key}: {last}");
        last["findings"].to_string()
    };
    let sound = ResultReader::open(&result)
        .unwrap()
        .frame(0)
        .unwrap()
        .positions;
    // The edge of vertices 0 and 1 stands upright in the middle of the sheet.
    plant(&result, |x| {
        x.copy_from_slice(&sound);
        x[0] = x[12] + Vec3::new(0.05, 0.1, -0.05);
        x[1] = x[12] + Vec3::new(0.1, 0.05, 0.05);
    });
    assert!(found("crossings").contains("edge (0, 1) of 'cloth' crosses face"));
    plant(&result, |x| {
        x.copy_from_slice(&sound);
        x[0] = x[1] + Vec3::new(-1e-4, 0.0, 0.0);
    });
    assert!(found("collapsed_faces").contains("of 'cloth' is collapsed"));
    plant(&result, |x| {
        x.copy_from_slice(&sound);
        x[24].z = -0.125;
    });
    assert!(found("penetrations").contains("reaches 1.25e-1 m into 'floor'"));
    let output = koiter(&["check", "--result", &result.to_string_lossy()]);
    let (table, message) = (stdout(&output), stderr(&output));
    assert!(table.contains("into 'floor'") && !table.contains("nothing intersects"));
    assert!(
        message.contains("are at fault, the first is frame"),
        "{message}"
    );
}

#[test]
fn frames_that_are_damaged_or_missing_do_not_stop_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let result = small_result(folder.path());
    let frame = |index: usize| result.join(format!("frames/{index:05}.bin"));
    let bytes = std::fs::read(frame(0)).unwrap();
    std::fs::write(frame(0), &bytes[..bytes.len() / 2]).unwrap();
    std::fs::remove_file(frame(1)).unwrap();
    let (report, status_code) = check(&result);
    assert_eq!(status_code, 1);
    let frames = report["frames"].as_array().unwrap();
    assert!(
        frames[0]["error"].as_str().unwrap().contains("checksum"),
        "{report}"
    );
    assert!(
        frames[1]["error"].as_str().unwrap().contains("00001.bin"),
        "{report}"
    );
    assert!(
        frames[2..]
            .iter()
            .all(|row| row["crossings"] == 0 && row["error"].is_null())
    );
    assert!(frames.len() > 2, "{report}");
}

#[test]
fn frames_that_are_lost_or_there_twice_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let result = small_result(folder.path());
    let frame = |index: usize| result.join(format!("frames/{index:05}.bin"));
    let last = ResultReader::open(&result).unwrap().len() - 1;
    let told = |report: &Value| report["damaged"][0].as_str().unwrap_or_default().to_owned();
    let kept = std::fs::read(frame(last)).unwrap();
    std::fs::remove_file(frame(last)).unwrap();
    let (report, status_code) = check(&result);
    assert_eq!(status_code, 1);
    assert!(told(&report).contains("frames are missing"), "{report}");
    std::fs::write(frame(last), kept).unwrap();
    assert_eq!(check(&result).1, 0);
    std::fs::copy(frame(0), frame(1)).unwrap();
    let (report, status_code) = check(&result);
    assert_eq!(status_code, 1);
    assert!(told(&report).contains("frame 1 is of step 0"), "{report}");
}

#[test]
fn what_is_no_result_has_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for arguments in [
        &["check"][..],
        &["check", "--result", &at("nothing")],
        &["check", "--result", &at("")],
        &["check", "sphere-drape", "--result", &at("")],
    ] {
        let output = koiter(arguments);
        assert_eq!(status(&output), 2, "{arguments:?}");
        assert!(stdout(&output).is_empty() && !stderr(&output).is_empty());
    }
}
