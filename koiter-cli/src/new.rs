//! `koiter new`: a commented scene to start from.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use koiter::io::write::{MeshWithFields, obj_bytes};
use koiter::mesh::generate::disc;
use serde_json::json;

use crate::arguments::{NewArguments, Template};
use crate::failure::Failure;
use crate::output::{quoted, say};

/// Writes the files of a template; nothing that is there is touched.
pub(crate) fn new(arguments: &NewArguments) -> Result<(), Failure> {
    let name = &arguments.name;
    let is_file = name
        .extension()
        .is_some_and(|extension| extension == "toml");
    let scene = if is_file {
        name.clone()
    } else {
        name.join("scene.toml")
    };
    let files = files(arguments.template, &scene)?;
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        let message = format!("{} is there already", path.display());
        return Err(
            Failure::input(message).with_help("choose another name; nothing is overwritten")
        );
    }
    for (index, (path, bytes)) in files.iter().enumerate() {
        write_new(path, bytes).map_err(|error| {
            // All or nothing, so that the same command can be given again.
            files[..index]
                .iter()
                .for_each(|(path, _)| drop(fs::remove_file(path)));
            Failure::writing(path, &error)
        })?;
    }
    let made: Vec<String> = files
        .iter()
        .map(|(path, _)| path.display().to_string())
        .collect();
    if arguments.json {
        let template = arguments.template.name();
        say!(
            "{}",
            json!({ "scene": name.display().to_string(), "template": template, "made": made })
        );
        return Ok(());
    }
    made.iter().for_each(|path| say!("made: {path}"));
    say!("next:");
    say!(
        "  koiter check {}    reads it and says what it is",
        quoted(&name.to_string_lossy())
    );
    say!(
        "  koiter run {}      simulates it and makes a film",
        quoted(&name.to_string_lossy())
    );
    say!("and change {} in any editor", scene.display());
    Ok(())
}

fn files(template: Template, scene: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>, Failure> {
    let text = match template {
        Template::Drape => include_str!("../templates/drape.toml"),
        Template::Cantilever => include_str!("../templates/cantilever.toml"),
        Template::Mesh => include_str!("../templates/mesh.toml"),
        Template::Incision => include_str!("../templates/incision.toml"),
    };
    let mut files = vec![(scene.to_owned(), text.as_bytes().to_vec())];
    if template == Template::Mesh {
        // Something to start from until there is a mesh of one's own.
        let sheet = disc(0.25, 14).map_err(Failure::run)?;
        let bytes = obj_bytes(&MeshWithFields::of_surface(&sheet)).map_err(Failure::run)?;
        files.push((scene.with_file_name("mesh.obj"), bytes));
    }
    Ok(files)
}

fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        fs::create_dir_all(folder)?;
    }
    // A file that appeared meanwhile is an error, not overwritten.
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if written.is_err() {
        // Half a scene is of no use; that it cannot be removed either is not worth more words.
        let _ = fs::remove_file(path);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;
    use koiter::scene::{NoFiles, Scene, SceneFile};
    use serde_json::Value;

    /// The text with the keys that are not set set: the `#` before a letter or bracket taken away.
    fn with_all_keys(text: &str) -> String {
        let begins_key = |line: &str| {
            let rest = line.strip_prefix('#')?;
            rest.starts_with(|c: char| c == '[' || c.is_alphabetic())
                .then(|| rest.to_owned())
        };
        let lines = text
            .lines()
            .map(|line| begins_key(line).unwrap_or_else(|| line.to_owned()));
        lines.collect::<Vec<_>>().join("\n")
    }

    fn text_of(template: Template) -> String {
        let files = files(template, Path::new("a/scene.toml")).unwrap();
        String::from_utf8(files[0].1.clone()).unwrap()
    }

    #[test]
    fn templates_are_sound_with_and_without_the_keys_that_are_not_set() {
        for template in Template::value_variants().iter().copied() {
            for text in [text_of(template), with_all_keys(&text_of(template))] {
                let file = SceneFile::parse("template", &text, &[]).unwrap();
                if template != Template::Mesh {
                    let scene = Scene::build(&file, &NoFiles).unwrap();
                    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
                }
            }
        }
    }

    #[test]
    fn the_drape_explains_the_keys_that_are_commonly_used() {
        let text = with_all_keys(&text_of(Template::Drape));
        let schema = koiter::scene::json_schema();
        let tables = [
            // Loads and planes of symmetry are for engineers: the scenes rolled-strip and hinged-roof show them. Processes,
            // energies of one's own, what burns and what is cut have pages of their own.
            (
                &schema["properties"],
                &[
                    "variants",
                    "load",
                    "symmetry",
                    "process",
                    "double_layer",
                    "heat_source",
                    "bezier_shell",
                    "procedure",
                ][..],
            ),
            // Names for shapes that are not the sheet's start, and for experts.
            (
                &schema["$defs"]["ShellSpec"]["properties"],
                &[
                    "rest_mesh",
                    "rest_stretch",
                    "rest_curvature",
                    "faces",
                    "membrane",
                    "discrete_shells",
                    "damping",
                    "burning",
                    "temperature",
                ],
            ),
            (&schema["$defs"]["ConstraintSpec"]["properties"], &[]),
            (&schema["$defs"]["ContactSpec"]["properties"], &["kappa"]),
            // Of statics.
            (
                &schema["$defs"]["SolverSpec"]["properties"],
                &[
                    "newmark",
                    "first_arc_length",
                    "largest_arc_length",
                    "last_load_factor",
                ],
            ),
            (&schema["$defs"]["OutputSpec"]["properties"], &["fields"]),
        ];
        for (properties, left_out) in tables {
            let keys = properties
                .as_object()
                .map(|table| table.keys().collect::<Vec<_>>());
            for key in keys
                .unwrap()
                .into_iter()
                .filter(|key| !left_out.contains(&key.as_str()))
            {
                assert!(text.contains(key.as_str()), "{key}");
            }
        }
        assert_ne!(schema["$defs"]["ShellSpec"], Value::Null);
    }
}
