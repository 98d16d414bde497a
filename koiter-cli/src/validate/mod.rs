//! `koiter validate`: published shell problems against their reference solutions.
//!
//! A case is a scene of `benchmarks/` with its published values; every model computes it on two or three meshes, each with
//! cells half as large as the one before.

mod case;
mod cases;
mod convergence;
mod curves;
mod report;
mod study;

use koiter::scene::nearest;
use serde_json::{Value, json};

use self::case::Case;
use self::cases::CASES;
use self::study::Study;
use crate::arguments::{ValidateArguments, bending_models};
use crate::failure::Failure;
use crate::output::say;
use crate::output_path;

/// Runs the cases asked for, all by default.
pub(crate) fn validate(arguments: &ValidateArguments) -> Result<(), Failure> {
    if arguments.list {
        list(arguments.json);
        return Ok(());
    }
    let cases = chosen(&arguments.cases)?;
    let models = bending_models(&arguments.models).map_err(Failure::input)?;
    if let Some(folder) = &arguments.plot {
        output_path::make_folder(folder)?;
    }
    let mut studies_of_all = Vec::new();
    let mut refusals = Vec::new();
    let mut marks = [0; 3];
    for case in cases {
        let mut studies = Vec::new();
        for &model in &models {
            match Study::new(case, model, arguments.levels) {
                Ok(study) => studies.push(study),
                Err(failure) => {
                    refusals.push((case.name, model.info().name, failure.message().to_owned()))
                }
            }
        }
        for finding in studies.iter().flat_map(|study| &study.findings) {
            marks[finding.verdict as usize] += 1;
        }
        if !arguments.json {
            report::print(case, &studies);
            for (_, model, reason) in refusals.iter().filter(|refusal| refusal.0 == case.name) {
                say!("  {model}: not computed: {reason}");
            }
        }
        if let Some(folder) = &arguments.plot {
            curves::draw(case, &studies, folder)?;
        }
        studies_of_all.extend(studies.iter().map(|study| study.json(case)));
    }
    if arguments.json {
        say!("{}", json(&studies_of_all, &refusals, marks));
    } else {
        let [within, in_the_limit, outside] = marks;
        say!(
            "\n{within} figures within their tolerance on the finest mesh, {in_the_limit} when extrapolated, {outside} outside"
        );
    }
    if refusals.is_empty() {
        return Ok(());
    }
    let studies: Vec<String> = (refusals.iter())
        .map(|(case, model, _)| format!("{case} with {model}"))
        .collect();
    Err(Failure::run(format!(
        "not computed: {}",
        studies.join(", ")
    )))
}

/// Everything for scripts; refusals are case, model and reason, marks the figures of each verdict.
fn json(studies: &[Value], refusals: &[(&str, &str, String)], marks: [usize; 3]) -> Value {
    let refused = refusals
        .iter()
        .map(|(case, model, reason)| json!({ "case": case, "bending": model, "reason": reason }));
    let [within, in_the_limit, outside] = marks;
    json!({
        "studies": studies,
        "not_computed": refused.collect::<Vec<_>>(),
        "within": within,
        "within_in_the_limit": in_the_limit,
        "outside": outside,
    })
}

/// The cases of a list of names, each once; none and `all` stand for all.
fn chosen(names: &[String]) -> Result<Vec<&'static Case>, Failure> {
    if names.is_empty() || names.iter().any(|name| name == "all") {
        return Ok(CASES.iter().collect());
    }
    let find = |name: &String| {
        CASES.iter().find(|case| case.name == name).ok_or_else(|| {
            let failure = Failure::input(format!("there is no case '{name}'"));
            failure.with_help(match nearest(name, CASES.iter().map(|case| case.name)) {
                Some(near) => format!("did you mean '{near}'? koiter validate --list names all"),
                None => "koiter validate --list names all".to_owned(),
            })
        })
    };
    let mut cases: Vec<&'static Case> = Vec::new();
    for name in names {
        let case = find(name)?;
        if !cases.iter().any(|chosen| chosen.name == case.name) {
            cases.push(case);
        }
    }
    Ok(cases)
}

fn list(json: bool) {
    if json {
        let all: Vec<_> = (CASES.iter())
            .map(|case| json!({ "case": case.name, "title": case.title, "levels": case.levels }))
            .collect();
        say!("{}", json!({ "cases": all }));
        return;
    }
    for case in CASES {
        say!("{:26} {}", case.name, case.title);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use koiter::scene::model::BendingModel;

    #[test]
    fn every_case_has_a_sound_scene_and_its_published_values() {
        for case in CASES {
            assert!(!case.quantities().is_empty(), "{}", case.name);
            for quantity in case.quantities() {
                assert!(quantity.reference.is_finite(), "{}", case.name);
            }
            for pair in case.levels.windows(2) {
                let doubled: Vec<usize> = pair[0].iter().map(|n| 2 * n).collect();
                assert_eq!(pair[1], doubled, "{}", case.name);
            }
            let scene = study::scene(case, BendingModel::Dso, case.levels[0]).unwrap();
            assert_eq!(scene.model.shells[0].bending, BendingModel::Dso);
        }
    }

    #[test]
    fn a_column_and_a_plate_are_what_is_published() {
        for (name, tolerance) in [("euler-hinged", 0.01), ("plate-supported-pressure", 0.01)] {
            let case = chosen(&[name.to_owned()]).unwrap()[0];
            // The coarsest of its meshes.
            let study = Study::new(case, BendingModel::Dkt, 1).unwrap();
            for finding in &study.findings {
                assert!(
                    finding.deviation.abs() < tolerance,
                    "{name}: {}",
                    finding.deviation
                );
            }
        }
    }
}
