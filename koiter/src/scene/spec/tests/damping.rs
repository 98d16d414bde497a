use super::*;

#[test]
fn damping_is_none_unless_it_is_given_and_never_negative() {
    assert!(parse(SCENE).unwrap().spec.shell[0].damping.is_none());
    let with = |text: &str| SCENE.replace("thickness = 1e-3", &format!("thickness = 1e-3\n{text}"));
    let damped = parse(&with("damping = { stiffness = 1e-3, hinges = 1e-7 }")).unwrap();
    let options = damped.spec.shell[0].damping.as_ref().unwrap().resolve();
    assert_eq!(
        (options.mass, options.stiffness, options.hinges),
        (0.0, 1e-3, 1e-7)
    );
    let error = parse(&with("damping.mass = -1.0")).unwrap_err();
    assert_mistake(
        &error,
        Kind::OutOfRange,
        "shell.cloth.damping.mass",
        (8, "-1.0"),
        &["not be negative"],
    );
}

#[test]
fn the_watch_on_energy_has_a_positive_share() {
    let with = |share: &str| {
        let solver = format!("\n[solver.newmark]\nenergy_growth = {share}\n");
        parse(&format!("integrator = \"newmark\"\n{SCENE}{solver}"))
    };
    let spec = with("1e-3").unwrap().spec;
    assert_eq!(
        spec.solver.newmark.unwrap().resolve().energy_growth,
        Some(1e-3)
    );
    assert_eq!(
        with("0.0").unwrap_err().path,
        "solver.newmark.energy_growth"
    );
}
