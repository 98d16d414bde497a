use super::*;

/// The scene with an energy.
fn with(energy: &str) -> Result<SceneFile, SceneError> {
    parse(&format!(
        "{SCENE}\n[[energy]]\nname = \"e\"\nshell = \"cloth\"\n{energy}\n"
    ))
}

fn mistake_of(energy: &str) -> SceneError {
    with(energy).expect_err(energy)
}

#[test]
fn an_energy_is_an_expression_of_an_element_with_parameters() {
    for energy in [
        "on = \"face\"\ndensity = \"k * (area / rest_area - 1)^2\"\nparameters = { k = 50 }",
        "on = \"vertex\"\nenergy = \"f * z\"\nparameters.f = [[0.0, 0.0], [1.0, 2.5]]\nselect.boundary = 0",
        "on = \"hinge\"\nenergy = \"angle^2 * time\"",
        "on = \"edge\"\ndissipation = \"vx^2 + length\"",
        "on = \"face\"\ndissipation_density = \"u = vx * nx; abs(u)^3\"",
        "on = \"shell\"\nenergy = \"(volume / rest_volume)^2\"",
    ] {
        let spec = with(energy).unwrap().spec;
        assert_eq!(spec.energy[0].name, "e");
    }
    let ramp =
        with("on = \"edge\"\nenergy = \"f * length\"\nparameters.f = [[0, 1], [2, 3]]").unwrap();
    assert_eq!(ramp.spec.energy[0].parameters["f"].0.at(1.0), 2.0);
    let constant = with("on = \"edge\"\nenergy = \"f * length\"\nparameters.f = 7").unwrap();
    assert_eq!(constant.spec.energy[0].parameters["f"].0.at(1.0), 7.0);
}

#[test]
fn what_is_no_force_is_refused() {
    for (energy, words) in [
        ("on = \"edge\"\nenergy = \"5\"", "nothing that changes"),
        (
            "on = \"vertex\"\nenergy = \"mass * rest_z\"",
            "nothing that changes",
        ),
        ("on = \"vertex\"\ndissipation = \"z^2\"", "no velocity"),
    ] {
        let error = mistake_of(energy);
        assert_eq!(error.kind, Kind::Conflict);
        assert!(error.message.contains(words), "{error}");
    }
}

#[test]
fn mistakes_of_expressions_point_at_their_key_and_column() {
    let error =
        mistake_of("on = \"face\"\ndensity = \"k * (aera / rest_area - 1)^2\"\nparameters.k = 1");
    assert_eq!(
        (error.kind, &*error.path),
        (Kind::UnknownName, "energy.e.density")
    );
    assert!(error.message.contains("column 6"), "{error}");
    assert!(error.help.unwrap().contains("did you mean 'area'?"));
    assert!(error.location.unwrap().text().contains("aera"));
    let error = mistake_of("on = \"face\"\nenergy = \"squrt(area)\"");
    assert!(error.help.unwrap().contains("did you mean 'sqrt'?"));
    let error = mistake_of("on = \"face\"\nenergy = \"vx^2\"");
    assert!(error.help.unwrap().contains("dissipation"));
    let error = mistake_of("on = \"face\"\nenergy = \"area +\"");
    assert_eq!(error.kind, Kind::Syntax);
}

#[test]
fn what_an_energy_cannot_be_is_refused() {
    for (energy, kind, path) in [
        ("on = \"face\"", Kind::MissingKey, "energy.e"),
        (
            "on = \"face\"\nenergy = \"area\"\ndensity = \"area\"",
            Kind::Conflict,
            "energy.e.density",
        ),
        (
            "on = \"shell\"\ndensity = \"area\"",
            Kind::Conflict,
            "energy.e.density",
        ),
        (
            "on = \"shell\"\nenergy = \"area\"\nselect.all = true",
            Kind::Conflict,
            "energy.e.select",
        ),
        (
            "on = \"face\"\nenergy = \"area\"\nparameters.area = 1",
            Kind::Conflict,
            "energy.e.parameters.area",
        ),
        (
            "on = \"face\"\nenergy = \"area\"\nparameters.k = []",
            Kind::OutOfRange,
            "energy.e.parameters.k",
        ),
        (
            "on = \"face\"\nenergy = \"area\"\nparameters.k = \"much\"",
            Kind::WrongType,
            "energy.e.parameters.k",
        ),
        (
            "on = \"cell\"\nenergy = \"1\"",
            Kind::UnknownName,
            "energy.e.on",
        ),
    ] {
        let error = mistake_of(energy);
        assert_eq!(
            (error.kind, &*error.path),
            (kind, path),
            "{energy}: {error}"
        );
    }
    let built_in = with("on = \"face\"\nenergy = \"area\"")
        .unwrap()
        .document
        .to_toml();
    let error = parse(&built_in.replace("\"e\"", "\"damping\"")).unwrap_err();
    assert_eq!(
        (error.kind, &*error.path),
        (Kind::Conflict, "energy.damping.name")
    );
}

#[test]
fn velocities_need_motion_and_paths_know_no_time() {
    let statics = |integrator: &str, energy: &str| {
        let scene = SCENE.replace(
            "time = {",
            &format!("integrator = \"{integrator}\"\ntime = {{"),
        );
        parse(&format!(
            "{scene}\n[[energy]]\nname = \"e\"\nshell = \"cloth\"\n{energy}\n"
        ))
    };
    let drag = "on = \"face\"\ndissipation = \"vx^2\"";
    assert_eq!(
        statics("quasi-static", drag).unwrap_err().kind,
        Kind::Conflict
    );
    assert!(statics("newmark", drag).is_ok());
    let ramp = "on = \"face\"\nenergy = \"area * time\"";
    assert!(statics("quasi-static", ramp).is_ok());
    assert_eq!(
        statics("arc-length", ramp).unwrap_err().kind,
        Kind::Conflict
    );
    let whole = "on = \"shell\"\nenergy = \"area\"";
    assert_eq!(
        statics("linear-static", whole).unwrap_err().kind,
        Kind::Conflict
    );
}

#[test]
fn a_probe_finds_an_energy_by_its_name() {
    let probe = |name: &str| {
        with(&format!(
            "on = \"face\"\nenergy = \"area\"\n[[probe]]\nname = \"p\"\nquantity = \"energy\"\nenergy = \"{name}\""
        ))
    };
    assert!(probe("e").is_ok() && probe("membrane").is_ok());
    let error = probe("f").unwrap_err();
    assert_eq!(
        (error.kind, &*error.path),
        (Kind::UnknownName, "probe.p.energy")
    );
}
