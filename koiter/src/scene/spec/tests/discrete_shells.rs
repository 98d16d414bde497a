use super::*;

const SPRINGS: &str = r#"thickness = 1e-3
bending = "ds-theta"
membrane = "discrete-shells"
discrete_shells = { edge_stiffness = 0.03, area_stiffness = 3.0, hinge_stiffness = 2e-5, hinge_weight = "simplified" }"#;

#[test]
fn springs_are_those_of_the_material_unless_they_are_given() {
    let plain = parse(SCENE).unwrap().spec;
    assert_eq!(plain.shell[0].membrane, MembraneModel::Koiter);
    assert!(plain.shell[0].discrete_shells.is_none());
    let given = parse(&SCENE.replace("thickness = 1e-3", SPRINGS))
        .unwrap()
        .spec;
    let numbers = given.shell[0].discrete_shells.as_ref().unwrap();
    assert_eq!(numbers.membrane().areas, Some(3.0));
    assert_eq!(numbers.hinges().stiffness, Some(2e-5));
}

#[test]
fn numbers_of_springs_have_ranges_and_springs() {
    let mistake_in = |from: &str, to: &str| {
        let springs = SPRINGS.replace(from, to);
        assert!(springs != SPRINGS, "{from}");
        parse(&SCENE.replace("thickness = 1e-3", &springs)).unwrap_err()
    };
    let error = mistake_in("edge_stiffness = 0.03", "edge_stiffness = 0.0");
    assert_mistake(
        &error,
        Kind::OutOfRange,
        "shell.cloth.discrete_shells.edge_stiffness",
        (10, "0.0"),
        &["larger than 0"],
    );
    let error = mistake_in("area_stiffness = 3.0", "area_stiffness = -3.0");
    assert_eq!(error.kind, Kind::OutOfRange);
    let error = mistake_in("hinge_weight = \"simplified\"", "hinge_weight = \"simple\"");
    let help = error.help.as_deref().unwrap_or_default();
    assert!(
        format!("{error} {help}").contains("simplified"),
        "{error} {help}"
    );
    let error = mistake_in("membrane = \"discrete-shells\"", "membrane = \"koiter\"");
    assert_eq!(error.path, "shell.cloth.discrete_shells.edge_stiffness");
    assert_eq!(error.kind, Kind::Conflict);
    let error = mistake_in("bending = \"ds-theta\"", "bending = \"bac\"");
    assert_eq!(error.path, "shell.cloth.discrete_shells.hinge_stiffness");
}
