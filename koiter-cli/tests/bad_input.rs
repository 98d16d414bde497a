//! What is wrong is said in one message, with its place and status 2.

mod program;

use std::path::Path;

use serde_json::Value;

use program::{SCENE, koiter, run_small, status, stderr, stdout, write_scene};

#[test]
fn a_scene_that_does_not_exist_is_answered_with_those_that_do() {
    let output = koiter(&["check", "spere-drape"]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("did you mean 'sphere-drape'?"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn mistakes_in_a_scene_point_at_line_and_column_with_help() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("material", "matrial", ":6:1]", "did you mean 'material'"),
        ("\"cotton\"", "\"coton\"", ":6:12]", "did you mean 'cotton'"),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", young = -1 }",
            ":6:41]",
            "larger than 0",
        ),
        ("dt = 0.02", "dt = 0", ":2:26]", "dt must be larger than 0"),
        ("dt = 0.02", "dt = ", ":2:", "not valid TOML"),
        (
            "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }",
            "mesh.file = \"no.obj\"",
            ":7:13]",
            "no.obj",
        ),
        (
            "axis = \"z\"",
            "select.vertices = [77]",
            ":18:19]",
            "vertex 77 does not exist",
        ),
    ];
    for (from, to, place, words) in cases {
        assert!(SCENE.contains(from), "{from}");
        let scene = write_scene(folder.path(), &SCENE.replacen(from, to, 1));
        for verb in ["check", "run"] {
            let output = koiter(&[verb, &scene]);
            let text = stderr(&output);
            assert_eq!(status(&output), 2, "{text}");
            assert!(
                text.contains(&format!("scene.toml{place}")) && text.contains(words),
                "{text}"
            );
            assert!(stdout(&output).is_empty());
        }
    }
}

#[test]
fn mistakes_in_an_override_point_into_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let output = koiter(&["check", &scene, "--set", "shell.cloth.bending=bca"]);
    let text = stderr(&output);
    assert_eq!(status(&output), 2);
    assert!(
        text.contains("[--set shell.cloth.bending=bca:1:21]"),
        "{text}"
    );
    assert!(text.contains("did you mean 'bac'?"), "{text}");
    let output = koiter(&["run", &scene, "--set", "output.camera=fornt"]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("unknown camera `fornt`"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn broken_scene_files_are_refused_in_one_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, b"title = \"a\"\n\xff\xfe").unwrap();
    let output = koiter(&["check", &path.to_string_lossy()]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("not UTF-8") && stderr(&output).contains("line 2"));
    let output = koiter(&[
        "check",
        &folder
            .path()
            .join("..")
            .join("nothing-here")
            .to_string_lossy(),
    ]);
    assert_eq!(status(&output), 2);
    std::fs::remove_file(&path).unwrap();
    let output = koiter(&["check", &folder.path().to_string_lossy()]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("cannot read the scene"),
        "{}",
        stderr(&output)
    );
}

#[cfg(unix)]
#[test]
fn devices_pipes_and_folders_are_no_scenes_and_no_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let made = std::process::Command::new("mkfifo")
        .arg(at("pipe"))
        .status();
    assert!(made.unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", at("link")).unwrap();
    std::fs::create_dir_all(at("nested/scene.toml")).unwrap();
    for path in ["/dev/zero", &at("pipe"), &at("link"), &at("nested")] {
        assert_refused(path, &[], &["cannot read the scene", "not a regular file"]);
    }
    let grid = "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }";
    for mesh in ["/dev/zero", "pipe", "link", "nested"] {
        let text = SCENE.replace(grid, &format!("mesh.file = \"{mesh}\""));
        let scene = write_scene(folder.path(), &text);
        assert_refused(
            &scene,
            &[],
            &["scene.toml:7:13]", mesh, "not a regular file"],
        );
    }
    // Long, but a hole: nothing is read.
    let file = std::fs::File::create(at("long.toml")).unwrap();
    file.set_len(65 << 20).unwrap();
    assert_refused(&at("long.toml"), &[], &["larger than 64 MiB"]);
}

#[test]
fn implausible_numbers_are_warned_about_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let output = koiter(&[
        "check",
        &scene,
        "--set",
        "shell.cloth.material.young=100",
        "--json",
    ]);
    assert_eq!(status(&output), 0);
    assert!(
        stderr(&output).contains("Young's modulus of 1e2 Pa is unusual"),
        "{}",
        stderr(&output)
    );
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn a_folder_with_other_content_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("thesis.tex"), "years of work").unwrap();
    let output = run_small(folder.path(), &[]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert!(out.join("thesis.tex").exists());
}

