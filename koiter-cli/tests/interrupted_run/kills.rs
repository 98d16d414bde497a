//! Whatever ends a run, `--resume` brings it to the end it would have had.

use std::fs;
use std::time::{Duration, Instant};

use super::{Bench, EndState, status, stderr};

/// Fractions in [0, 1) that look random (splitmix64).
struct Moments(u64);

impl Moments {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What came of some kills.
#[derive(Default)]
struct Tally {
    same: usize,
    /// Kills after which there was a checkpoint and something left to do.
    in_the_middle: usize,
}

/// Kills runs at random moments, resumes each, and counts those that end like the one that was left alone. Every third
/// is killed a second time while it resumes.
fn kill_and_resume(count: usize, seed: u64) -> Tally {
    let bench = Bench::new();
    let clock = Instant::now();
    bench.finish("whole", &["--quiet"]);
    let duration = clock.elapsed().as_secs_f64();
    let expected = EndState::of(&bench.path("whole"));
    let touches = |line: &serde_json::Value| line["contacts"].as_u64() > Some(0);
    assert!(expected.stats.iter().any(touches), "nothing touched");
    let (mut moments, mut tally) = (Moments(seed), Tally::default());
    for kill in 0..count {
        let out = "killed";
        let mut kill_at = |more: &[&str]| {
            let mut child = bench.command(out, more).spawn().unwrap();
            std::thread::sleep(Duration::from_secs_f64(duration * moments.next()));
            child.kill().unwrap();
            child.wait().unwrap();
        };
        kill_at(&["--quiet", "--restart"]);
        if kill % 3 == 2 {
            kill_at(&["--quiet", "--resume"]);
        }
        let result = bench.path(out);
        let is_middle =
            result.join("checkpoint.bin").exists() && !result.join("summary.json").exists();
        tally.in_the_middle += usize::from(is_middle);
        bench.finish(out, &["--quiet", "--resume"]);
        match EndState::of(&result).difference(&expected) {
            None => tally.same += 1,
            Some(what) => eprintln!("kill {kill}: {what} differs"),
        }
    }
    tally
}

/// `cargo test -p koiter-cli --test interrupted_run -- --nocapture killed` prints the figures.
#[test]
fn a_hundred_runs_killed_at_random_moments_resume_to_the_same_end() {
    let tally = kill_and_resume(100, 2);
    println!(
        "{} of 100 resumed to the same end state ({} were killed between the first checkpoint and the end)",
        tally.same, tally.in_the_middle
    );
    assert_eq!(tally.same, 100);
    assert!(tally.in_the_middle > 0, "no kill met a running simulation");
}

#[test]
fn a_run_can_be_resumed_step_by_step_on_any_number_of_threads_and_beyond_its_end() {
    let bench = Bench::new();
    bench.finish("whole", &["--threads", "1"]);
    for (until, threads) in [("0.06", "2"), ("0.1", "1"), ("0.3", "2"), ("0.5", "1")] {
        // 0.06 s and 0.1 s are 3 and 5 steps: their last frames are none of the regular ones.
        bench.finish(
            "parts",
            &["--resume", "--until", until, "--threads", threads],
        );
        // What a kill may leave, and what is no key of a step.
        fs::write(bench.path("parts/checkpoint.bin.tmp"), "half").unwrap();
        fs::write(bench.path("parts/frames/00002.bin.tmp"), "half").unwrap();
    }
    fs::remove_file(bench.path("parts/frames/00002.bin.tmp")).unwrap();
    let (parts, whole) = (bench.path("parts"), bench.path("whole"));
    assert_eq!(EndState::of(&parts).difference(&EndState::of(&whole)), None);
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_told_and_the_run_goes_on_when_there_is_room() {
    let bench = Bench::new();
    bench.finish("whole", &["--quiet", "--until", "1.2"]);
    // Files of at most 24 kB, as on a disk that is full: of all files stats.jsonl gets there first. The signal that
    // would kill the program is ignored.
    let limited = format!(
        "trap '' XFSZ; ulimit -f 24; exec '{}' run scene.toml --no-film --quiet --out full --until 1.2",
        env!("CARGO_BIN_EXE_koiter")
    );
    let output = std::process::Command::new("bash")
        .args(["-c", &limited])
        .current_dir(bench.folder.path())
        .output()
        .unwrap();
    let text = stderr(&output);
    assert_eq!(status(&output), 1, "{text}");
    assert!(text.contains("could not write full/stats.jsonl"), "{text}");
    assert!(
        text.contains("--resume") && !text.contains("panicked"),
        "{text}"
    );
    assert!(bench.path("full/checkpoint.bin").exists());
    bench.finish("full", &["--quiet", "--resume", "--until", "1.2"]);
    let (full, whole) = (bench.path("full"), bench.path("whole"));
    assert_eq!(EndState::of(&full).difference(&EndState::of(&whole)), None);
}

/// The first signal ends the run after its step, with all that is needed to go on.
#[cfg(unix)]
#[test]
fn an_asked_end_saves_the_run_and_says_how_to_go_on() {
    for signal in ["INT", "TERM"] {
        let bench = Bench::new();
        // Only the signal makes a checkpoint.
        let settings = ["--set", "output.checkpoint_seconds=1e9"];
        let child = bench
            .command("out", &settings)
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let patience = Instant::now() + Duration::from_secs(60);
        while !bench.path("out/frames/00001.bin").exists() && Instant::now() < patience {
            std::thread::sleep(Duration::from_millis(2));
        }
        let kill = std::process::Command::new("kill")
            .args([format!("-{signal}"), child.id().to_string()])
            .status();
        assert!(
            kill.unwrap().success(),
            "the run was over before the signal"
        );
        let output = child.wait_with_output().unwrap();
        let text = stderr(&output);
        assert_eq!(status(&output), 1, "{text}");
        let command = "go on with: koiter run scene.toml --no-film --out out --set output.checkpoint_seconds=1e9 --resume";
        assert!(
            text.contains("interrupted after step") && text.contains(command),
            "{text}"
        );
        let summary = fs::read_to_string(bench.path("out/summary.json")).unwrap();
        assert!(summary.contains("\"interrupted\": true"), "{summary}");
        bench.finish("out", &["--resume"]);
        bench.finish("whole", &[]);
        let (out, whole) = (bench.path("out"), bench.path("whole"));
        assert_eq!(EndState::of(&out).difference(&EndState::of(&whole)), None);
    }
}
