//! The direction of imports, as `ARCHITECTURE.md` has it: a module imports only modules before it.

use std::path::{Path, PathBuf};

const ORDER: [&str; 16] = [
    "mesh",
    "geometry",
    "material",
    "rest",
    "assembly",
    "audit",
    "energy",
    "contact",
    "solve",
    "integrate",
    "bezier",
    "process",
    "burning",
    "scene",
    "io",
    "testing",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// The modules a source names as `crate::module` outside its tests.
fn imports(text: &str) -> Vec<&str> {
    let code = text.split("#[cfg(test)]").next().unwrap();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| {
            line.match_indices("crate::")
                .map(move |(at, _)| &line[at + 7..])
        })
        .map(|rest| {
            rest.split(|c: char| !c.is_alphanumeric() && c != '_')
                .next()
                .unwrap()
        })
        .filter(|name| ORDER.contains(name))
        .collect()
}

#[test]
fn modules_import_only_what_stands_before_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let rank = |module: &str| ORDER.iter().position(|m| *m == module).unwrap();
    let mut checked = 0;
    for (index, module) in ORDER.iter().enumerate() {
        for path in sources(&root.join(module)) {
            let text = std::fs::read_to_string(&path).unwrap();
            for import in imports(&text) {
                let allowed = rank(import) <= index;
                assert!(
                    allowed,
                    "{} imports {import}, which stands after {module}",
                    path.display()
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 100, "the check sees the imports");
}

#[test]
fn the_library_neither_prints_nor_exits_nor_reads_the_environment() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for path in sources(&root) {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for word in [
            "println!",
            "eprintln!",
            "print!(",
            "process::exit",
            "env::var",
            "dbg!",
        ] {
            assert!(!code.contains(word), "{} contains {word}", path.display());
        }
    }
}

#[test]
fn every_module_is_in_the_order() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_string();
        assert!(
            name == "lib" || ORDER.contains(&name.as_str()),
            "module {name} has no place in the order"
        );
    }
}