#[test]
fn an_intersecting_start_is_refused_by_name_with_a_coloured_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let crossing = "\n[[shell]]\nname = \"flag\"\nmaterial = \"cotton\"\nmesh.grid = { size = [0.3, 0.3], cells = [1, 1] }\n\
        mesh.rotate = { axis = [1, 0, 0], degrees = 90 }\nmesh.translate = [0.03, 0.02, 1]\n";
    let scene = write_scene(folder.path(), &format!("{SCENE}{crossing}"));
    let mesh = folder.path().join("start.ply");
    for verb in ["run", "check"] {
        let output = koiter(&[verb, &scene, "--debug-mesh", &mesh.to_string_lossy()]);
        let text = stderr(&output);
        assert_eq!(status(&output), 2, "{text}");
        assert!(
            text.contains("crosses") && text.contains("cloth") && text.contains("flag"),
            "{text}"
        );
        let ply = std::fs::read_to_string(&mesh).unwrap();
        assert!(
            ply.contains("element face 34")
                && ply.contains(" 220 30 30")
                && ply.contains(" 170 185 205"),
            "{ply}"
        );
        std::fs::remove_file(&mesh).unwrap();
    }
}

/// The small scene with the mesh of a file in its folder.
fn scene_of_mesh(folder: &Path, name: &str, content: &[u8]) -> String {
    std::fs::write(folder.join(name), content).unwrap();
    let grid = "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }";
    assert!(SCENE.contains(grid));
    write_scene(
        folder,
        &SCENE.replace(grid, &format!("mesh.file = \"{name}\"")),
    )
}

/// Asserts that `check` and `run` refuse with one message that has these words.
fn assert_refused(scene: &str, more: &[&str], words: &[&str]) {
    for verb in ["check", "run"] {
        let output = koiter(&[&[verb, scene], more].concat());
        let text = stderr(&output);
        assert_eq!(status(&output), 2, "{text}");
        assert!(stdout(&output).is_empty());
        assert_eq!(text.matches('×').count(), 1, "{text}");
        for word in words {
            assert!(text.contains(word), "'{word}' is not in: {text}");
        }
    }
}

#[test]
fn meshes_that_are_no_sheets_are_refused_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    let cases = [
        (
            "v nan 0 0\n",
            "line 7: the x coordinate 'nan' is not a finite number",
        ),
        (
            "v 0 0 inf\n",
            "line 7: the z coordinate 'inf' is not a finite number",
        ),
        ("f 1 2 9\n", "line 7: the face uses vertex 9"),
        (
            "f 3 2 1\n",
            "line 5: faces [1, 3] have the same vertices [1, 2, 3]",
        ),
        (
            "v 2 0 0\nf 5 2 3\n",
            "line 5: faces [1, 3] both traverse edge [2, 3]",
        ),
        (
            "v 0 0 1\nf 3 1 5\n",
            "line 5: edge [1, 3] belongs to 3 faces",
        ),
        (
            "v 2 2 0\nv 2 3 0\nf 3 5 6\n",
            "line 5: vertex 3 joins separate fans",
        ),
        (
            "v 2 0 0\nf 1 5 2\n",
            "line 8: face 3 [1, 5, 2] is degenerate",
        ),
        (
            "f 2 2 3\n",
            "line 7: face 3 uses vertex 2 more than once: [2, 2, 3]",
        ),
        ("f 1 2\n", "line 7: the face has 2 corners"),
    ];
    for (more, words) in cases {
        let scene = scene_of_mesh(
            folder.path(),
            "sheet.obj",
            format!("{square}{more}").as_bytes(),
        );
        assert_refused(&scene, &[], &["scene.toml:7:13]", "sheet.obj", words]);
    }
    let scene = scene_of_mesh(folder.path(), "empty.obj", b"");
    assert_refused(&scene, &[], &["no faces"]);
    let scene = scene_of_mesh(folder.path(), "sheet.doc", b"hello");
    assert_refused(&scene, &[], &["no mesh format known here"]);
}

#[test]
fn a_pin_that_selects_nothing_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pin =
        "[[constraint]]\nshell = \"cloth\"\nselect.box = { min = [5, 5, 5], max = [6, 6, 6] }\n";
    let scene = write_scene(folder.path(), &format!("{SCENE}\n{pin}"));
    assert_refused(
        &scene,
        &[],
        &["constraint.0.select", "the selection has no vertices"],
    );
}

#[test]
fn a_mesh_in_millimetres_is_warned_about_with_its_unit() {
    let folder = tempfile::tempdir().unwrap();
    let sheet = b"v 0 0 0\nv 300 0 0\nv 300 200 0\nv 0 200 0\nf 1 2 3 4\n";
    let scene = scene_of_mesh(folder.path(), "sheet.obj", sheet);
    let output = koiter(&["check", &scene, "--set", "contact.d_hat=1e-3"]);
    let text = stderr(&output);
    assert_eq!(status(&output), 0, "{text}");
    assert!(
        text.contains("is 3.000e2 m large")
            && text.contains("millimetres (0.300 m), write units = \"mm\""),
        "{text}"
    );
}

