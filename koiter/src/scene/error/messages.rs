//! One mistake of every kind, and what is said about it.

use std::collections::BTreeSet;

use super::{SceneError, SceneErrorKind as Kind};
use crate::scene::{NoFiles, Scene, SceneFile};

const SCENE: &str = r#"title = "Test"
time = { end = 1.0, dt = 0.1 }
[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }
[[obstacle]]
name = "rod"
capsule = { ends = [[0, 0, -1], [1, 0, -1]], radius = 0.1 }
[[constraint]]
shell = "cloth"
select.boundary = 0
"#;

/// Every kind, and its name; the compiler asks for those that are missing here, the test for those without a mistake.
macro_rules! kinds {
    ($($kind:ident),*) => {
        const KINDS: &[&str] = &[$(stringify!($kind)),*];

        fn name(kind: Kind) -> &'static str {
            match kind {
                $(Kind::$kind => stringify!($kind)),*
            }
        }
    };
}

kinds!(
    Syntax,
    UnknownKey,
    MissingKey,
    WrongType,
    OutOfRange,
    UnknownName,
    Conflict,
    EmptySelection,
    Mesh,
    TooLarge
);

/// The mistake of the scene with one piece replaced.
fn mistake(from: &str, to: &str) -> SceneError {
    assert!(SCENE.contains(from), "{from}");
    let text = SCENE.replacen(from, to, 1);
    let error = SceneFile::parse("scene.toml", &text, &[])
        .and_then(|file| Scene::build_within(&file, &NoFiles, 1_000_000_000).map(|_| ()));
    error.expect_err("the scene has a mistake")
}

