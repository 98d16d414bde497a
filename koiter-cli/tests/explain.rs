//! `koiter explain`, and the examples of its page: every one is run and must end in the error that it is said to show.

use std::path::Path;
use std::process::{Command, Output};

const PAGE: &str = include_str!("../../docs/errors.md");

fn koiter(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_koiter"));
    command.args(arguments).output().expect("the binary runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Code, and the commands of its example, where they can be run.
fn examples() -> impl Iterator<Item = (&'static str, &'static str)> {
    PAGE.split("\n## ").skip(1).filter_map(|section| {
        let (code, text) = section.split_once('\n')?;
        let (_, example) = text.split_once("```sh\n")?;
        Some((code, example.split_once("```")?.0))
    })
}

#[test]
#[cfg(target_os = "linux")]
fn every_example_ends_in_its_error() {
    let program = Path::new(env!("CARGO_BIN_EXE_koiter"));
    let folders = [program.parent().unwrap().to_path_buf()];
    let others = std::env::split_paths(&std::env::var_os("PATH").unwrap()).collect::<Vec<_>>();
    let path = std::env::join_paths(folders.into_iter().chain(others)).unwrap();
    let mut count = 0;
    for (code, example) in examples() {
        let folder = tempfile::tempdir().unwrap();
        // `&&` in effect: what comes before the last command must succeed, so the error is that of the last.
        let shell = Command::new("bash")
            .args(["-ec", example])
            .env("PATH", &path)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let errors = text(&shell.stderr);
        assert!(
            errors.lines().any(|line| line == code),
            "{code}: {example}{}{errors}",
            text(&shell.stdout)
        );
        let expected = match code {
            "write" | "not-converged" | "audit" | "sweep" => 1,
            _ => 2,
        };
        assert_eq!(shell.status.code(), Some(expected), "{code}: {errors}");
        count += 1;
    }
    assert!(count > 20, "only {count} examples were found");
}

#[test]
fn codes_are_listed_told_and_corrected() {
    let list = text(&koiter(&["explain"]).stdout);
    assert!(list.contains("scene-unknown-key"), "{list}");
    assert_eq!(list.lines().count(), PAGE.matches("\n## ").count());
    let told = text(&koiter(&["explain", "Start-Touching"]).stdout);
    assert!(
        told.starts_with("start-touching\n") && told.contains("--debug-mesh"),
        "{told}"
    );
    for wrong in ["scene-unknwon-key", "", "x"] {
        let output = koiter(&["explain", wrong]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("koiter explain lists all"));
    }
}