#[test]
fn a_scene_that_will_not_fit_into_memory_is_refused_with_the_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let cells = "shell.cloth.mesh.grid.cells=[2000, 2500]";
    let words = [
        "1.0e7 triangles",
        "about 180.0 GB",
        "the limit is 8.0 GB",
        "allow more with --memory",
        "coarser",
    ];
    assert_refused(&scene, &["--set", cells, "--memory", "8GB"], &words);
    // Without a size it is the machine's; no machine has what a billion triangles need.
    let cells = "shell.cloth.mesh.grid.cells=[20000, 25000]";
    assert_refused(&scene, &["--set", cells], &["1.0e9 triangles", "--memory"]);
    let output = koiter(&["check", &scene, "--memory", "lots"]);
    assert_eq!(status(&output), 2);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    // Not by permissions: whoever runs the tests as root could write all the same.
    let out = folder.path().join("scene.toml").join("result");
    let out = out.to_string_lossy();
    let output = koiter(&["run", &scene, "--out", &out, "--no-film"]);
    let text = stderr(&output);
    assert!([1, 2].contains(&status(&output)), "{text}");
    assert!(
        text.contains(&*out) && text.matches('×').count() == 1,
        "{text}"
    );
}

#[test]
fn a_static_shell_that_nothing_holds_is_told_why_it_fails() {
    let folder = tempfile::tempdir().unwrap();
    let text = SCENE.replacen("time =", "integrator = \"quasi-static\"\ntime =", 1);
    let alone = text.replace("[[obstacle]]\nname = \"floor\"\nplane = {}\n", "");
    let scene = write_scene(folder.path(), &alone);
    let output = koiter(&["check", &scene]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert!(stderr(&output).contains("nothing holds shell 'cloth' along x, y, z"));
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let few = ["--set", "solver.max_iterations=3"];
    let output = koiter(
        &[
            &["run", &scene, "--out", &out, "--no-film", "--quiet"],
            &few[..],
        ]
        .concat(),
    );
    let text = stderr(&output);
    assert_eq!(status(&output), 1, "{text}");
    assert!(
        text.contains("nothing but contact holds shell 'cloth'"),
        "{text}"
    );
}

#[test]
fn a_folder_without_a_scene_does_not_hide_a_shipped_one() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sphere-drape")).unwrap();
    let check = |name: &str| {
        std::process::Command::new(env!("CARGO_BIN_EXE_koiter"))
            .args(["check", name, "--set", "resolution=tiny"])
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    assert_eq!(status(&check("sphere-drape")), 0);
    assert_eq!(status(&check("./sphere-drape")), 2);
}

#[test]
fn negative_numbers_are_answered_by_their_option() {
    let output = koiter(&["run", "sphere-drape", "--until", "-1"]);
    assert_eq!(status(&output), 2);
    assert!(
        stderr(&output).contains("--until must be a time larger than 0 s"),
        "{}",
        stderr(&output)
    );
    let output = koiter(&["render", "x", "-o", "a.png", "--frame", "-1"]);
    assert!(status(&output) == 2 && !stderr(&output).contains("-- -1"));
}

#[test]
fn numbers_can_be_read_whatever_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SCENE);
    let words = ["about 32 triangles", "the limit is 1 MB"];
    assert_refused(&scene, &["--memory", "1MB"], &words);
    let sheet = b"v 0 0 0\nv 1e100 0 0\nv 1e100 1e100 0\nv 0 1e100 0\nf 1 2 3 4\n";
    let scene = scene_of_mesh(folder.path(), "sheet.obj", sheet);
    let output = koiter(&["check", &scene]);
    let text = stderr(&output) + &stdout(&output);
    assert!(!text.contains("0000000000"), "{text}");
}

#[test]
fn a_place_where_no_file_can_be_has_status_2() {
    let folder = tempfile::tempdir().unwrap();
    run_small(folder.path(), &[]);
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    std::fs::create_dir(folder.path().join("ex")).unwrap();
    let cases: [(&[&str], &str); 4] = [
        (
            &["export", &at("out"), "--to", "obj", "-o", &at("ex")],
            "is a folder",
        ),
        (
            &["export", &at("out"), "--to", "obj", "-o", &at("no/x.obj")],
            "there is no folder",
        ),
        (
            &["render", &at("out"), "-o", &at("no/x.png")],
            "there is no folder",
        ),
        (
            &["plot", &at("out"), "-o", &at("no/x.svg")],
            "there is no folder",
        ),
    ];
    for (arguments, words) in cases {
        let output = koiter(arguments);
        let text = stderr(&output);
        assert!(
            status(&output) == 2 && text.contains(words),
            "{arguments:?}: {text}"
        );
    }
    assert!(!folder.path().join("ex.obj").exists());
    std::fs::write(folder.path().join("out/stats.jsonl"), "no figures\n").unwrap();
    let text = stderr(&koiter(&["plot", &at("out")]));
    assert!(
        text.contains("--restart") && !text.contains("delete"),
        "{text}"
    );
}
