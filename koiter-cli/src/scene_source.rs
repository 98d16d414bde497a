//! Where scenes and their meshes come from: files, or the scenes that ship inside the program.

use std::path::{Path, PathBuf};

use koiter::burning::{QuadMesh, Texture};
use koiter::io::read::{MeshFormat, RawMesh, ReadError, parse_obj_quads, parse_png};
use koiter::io::{MAX_SCENE_BYTES, read_bounded, read_mesh, read_points, read_quads, read_texture};
use koiter::mesh::{MeshError, Surface, SurfaceOptions};
use koiter::scene::{
    Document, MeshSource, PointCache, Scene, SceneError, SceneErrorKind, SceneFile, UnreadableMesh,
    nearest,
};
use koiter_render::CameraView;

use crate::arguments::SceneArguments;
use crate::failure::{Failure, print_warning};
use crate::memory;

/// A scene that ships with the program.
struct Shipped {
    name: &'static str,
    text: &'static str,
    meshes: &'static [(&'static str, &'static [u8])],
}

const SHIPPED: &[Shipped] = &[
    Shipped {
        name: "sphere-drape",
        text: include_str!("../../scenes/sphere-drape/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "drape-n",
        text: include_str!("../../scenes/drape-n/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "cantilever",
        text: include_str!("../../scenes/cantilever/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "hanging-sheet",
        text: include_str!("../../scenes/hanging-sheet/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "flag-in-the-wind",
        text: include_str!("../../scenes/flag-in-the-wind/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "v-beam",
        text: include_str!("../../scenes/v-beam/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "rolled-strip",
        text: include_str!("../../scenes/rolled-strip/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "hinged-roof",
        text: include_str!("../../scenes/hinged-roof/scene.toml"),
        meshes: &[(
            "roof.obj",
            include_bytes!("../../scenes/hinged-roof/roof.obj"),
        )],
    },
    Shipped {
        name: "lateral-buckling",
        text: include_str!("../../scenes/lateral-buckling/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "popper",
        text: include_str!("../../scenes/popper/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "pinned-drop",
        text: include_str!("../../scenes/pinned-drop/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "ball-crash",
        text: include_str!("../../scenes/ball-crash/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "twisted-cylinder",
        text: include_str!("../../scenes/twisted-cylinder/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "can-crush",
        text: include_str!("../../scenes/can-crush/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "cone-crush",
        text: include_str!("../../scenes/cone-crush/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "twisted-sheet",
        text: include_str!("../../scenes/twisted-sheet/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "corrugated-collision",
        text: include_str!("../../scenes/corrugated-collision/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "beams",
        text: include_str!("../../scenes/beams/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "hats",
        text: include_str!("../../scenes/hats/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "paper-sheet",
        text: include_str!("../../scenes/paper-sheet/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "burning-hat",
        text: include_str!("../../scenes/burning-hat/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "hot-sphere",
        text: include_str!("../../scenes/hot-sphere/scene.toml"),
        meshes: &[(
            "patches.png",
            include_bytes!("../../scenes/hot-sphere/patches.png"),
        )],
    },
    Shipped {
        name: "burning-paper",
        text: include_str!("../../scenes/burning-paper/scene.toml"),
        meshes: &[(
            "patches.png",
            include_bytes!("../../scenes/burning-paper/patches.png"),
        )],
    },
    Shipped {
        name: "burning-torus",
        text: include_str!("../../scenes/burning-torus/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "torus-on-sphere",
        text: include_str!("../../scenes/torus-on-sphere/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "shrinking-sheet",
        text: include_str!("../../scenes/shrinking-sheet/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "scordelis-lo-bezier",
        text: include_str!("../../scenes/scordelis-lo-bezier/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "pinched-hemisphere-bezier",
        text: include_str!("../../scenes/pinched-hemisphere-bezier/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "vessel-patch",
        text: include_str!("../../scenes/vessel-patch/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "head-through-ellipsoid",
        text: include_str!("../../scenes/head-through-ellipsoid/scene.toml"),
        meshes: &[],
    },
    Shipped {
        name: "your-own-mesh",
        text: include_str!("../../scenes/your-own-mesh/scene.toml"),
        meshes: &[(
            "poncho.obj",
            include_bytes!("../../scenes/your-own-mesh/poncho.obj"),
        )],
    },
];

/// A scene that was read and checked, meshes included.
pub(crate) struct LoadedScene {
    /// Name for result folders.
    pub(crate) name: String,
    /// The scene as it is run, overrides included.
    pub(crate) text: String,
    /// The same with the places of its keys.
    pub(crate) document: Document,
    /// The checked scene.
    pub(crate) scene: Scene,
}

/// Finds, reads and checks a scene; prints its warnings.
pub(crate) fn load(arguments: &SceneArguments) -> Result<LoadedScene, Failure> {
    let loaded = load_silently(arguments)?;
    loaded.scene.warnings.iter().for_each(print_warning);
    Ok(loaded)
}

/// Finds, reads and checks a scene; its warnings are in it.
pub(crate) fn load_silently(arguments: &SceneArguments) -> Result<LoadedScene, Failure> {
    let found = find(&arguments.scene)?;
    let file = SceneFile::parse(&found.display, &found.text, &arguments.overrides)?;
    check_camera(&file)?;
    let memory = arguments.memory.or_else(memory::available_bytes);
    let scene = Scene::build_within(&file, &found.meshes, memory.unwrap_or(u64::MAX))
        .map_err(|error| tell_of_memory(error, arguments))?;
    Ok(LoadedScene {
        name: found.name,
        text: file.document.to_toml(),
        document: file.document,
        scene,
    })
}

/// The library knows neither the machine nor how to contradict it.
fn tell_of_memory(error: SceneError, arguments: &SceneArguments) -> SceneError {
    match (error.kind, arguments.memory) {
        (SceneErrorKind::TooLarge, None) => error.with_help(
            "the limit is what this machine has to spare; make the mesh coarser; --memory 64GB, or another size, tries all the same",
        ),
        (SceneErrorKind::TooLarge, Some(_)) => {
            error.with_help("make the mesh coarser, or allow more with --memory")
        }
        _ => error,
    }
}

/// The library knows no cameras; a wrong one should not show only after a long run.
fn check_camera(file: &SceneFile) -> Result<(), SceneError> {
    let Some(Err(error)) = file
        .spec
        .output
        .camera
        .as_deref()
        .map(str::parse::<CameraView>)
    else {
        return Ok(());
    };
    let path = "output.camera";
    let error = SceneError::new(SceneErrorKind::UnknownName, error.to_string()).inside(path);
    Err(error.or_at(file.document.locate(path).as_ref()))
}

struct Found {
    name: String,
    /// What messages call it.
    display: String,
    text: String,
    meshes: Meshes,
}

enum Meshes {
    Folder(PathBuf),
    Shipped(&'static Shipped),
}

fn find(argument: &str) -> Result<Found, Failure> {
    let path = Path::new(argument);
    let shipped = SHIPPED.iter().find(|shipped| shipped.name == argument);
    let scene = match path.is_dir() {
        true => path.join("scene.toml"),
        false => path.to_owned(),
    };
    // A folder of that name without a scene, such as the result of a run, does not hide a scene that ships.
    if scene.exists() || (path.exists() && shipped.is_none()) {
        return read(&scene);
    }
    if let Some(shipped) = shipped {
        return Ok(Found {
            name: argument.to_owned(),
            display: format!("{argument}/scene.toml (shipped)"),
            text: shipped.text.to_owned(),
            meshes: Meshes::Shipped(shipped),
        });
    }
    let names: Vec<&str> = SHIPPED.iter().map(|shipped| shipped.name).collect();
    let failure = Failure::input(format!(
        "there is no file, folder or shipped scene '{argument}'"
    ));
    let list = format!("scenes that ship: {}", names.join(", "));
    Err(failure.with_help(match nearest(argument, names) {
        Some(name) => format!("did you mean '{name}'? {list}"),
        None => list,
    }))
}

fn read(path: &Path) -> Result<Found, Failure> {
    let bytes = read_bounded(path, MAX_SCENE_BYTES).map_err(|error| {
        Failure::input(format!("cannot read the scene {}: {error}", path.display()))
    })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let line = error.as_bytes()[..error.utf8_error().valid_up_to()]
            .iter()
            .filter(|&&b| b == b'\n')
            .count()
            + 1;
        let message = format!(
            "the scene {} is not UTF-8 text: see line {line}",
            path.display()
        );
        Failure::input(message).with_help("a scene is a TOML file, such as scene.toml")
    })?;
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    Ok(Found {
        name: name_of(path),
        display: path.display().to_string(),
        text,
        meshes: Meshes::Folder(folder),
    })
}

/// `my/flag/scene.toml` is called flag, `my/flag.toml` too.
fn name_of(path: &Path) -> String {
    let stem = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    if stem != "scene" {
        return stem;
    }
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    // `.` and `..` have no name of their own.
    let folder = folder.canonicalize().unwrap_or(folder);
    folder
        .file_name()
        .map_or(stem, |name| name.to_string_lossy().into_owned())
}

impl MeshSource for Meshes {
    fn read(&self, file: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        let raw = match self {
            Self::Folder(folder) => read_mesh(&folder.join(file)).map_err(unreadable)?,
            Self::Shipped(shipped) => shipped_mesh(shipped, file)?,
        };
        raw.into_surface(options).map_err(unreadable)
    }

    fn read_quads(&self, file: &str) -> Result<QuadMesh, UnreadableMesh> {
        match self.shipped_bytes(file) {
            Some(bytes) => parse_obj_quads(bytes).map_err(|error| broken(file, &error)),
            None => read_quads(&self.path(file)).map_err(unreadable),
        }
    }

    fn read_texture(&self, file: &str) -> Result<Texture, UnreadableMesh> {
        match self.shipped_bytes(file) {
            Some(bytes) => parse_png(bytes).map_err(|error| broken(file, &error)),
            None => read_texture(&self.path(file)).map_err(unreadable),
        }
    }

    fn read_points(&self, file: &str) -> Result<PointCache, UnreadableMesh> {
        read_points(&self.path(file)).map_err(unreadable)
    }

    fn read_text(&self, file: &str) -> Result<String, UnreadableMesh> {
        let path = self.path(file);
        let told = |error: &dyn std::fmt::Display| UnreadableMesh {
            message: format!("cannot read {}: {error}", path.display()),
            help: None,
        };
        let bytes = read_bounded(&path, MAX_SCENE_BYTES).map_err(|error| told(&error))?;
        String::from_utf8(bytes).map_err(|error| told(&error))
    }
}

impl Meshes {
    fn path(&self, file: &str) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(file),
            // Relative to where the program is run, as meshes of the user's are.
            Self::Shipped(_) => PathBuf::from(file),
        }
    }

    /// A file that ships with the scene.
    fn shipped_bytes(&self, file: &str) -> Option<&'static [u8]> {
        let Self::Shipped(shipped) = self else {
            return None;
        };
        let found = shipped.meshes.iter().find(|(name, _)| *name == file);
        found.map(|(_, bytes)| *bytes)
    }
}

fn broken(file: &str, error: &dyn std::fmt::Display) -> UnreadableMesh {
    UnreadableMesh {
        message: format!("{file}: {error}"),
        help: None,
    }
}

fn shipped_mesh(shipped: &Shipped, file: &str) -> Result<RawMesh, UnreadableMesh> {
    let Some((_, bytes)) = shipped.meshes.iter().find(|(name, _)| *name == file) else {
        // A mesh of the user's for a shipped scene: relative to where the program is run.
        return read_mesh(Path::new(file)).map_err(|error| {
            let help = format!(
                "the mesh files of the shipped '{}' apart, files are relative to where you are",
                shipped.name
            );
            UnreadableMesh {
                help: Some(help),
                ..unreadable(error)
            }
        });
    };
    let path = Path::new(file);
    let broken = |message: String| UnreadableMesh {
        message,
        help: None,
    };
    let format = MeshFormat::detect(bytes, path)
        .ok_or_else(|| broken(format!("{file} is of no known format")))?;
    let mesh = format
        .parse(bytes)
        .map_err(|error| broken(format!("{file}: {error}")))?;
    Ok(RawMesh {
        path: path.to_owned(),
        ..mesh
    })
}

fn unreadable(error: ReadError) -> UnreadableMesh {
    let help = match &error {
        ReadError::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
            Some("file names are relative to the scene's folder")
        }
        ReadError::Mesh {
            source: MeshError::InconsistentOrientation { .. },
            ..
        } => Some("repair_orientation = true in this mesh reverses such triangles"),
        _ => None,
    };
    UnreadableMesh {
        message: error.to_string(),
        help: help.map(ToOwned::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use koiter::scene::Simulation;

    use super::*;

    #[test]
    fn every_shipped_scene_and_variant_is_sound() {
        for shipped in SHIPPED {
            let found = find(shipped.name).unwrap();
            for overrides in [vec![], coarsest(shipped)] {
                let file = SceneFile::parse(shipped.name, &found.text, &overrides).unwrap();
                let scene = Scene::build(&file, &found.meshes).unwrap();
                // Published problems are as thick as they are, on meshes as fine as they need.
                let is_published = matches!(
                    shipped.name,
                    "hinged-roof"
                        | "lateral-buckling"
                        | "popper"
                        | "scordelis-lo-bezier"
                        | "vessel-patch"
                        | "head-through-ellipsoid"
                );
                assert!(
                    scene.warnings.is_empty() || is_published,
                    "{}: {:?}",
                    shipped.name,
                    scene.warnings
                );
            }
        }
    }

    /// The overrides that make a shipped scene as coarse as it comes.
    fn coarsest(shipped: &Shipped) -> Vec<String> {
        match shipped.name {
            "drape-n" => vec!["n=35".into()],
            _ if shipped.text.contains("[variants.resolution.tiny]") => {
                vec!["resolution=tiny".into()]
            }
            _ => vec![],
        }
    }

    #[test]
    fn every_shipped_scene_takes_its_first_steps() {
        for shipped in SHIPPED {
            let found = find(shipped.name).unwrap();
            let file = SceneFile::parse(shipped.name, &found.text, &coarsest(shipped)).unwrap();
            let scene = Scene::build(&file, &found.meshes).unwrap();
            let mut simulation = Simulation::new(scene.model).unwrap();
            for step in 1..=3 {
                let report = simulation.step(scene.timeline.dt(step)).unwrap();
                assert!(report.converged, "{}: {:?}", shipped.name, report.diagnosis);
            }
        }
    }

    #[test]
    fn a_result_is_named_after_the_scene_or_its_folder() {
        assert_eq!(name_of(Path::new("no/such/flag/scene.toml")), "flag");
        assert_eq!(name_of(Path::new("flag.toml")), "flag");
    }
}