#[test]
fn every_kind_of_mistake_has_a_place_and_says_what_to_do() {
    let material = "material = \"cotton\"";
    let grid = "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }";
    let capsule = "capsule = { ends = [[0, 0, -1], [1, 0, -1]], radius = 0.1 }";
    let boundary = "select.boundary = 0";
    let cases = [
        (
            "end = 1.0,",
            "end = 1.0;",
            Kind::Syntax,
            2,
            "not valid TOML",
        ),
        (
            "title",
            "titel",
            Kind::UnknownKey,
            1,
            "unknown key 'titel' | did you mean 'title'?",
        ),
        (
            material,
            "",
            Kind::MissingKey,
            3,
            "neither a material preset nor 'material.young' | write material = \"cotton\"",
        ),
        (
            grid,
            "mesh = {}",
            Kind::MissingKey,
            6,
            "no shape is given | give exactly one of file, grid,",
        ),
        (
            capsule,
            "",
            Kind::MissingKey,
            7,
            "no shape is given | give exactly one of plane, sphere,",
        ),
        (
            "cells = [4, 4]",
            "cells = [4]",
            Kind::WrongType,
            6,
            "expected a list of 2 values, found a list of 1",
        ),
        (
            "size = [1.0, 1.0]",
            "size = 1",
            Kind::WrongType,
            6,
            "expected a list of 2 values, found the number 1",
        ),
        (
            "[1, 0, -1]",
            "[1, 0]",
            Kind::WrongType,
            9,
            "expected a list of 3 numbers [x, y, z]",
        ),
        (
            "dt = 0.1",
            "dt = 1979-05-27",
            Kind::WrongType,
            2,
            "a scene has no dates; write times as seconds",
        ),
        (
            "title = \"Test\"",
            "gravity_scale = [[0]]",
            Kind::WrongType,
            1,
            "expected a pair [time, value]",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nsolver.newmark.beta = 0.25",
            Kind::Conflict,
            3,
            "only the integrator \"newmark\" has these numbers | write integrator = \"newmark\", or",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nintegrator = \"newmark\"\nsolver.newmark.beta = 0.1",
            Kind::OutOfRange,
            4,
            "beta must be 0, for explicit steps, or lie between gamma/2 = 0.25 and 1, but it is 0.1 | between",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nintegrator = \"newmark\"\nsolver.newmark.gamma = 0.4",
            Kind::OutOfRange,
            4,
            "gamma must lie between 0.5 and 1, but it is 0.4 | 0.5 damps nothing",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nintegrator = \"newmark\"\nsolver.newmark.beta = 0",
            Kind::Conflict,
            4,
            "explicit steps (beta = 0) know no contact | set contact.enabled = false",
        ),
        (
            material,
            "material = \"cotton\"\nstrain_limit.stretch = 0.1",
            Kind::OutOfRange,
            6,
            "stretch must be larger than 1, the length at rest, but it is 0.1 | a limit of 10 % is stretch = 1.1",
        ),
        (
            material,
            "material = \"cotton\"\nstrain_limit = { stretch = 1.1, begin = 1.1 }",
            Kind::OutOfRange,
            6,
            "begin must be at least 1 and less than stretch = 1.1, but it is 1.1",
        ),
        (
            material,
            "material = \"cotton\"\nstrain_limit = { stretch = 1.1, stiffness = 0 }",
            Kind::OutOfRange,
            6,
            "stiffness must be larger than 0, but it is 0 Pa",
        ),
        (
            "dt = 0.1",
            "dt = 1e-12",
            Kind::OutOfRange,
            2,
            "1.0e12 time steps | make dt larger or end smaller",
        ),
        (
            "end = 1.0",
            "end = inf",
            Kind::OutOfRange,
            2,
            "inf is not a finite number | leave a limit out",
        ),
        (
            "[1, 0, -1]",
            "[0, 0, -1]",
            Kind::OutOfRange,
            9,
            "the two ends are the same point | use a sphere",
        ),
        (
            "title = \"Test\"",
            "gravity_scale = []",
            Kind::OutOfRange,
            1,
            "no keys | write pairs [time, value]",
        ),
        (
            "\"cotton\"",
            "\"coton\"",
            Kind::UnknownName,
            5,
            "there is no material 'coton' | did you mean 'cotton'?",
        ),
        (
            material,
            "material = \"cotton\"\nbending = \"bca\"",
            Kind::UnknownName,
            6,
            "unknown name 'bca' | did you mean 'bac'?",
        ),
        (
            boundary,
            "select.boundary = 0\naxes = \"xx\"",
            Kind::UnknownName,
            13,
            "axes must be some of x, y and z, each once, but they are \"xx\" | write \"xyz\"",
        ),
        (
            grid,
            "mesh.grid = { size = [1, 1], cells = [2, 2] }\nmesh.file = \"a.obj\"",
            Kind::Conflict,
            6,
            "2 shapes are given: file, grid | keep one of them",
        ),
        (
            "title = \"Test\"",
            "output = { every_steps = 2, every_seconds = 1 }",
            Kind::Conflict,
            1,
            "every_steps and every_seconds exclude each other",
        ),
        (
            boundary,
            "select.vertices = [25]",
            Kind::EmptySelection,
            12,
            "vertex 25 does not exist: the shell has 25 vertices, numbered from 0",
        ),
        (
            boundary,
            "select.boundary = 1",
            Kind::EmptySelection,
            12,
            "boundary loop 1 does not exist: the shell has 1 loops, numbered from 0",
        ),
        (
            boundary,
            "select.box = { min = [2, 2, 2], max = [3, 3, 3] }",
            Kind::EmptySelection,
            12,
            "the selection has no vertices; the shell's start shape lies between [-0.5000",
        ),
        (
            "[[obstacle]]",
            "[[symmetry]]\nshell = \"cloth\"\nnormal = \"x\"\n[[obstacle]]",
            Kind::Conflict,
            7,
            "shell 'cloth' lies on both sides of the plane x = 0 m",
        ),
        (
            "[[obstacle]]",
            "[[symmetry]]\nshell = \"cloth\"\nnormal = \"z\"\n[[obstacle]]",
            Kind::Conflict,
            9,
            "shell 'cloth' lies in the plane z = 0 m | a plane of symmetry cuts the shell",
        ),
        (
            "[[obstacle]]",
            "[[symmetry]]\nshell = \"cloth\"\nnormal = \"y\"\nat = 0.6\n[[obstacle]]",
            Kind::EmptySelection,
            10,
            "no vertices on the plane y = 0.6 m: it lies between -0.5000 m and 0.5000 m",
        ),
        (
            "[[obstacle]]",
            "bending = \"ds-theta\"\n[[symmetry]]\nshell = \"cloth\"\nnormal = \"x\"\nat = 0.5\n[[obstacle]]",
            Kind::Conflict,
            8,
            "the bending model 'ds-theta' of shell 'cloth', which has no directors, bends freely",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nsolver.smallest_step = 2.0",
            Kind::OutOfRange,
            3,
            "smallest_step is a share of a step, at most 1, but it is 2",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nintegrator = \"arc-length\"\ncontact.enabled = true",
            Kind::Conflict,
            4,
            "arc length follows equilibria without contact, but contact is on: set contact.enabled = false",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\ncontact.enabled = false\nintegrator = \"arc-length\"",
            Kind::Conflict,
            4,
            "arc length has no load to follow",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nintegrator = \"arc-length\"\ncontact.enabled = false\ngravity_scale = [[0, 0], [1, 1], [2, 0]]",
            Kind::Conflict,
            5,
            "write the schedule of gravity as a line from zero",
        ),
        (
            "dt = 0.1 }",
            "dt = 0.1 }\nsolver.last_load_factor = -1.0",
            Kind::OutOfRange,
            3,
            "last_load_factor must be larger than 0, but it is -1",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"tip\"\nshell = \"cloth\"",
            Kind::MissingKey,
            13,
            "the load has no magnitude | give exactly one of force, force_each,",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"tip\"\nshell = \"cloth\"\nforce = [0, 0, 1]\npressure = 2",
            Kind::Conflict,
            17,
            "'force' and 'pressure' are two loads | write a [[load]] for each",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"p\"\nshell = \"cloth\"\npressure = 1\nselect.boundary = 0",
            Kind::Conflict,
            17,
            "a load by 'pressure' takes no 'select' | pressure acts on the whole shell",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"tip\"\nshell = \"cloht\"\npressure = 2",
            Kind::UnknownName,
            15,
            "there is no shell 'cloht' | did you mean 'cloth'?",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"m\"\nshell = \"cloth\"\nmoment_per_length = 1\nselect.vertices = [6, 7]",
            Kind::EmptySelection,
            17,
            "no boundary edge has both its ends in the selection | edges = \"all\" takes inner edges too",
        ),
        (
            boundary,
            "select.boundary = 0\n[[load]]\nname = \"p\"\nshell = \"cloth\"\nforce_per_area = [0, 0, 1]\nselect.vertices = [0, 1]",
            Kind::EmptySelection,
            17,
            "no triangle has all its corners in the selection | select the three corners",
        ),
        (
            "[[obstacle]]",
            "bending = \"ds-theta\"\n[[load]]\nname = \"m\"\nshell = \"cloth\"\nmoment_per_length = 1\nselect.boundary = 0\n[[obstacle]]",
            Kind::Conflict,
            11,
            "which the bending model 'ds-theta' of shell 'cloth' has not | use bending = \"bac\"",
        ),
        (
            grid,
            "mesh.file = \"a.obj\"",
            Kind::Mesh,
            6,
            "this scene may not read files",
        ),
        (
            material,
            "material = \"cotton\"\nrest_mesh.grid = { size = [1, 1], cells = [3, 3] }",
            Kind::Mesh,
            6,
            "the rest mesh must have the triangles of the start mesh",
        ),
        (
            "cells = [4, 4]",
            "cells = [4, 0]",
            Kind::Mesh,
            6,
            "the number of cells along y must be at least 1, but it is 0",
        ),
        (
            "cells = [4, 4]",
            "cells = [4000, 4000]",
            Kind::TooLarge,
            6,
            "3.2e7 triangles and needs about 576.0 GB of memory; the limit is 1.0 GB | make the mesh coarser",
        ),
    ];
    let mut seen = BTreeSet::new();
    for (from, to, kind, line, words) in cases {
        let error = mistake(from, to);
        let help = error.help.as_deref().unwrap_or("");
        let said = format!("{} | {help}", error.message);
        assert!(said.contains(words), "'{words}' is not in: {said}");
        assert_eq!(error.kind, kind, "{said}");
        assert_eq!(
            error.location.map(|place| place.line()),
            Some(line),
            "{said}"
        );
        seen.insert(name(kind));
    }
    assert_eq!(seen, KINDS.iter().copied().collect());
}
