//! Scripts that read a file with the reader of its format and print what they find.

use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

/// What the script of this folder finds in the file; `None` where Python lacks its packages and none are required.
pub(crate) fn read_with(script: &str, file: &Path) -> Option<Value> {
    let python = std::env::var("KOITER_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let has_readers = Command::new(&python)
        .args(["-c", "import vtkmodules, pxr, h5py, numpy"])
        .output();
    if !has_readers.is_ok_and(|output| output.status.success()) {
        let required = std::env::var("KOITER_REQUIRE_READERS").is_ok_and(|value| value == "1");
        assert!(
            !required,
            "KOITER_REQUIRE_READERS=1, but {python} cannot import vtkmodules, pxr, h5py and numpy"
        );
        eprintln!(
            "skipped: {python} lacks readers (pip install vtk usd-core h5py numpy, or set KOITER_PYTHON)"
        );
        return None;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/format_readers");
    let output = Command::new(&python)
        .arg(folder.join(script))
        .arg(file)
        .output()
        .expect("python was just run");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && errors.is_empty(),
        "{script} on {}: {errors}",
        file.display()
    );
    Some(serde_json::from_slice(&output.stdout).expect("the script prints JSON"))
}

/// Numbers as the scripts print them.
pub(crate) fn bits(values: impl IntoIterator<Item = f64>) -> Value {
    values
        .into_iter()
        .map(|value| json!(value.to_bits()))
        .collect()
}
