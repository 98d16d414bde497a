//! Runs that are interrupted, killed or meet a full disk, and go on with `--resume`.

mod kills;
mod path;
mod refusals;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// Contact with a block that moves, friction, self-contact, directors, probes; a frame every second step.
const SCENE: &str = r#"title = "Interrupted"
time = { end = 0.5, dt = 0.02 }
output = { every_steps = 2, checkpoint_seconds = 0 }

[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [0.4, 0.4], cells = [8, 8] }

[[obstacle]]
name = "block"
box = { size = [0.15, 0.12, 0.05] }
translate = [0.05, 0, -0.06]
motion.translate = [[0, [0, 0, 0]], [0.5, [-0.1, 0, 0.1]]]

[[probe]]
name = "energy"
quantity = "energy"

[[probe]]
name = "middle"
quantity = "position"
shell = "cloth"
select.nearest = [0, 0, 0]
"#;

/// A scene and a place for results, deleted at the end.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `koiter run` of the scene into the folder `out`, without pictures.
    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
        command
            .args(["run", "scene.toml", "--no-film", "--out", out])
            .args(more)
            .current_dir(self.folder.path())
            .stdin(Stdio::null());
        command
    }

    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    /// Runs and expects success.
    fn finish(&self, out: &str, more: &[&str]) -> String {
        let output = self.run(out, more);
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        stdout(&output) + &stderr(&output)
    }
}

fn status(output: &Output) -> i32 {
    output.status.code().expect("it was not killed")
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All that a run tells of its physics: every byte but the clock and the memory.
#[derive(PartialEq)]
struct EndState {
    frames: Vec<Vec<u8>>,
    stats: Vec<Value>,
    summary: Value,
    probes: Vec<u8>,
    topology: Vec<u8>,
}

impl EndState {
    fn of(result: &Path) -> Self {
        let read = |name: &str| fs::read(result.join(name)).unwrap();
        let json = |bytes: &[u8]| {
            let mut value: Value = serde_json::from_slice(bytes).unwrap();
            for key in ["seconds", "seconds_by_part", "peak_memory_bytes"] {
                value.as_object_mut().unwrap().remove(key);
            }
            value
        };
        let count = fs::read_dir(result.join("frames")).unwrap().count();
        let stats = read("stats.jsonl");
        let lines = stats.split_inclusive(|&byte| byte == b'\n');
        Self {
            frames: (0..count)
                .map(|i| read(&format!("frames/{i:05}.bin")))
                .collect(),
            stats: lines.map(json).collect(),
            summary: json(&read("summary.json")),
            probes: read("probes.csv"),
            topology: read("topology.bin"),
        }
    }

    /// The first thing that is not the same.
    fn difference(&self, other: &Self) -> Option<&'static str> {
        [
            ("topology.bin", self.topology == other.topology),
            ("frames", self.frames == other.frames),
            ("stats.jsonl", self.stats == other.stats),
            ("probes.csv", self.probes == other.probes),
            ("summary.json", self.summary == other.summary),
        ]
        .into_iter()
        .find_map(|(name, same)| (!same).then_some(name))
    }
}
