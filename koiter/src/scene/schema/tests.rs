use std::collections::BTreeSet;

use super::*;
use crate::scene::model::BendingModel;
use crate::scene::{SceneErrorKind, SceneFile};

/// One of each list, so that a path leads to every table.
const SCENE: &str = r#"
time = { end = 1.0, dt = 0.1 }
[[phase]]
name = "all"
end = 1.0
dt = 0.1
[[contact.pair]]
bodies = ["sheet", "floor"]
friction = 0.5
[[shell]]
name = "sheet"
material = { preset = "cotton", layers = [{ thickness = 1e-3, young = 1e6 }] }
mesh.grid = { size = [1.0, 1.0], cells = [2, 2] }
[[double_layer]]
name = "paper"
mesh.grid = { size = [1.0, 1.0], cells = [2, 2] }
thickness = 1e-3
area_density = 0.1
[[bezier_shell]]
name = "vessel"
material = { preset = "cotton", layers = [{ thickness = 1e-3, young = 1e6 }] }
mesh.grid = { size = [1.0, 1.0], cells = [2, 2] }
[[procedure]]
name = "incision"
at = 0.5
[[heat_source]]
name = "ball"
temperature = 1000.0
rate = 1.0
[[obstacle]]
name = "floor"
plane = {}
deform = [{ time = 1.0, mesh = {} }]
[[constraint]]
name = "pin"
shell = "sheet"
select.all = true
[[symmetry]]
shell = "sheet"
normal = "x"
at = 0.5
[[load]]
name = "lift"
shell = "sheet"
select.all = true
force = [0.0, 0.0, 1.0]
[[energy]]
name = "spring"
shell = "sheet"
on = "vertex"
energy = "z"
[[process]]
name = "fold"
shell = "sheet"
crease = { line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], degrees = 30.0 }
[[probe]]
name = "lowest"
quantity = "lowest"
shell = "sheet"
"#;

/// Follows references to the table, list or value that is meant.
fn resolve<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(path) => &root["$defs"][path.trim_start_matches("#/$defs/")],
        None => schema,
    }
}

/// Calls `visit` with the dotted path and schema of every table.
fn visit_tables(root: &Value, schema: &Value, path: &str, visit: &mut dyn FnMut(&str, &Value)) {
    let schema = resolve(root, schema);
    for choice in schema["anyOf"].as_array().into_iter().flatten() {
        visit_tables(root, choice, path, visit);
    }
    if schema["items"].is_object() {
        visit_tables(root, &schema["items"], &format!("{path}.0"), visit);
    }
    let Some(properties) = schema["properties"].as_object() else {
        return;
    };
    visit(path, schema);
    for (key, inner) in properties.iter().filter(|(key, _)| *key != "variants") {
        visit_tables(
            root,
            inner,
            format!("{path}.{key}").trim_matches('.'),
            visit,
        );
    }
}

/// The keys that the reader of scenes knows in the table at this path: it lists them when it meets another one.
fn keys_of_the_reader(path: &str) -> BTreeSet<String> {
    let unknown = format!("{path}.no_such_key=1");
    let error = SceneFile::parse("scene", SCENE, &[unknown.trim_matches('.').to_owned()])
        .expect_err("there is no such key");
    assert_eq!(error.kind, SceneErrorKind::UnknownKey, "{path}: {error}");
    let help = error.help.expect("keys are listed");
    let (_, list) = help.split_once("there are: ").expect("keys are listed");
    list.split(", ").map(ToOwned::to_owned).collect()
}

#[test]
fn every_table_has_the_keys_that_the_reader_knows_and_no_others() {
    let root = json_schema();
    let mut tables = 0;
    visit_tables(&root, &root, "", &mut |path, schema| {
        let mut keys: BTreeSet<String> = schema["properties"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect();
        if path.is_empty() {
            assert!(keys.remove("variants"));
        }
        assert_eq!(keys, keys_of_the_reader(path), "{path}");
        assert_eq!(schema["additionalProperties"], false, "{path}");
        tables += 1;
    });
    // Far more than the top level: the walk has not stopped early.
    assert!(tables > 40, "{tables} tables");
}

#[test]
fn keys_have_types_descriptions_with_units_and_defaults() {
    let root = json_schema();
    assert_eq!(
        root["$schema"],
        "https://json-schema.org/draft/2020-12/schema"
    );
    let shell = &root["$defs"]["ShellSpec"]["properties"];
    assert_eq!(shell["thickness"]["type"], "number");
    let text = shell["thickness"]["description"].as_str().unwrap();
    assert!(text.contains("[m]"), "{text}");
    assert_eq!(shell["friction"]["default"], 0.3);
    assert_eq!(shell["bending"]["default"], "bac");
    let models: Vec<&Value> = root["$defs"]["BendingModel"]["oneOf"]
        .as_array()
        .unwrap()
        .iter()
        .map(|choice| &choice["const"])
        .collect();
    let named = BendingModel::ALL.map(|model| model.info().name);
    assert_eq!(models, named);
    let names = &shell["material"]["anyOf"][0]["enum"];
    assert_eq!(names[0], "cotton");
    assert!(!root.to_string().contains("null"), "TOML has no null");
    visit_tables(&root, &root, "", &mut |path, schema| {
        for (key, value) in schema["properties"].as_object().unwrap() {
            assert!(
                value["description"].is_string(),
                "{path}.{key} is not described"
            );
        }
    });
}
