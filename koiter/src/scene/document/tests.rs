use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::spec::SceneFile;

const SCENE: &str = r#"
time = { end = 1.0, dt = 0.02 }

[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }

[[constraint]]
shell = "cloth"
select.boundary = 0

[variants.resolution]
default = "coarse"
[variants.resolution.coarse]
[variants.resolution.fine]
shell.cloth.mesh.grid.cells = [40, 40]
"time.dt" = 0.01
"#;

fn parse(overrides: &[&str]) -> Result<SceneFile, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    SceneFile::parse("scene.toml", SCENE, &overrides)
}

#[test]
fn overrides_set_values_by_dotted_path() {
    let spec = parse(&[
        "time.dt=0.5",
        "shell.cloth.material.young = 2e6",
        "shell.cloth.bending=dcs",
        "constraint.0.until=3",
        "contact.enabled=false",
        "gravity=[0,0,-1.62]",
    ])
    .unwrap()
    .spec;
    assert_eq!(spec.time.unwrap().dt, 0.5);
    assert_eq!(spec.shell[0].material.young, Some(2e6));
    assert_eq!(spec.shell[0].material.preset.as_deref(), Some("cotton"));
    assert_eq!(
        spec.shell[0].bending,
        crate::scene::model::BendingModel::Dcs
    );
    assert_eq!(spec.constraint[0].until, Some(3.0));
    assert!(!spec.contact.enabled);
    assert_eq!(spec.gravity[2], -1.62);
    let spec = parse(&["shell.cloth.material=paper"]).unwrap().spec;
    assert_eq!(spec.shell[0].material.preset.as_deref(), Some("paper"));
}

#[test]
fn a_table_in_an_override_replaces_the_whole_table() {
    let spec = parse(&["shell.cloth.mesh={disc={radius=1,rings=3}}"])
        .unwrap()
        .spec;
    assert!(spec.shell[0].mesh.grid.is_none() && spec.shell[0].mesh.disc.is_some());
}

#[test]
fn variants_are_picked_by_name_and_other_overrides_win() {
    let cells = |overrides: &[&str]| {
        parse(overrides).unwrap().spec.shell[0]
            .mesh
            .grid
            .clone()
            .unwrap()
            .cells
    };
    assert_eq!(cells(&[]), [4, 4]);
    assert_eq!(cells(&["resolution=fine"]), [40, 40]);
    assert_eq!(cells(&["resolution=\"fine\""]), [40, 40]);
    assert_eq!(
        cells(&["shell.cloth.mesh.grid.cells=[7,7]", "resolution=fine"]),
        [7, 7]
    );
    assert_eq!(
        parse(&["resolution=fine"]).unwrap().spec.time.unwrap().dt,
        0.01
    );
}

#[test]
fn mistakes_in_overrides_point_into_the_override() {
    let cases = [
        ("time.dt", Kind::Syntax, "time.dt", "no '='"),
        ("time.dt=[1", Kind::Syntax, "", "not valid TOML"),
        ("time.dt=-1", Kind::OutOfRange, "-1", "larger than 0"),
        ("time.dt=fast", Kind::WrongType, "fast", "expected a number"),
        ("time.dtt=1", Kind::UnknownKey, "dtt", "unknown key 'dtt'"),
        (
            "resolution=fien",
            Kind::UnknownName,
            "fien",
            "did you mean 'fine'",
        ),
        (
            "shell.clot.thickness=1",
            Kind::UnknownName,
            "clot",
            "did you mean 'cloth'",
        ),
        (
            "shell.cloth.mesh.grid.cells=[7]",
            Kind::WrongType,
            "[7]",
            "list of 2",
        ),
        (
            "shell.cloth.name.x=1",
            Kind::WrongType,
            "x",
            "has no key 'x'",
        ),
        (
            "shells.cloth.thickness=1",
            Kind::UnknownKey,
            "shells",
            "did you mean 'shell'",
        ),
    ];
    let deep = format!("\"{}\"=1", "a.".repeat(100_000));
    let error = parse(&[&deep]).unwrap_err();
    assert!(error.message.contains("more than 32 keys"), "{error}");
    for (text, kind, marked, words) in cases {
        let error = parse(&[text]).unwrap_err();
        let location = error.location.clone().unwrap();
        let said = format!(
            "{} | {}",
            error.message,
            error.help.as_deref().unwrap_or("")
        );
        assert_eq!(error.kind, kind, "{text}: {said}");
        assert_eq!(location.source.name, format!("--set {text}"), "{said}");
        assert!(said.contains(words), "{text}: {said}");
        if !marked.is_empty() {
            assert_eq!(location.text(), marked, "{text}: {said}");
        }
    }
}

#[test]
fn variants_without_default_or_with_a_wrong_default_are_refused() {
    let parse = |text: &str| SceneFile::parse("scene.toml", text, &[]).unwrap_err();
    let error = parse(&SCENE.replace("default = \"coarse\"", ""));
    assert_eq!(
        (error.kind, error.path.as_str()),
        (Kind::MissingKey, "variants.resolution")
    );
    let error = parse(&SCENE.replace("default = \"coarse\"", "default = \"corse\""));
    assert_eq!(error.location.unwrap().text(), "\"corse\"");
    assert!(error.help.unwrap().contains("did you mean 'coarse'"));
}

#[test]
fn mistakes_in_a_variant_point_at_its_line() {
    let text = SCENE.replace("\"time.dt\" = 0.01", "\"time.dt\" = -0.01");
    let error = SceneFile::parse("scene.toml", &text, &["resolution=fine".into()]).unwrap_err();
    assert_eq!(
        (error.path.as_str(), error.location.unwrap().line()),
        ("time.dt", 18)
    );
}

#[test]
fn a_document_written_out_reads_back_the_same() {
    let file = parse(&[
        "resolution=fine",
        "title=\"a 'quoted' \\\\ title\"",
        "contact.d_hat=1e-3",
    ])
    .unwrap();
    let text = file.document.to_toml();
    let again = SceneFile::parse("again", &text, &[]).unwrap();
    assert_eq!(format!("{:?}", again.spec), format!("{:?}", file.spec));
    assert_eq!(again.document.to_toml(), text);
    assert!(
        text.contains("[[shell]]") && text.contains("cells = [40, 40]"),
        "{text}"
    );
}
