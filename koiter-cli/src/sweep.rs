//! `koiter sweep`: a family of runs, each a process of its own, and a table of what came out of them.

mod plan;
mod table;
mod workers;

use std::path::{Path, PathBuf};

use crate::arguments::SweepArguments;
use crate::failure::{Code, Failure};
use crate::output::{quoted, say};
use crate::pictures::grid;
use crate::scene_source::load_silently;
use plan::{Plan, Run};
use table::Table;
use workers::{Outcome, run_all};

/// Runs the family, or lists it.
pub(crate) fn sweep(arguments: &SweepArguments) -> Result<(), Failure> {
    let plan = Plan::new(&arguments.vary)?;
    let name = check_all(arguments, &plan)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(format!("sweep-{name}")));
    let program = std::env::current_exe().map_err(|error| {
        Failure::run(format!(
            "cannot find this program to start it again: {error}"
        ))
    })?;
    let commands: Vec<Vec<String>> = (plan.runs.iter())
        .map(|run| command(arguments, run, &out))
        .collect();
    if arguments.list {
        for words in &commands {
            let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
            say!("koiter {}", words.join(" "));
        }
        return Ok(());
    }
    std::fs::create_dir_all(&out)
        .map_err(|error| Failure::run(format!("cannot make {}: {error}", out.display())))?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = arguments.jobs.unwrap_or(cores).min(plan.runs.len());
    let outcomes = run_all(&program, &commands, jobs, arguments.retries)?;
    finish(arguments, &plan, &outcomes, &out)
}

/// Table and pictures, and whether all went well.
fn finish(
    arguments: &SweepArguments,
    plan: &Plan,
    outcomes: &[Outcome],
    out: &Path,
) -> Result<(), Failure> {
    let table = Table::collect(plan, outcomes, out);
    table.write(out)?;
    let folders: Vec<PathBuf> = (plan.runs.iter())
        .map(|run| out.join(&run.folder))
        .collect();
    let picture = grid(&folders, plan.columns(), &out.join("grid.png"))?;
    if arguments.json {
        say!("{}", table.json());
    } else {
        say!("{}", table.text());
        say!("made: {}", out.join("table.csv").display());
        if picture {
            say!("made: {}", out.join("grid.png").display());
        }
    }
    match outcomes.iter().filter(|outcome| !outcome.is_good()).count() {
        0 => Ok(()),
        failed => Err(Failure::run(format!(
            "{failed} of {} runs failed or were not begun",
            outcomes.len()
        ))
        .with_code(Code::Sweep)
        .with_help(
            "what a run said is in the .log.txt beside its folder; the same command goes on with what is left",
        )),
    }
}

/// Every run's scene is read before the first is started; returns the name of the scene.
fn check_all(arguments: &SweepArguments, plan: &Plan) -> Result<String, Failure> {
    let mut name = String::new();
    for run in &plan.runs {
        let overrides = arguments.scene.overrides.iter().chain(&run.overrides);
        let scene = crate::arguments::SceneArguments {
            scene: arguments.scene.scene.clone(),
            overrides: overrides.cloned().collect(),
            memory: arguments.scene.memory,
        };
        name = load_silently(&scene)?.name;
    }
    Ok(name)
}

/// The words of a run's command.
fn command(arguments: &SweepArguments, run: &Run, out: &Path) -> Vec<String> {
    let mut words = vec!["run".to_owned(), arguments.scene.scene.clone()];
    for text in arguments.scene.overrides.iter().chain(&run.overrides) {
        words.extend(["--set".to_owned(), text.clone()]);
    }
    if let Some(until) = arguments.until {
        words.extend(["--until".to_owned(), until.to_string()]);
    }
    let folder = out.join(&run.folder).to_string_lossy().into_owned();
    let fixed = [
        "--resume",
        "--quiet",
        "--no-film",
        "--threads",
        "1",
        "--out",
    ];
    words.extend(fixed.map(str::to_owned));
    words.push(folder);
    words
}
