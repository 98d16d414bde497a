use super::*;

/// The scene with a process, and another bending model.
fn with(bending: &str, process: &str) -> Result<SceneFile, SceneError> {
    let shell = format!("thickness = 1e-3\nbending = \"{bending}\"");
    let scene = SCENE.replace("thickness = 1e-3", &shell);
    parse(&format!(
        "{scene}\n[[process]]\nname = \"p\"\nshell = \"cloth\"\n{process}\n"
    ))
}

/// Kind and path of the mistake.
fn mistake_of(bending: &str, process: &str) -> (Kind, String) {
    let error = with(bending, process).expect_err(process);
    (error.kind, error.path)
}

#[test]
fn a_process_is_a_curl_a_crease_or_a_yield() {
    for (bending, process) in [
        ("bac", "curl = { radius = -0.1, axis = [0.0, 1.0, 0.0] }"),
        (
            "ds-theta",
            "crease = { select.all = true, degrees = 200.0 }",
        ),
        (
            "dcs",
            "crease = { line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], degrees = 90.0 }",
        ),
        (
            "ds-tan",
            "yield = { degrees = 3.0, rate = 10.0, hardening = 0.2 }",
        ),
        ("dkt", "yield = { curvature = 3.0 }"),
    ] {
        let spec = with(bending, process).unwrap().spec;
        assert_eq!(spec.process[0].name, "p");
    }
    assert_eq!(
        mistake_of("bac", ""),
        (Kind::MissingKey, "process.p".into())
    );
    let two = "curl = { radius = 0.1, axis = [0.0, 1.0, 0.0] }\nyield = { curvature = 3.0 }";
    assert_eq!(
        mistake_of("bac", two),
        (Kind::Conflict, "process.p.yield".into())
    );
}

#[test]
fn processes_have_ranges_and_thresholds_of_their_model() {
    for (bending, process, kind, path) in [
        (
            "bac",
            "curl = { radius = 0.0, axis = [0.0, 1.0, 0.0] }",
            Kind::OutOfRange,
            "curl.radius",
        ),
        (
            "bac",
            "curl = { radius = 1.0, axis = [0.0, 0.0, 0.0] }",
            Kind::OutOfRange,
            "curl.axis",
        ),
        (
            "bac",
            "crease = { select.all = true, degrees = 200.0 }",
            Kind::OutOfRange,
            "crease.degrees",
        ),
        (
            "bac",
            "crease = { degrees = 20.0 }",
            Kind::MissingKey,
            "crease",
        ),
        (
            "dkt",
            "crease = { select.all = true, degrees = 20.0 }",
            Kind::Conflict,
            "",
        ),
        ("qb-cr", "yield = { curvature = 3.0 }", Kind::Conflict, ""),
        (
            "bac",
            "yield = { degrees = 3.0 }",
            Kind::Conflict,
            "yield.degrees",
        ),
        ("bac", "yield = {}", Kind::MissingKey, "yield"),
        (
            "ds-theta",
            "yield = { degrees = 0.0 }",
            Kind::OutOfRange,
            "yield.degrees",
        ),
        (
            "bac",
            "yield = { curvature = 3.0, rate = -1.0 }",
            Kind::OutOfRange,
            "yield.rate",
        ),
        (
            "bac",
            "yield = { curvature = 3.0, hardening = -1.0 }",
            Kind::OutOfRange,
            "yield.hardening",
        ),
        (
            "bac",
            "yield = { curvature = 3.0 }\nscale = [[0.0, 0.5]]",
            Kind::Conflict,
            "scale",
        ),
    ] {
        let found = mistake_of(bending, process);
        let path = format!("process.p.{path}");
        assert_eq!(
            found,
            (kind, path.trim_end_matches('.').into()),
            "{process}"
        );
    }
}

#[test]
fn processes_need_a_shell_and_steps_that_follow_one_another() {
    let process = "[[process]]\nname = \"p\"\nshell = \"paper\"\nyield.curvature = 3.0\n";
    let error = parse(&format!("{SCENE}\n{process}")).unwrap_err();
    assert_eq!(error.path, "process.p.shell");
    let process = process.replace("paper", "cloth");
    let scene = format!("integrator = \"linear-static\"\n{SCENE}\n{process}");
    assert_eq!(parse(&scene).unwrap_err().path, "process.p");
}
