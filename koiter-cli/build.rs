//! Bundles the viewer's page, `viewer/`, into the program.
//!
//! Needs Node.js and npm; without them, or without the npm registry, the program is built without the page, and `koiter view`
//! says so. The environment variable `KOITER_VIEWER` decides: `off` leaves the page out (quick builds), `require` makes it an
//! error if it cannot be bundled. It runs again only when a file of the page changes; packages are installed again only when
//! `package-lock.json` does.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

const VIEWER: &str = "../viewer";
/// What the bundle is made of. Tests, types and `node_modules` of developers are not.
const SOURCES: [&str; 5] = [
    "package.json",
    "package-lock.json",
    ".npmrc",
    "bundle.mjs",
    "src",
];
const OUTPUTS: [&str; 3] = ["index.html", "viewer.js", "viewer.css"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=KOITER_VIEWER");
    for source in SOURCES {
        println!("cargo:rerun-if-changed={VIEWER}/{source}");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    let page = out.join("viewer-page");
    fs::create_dir_all(&page).expect("OUT_DIR can be written to");
    let wish = env::var("KOITER_VIEWER").unwrap_or_default();
    let bundled = match wish.as_str() {
        "off" => Err("KOITER_VIEWER=off was set".to_owned()),
        _ => bundle(&out.join("viewer"), &page),
    };
    let Err(reason) = bundled else {
        println!("cargo:rustc-env=KOITER_VIEWER_MISSING=");
        return;
    };
    assert!(
        wish != "require",
        "the viewer could not be bundled: {reason}"
    );
    for name in OUTPUTS {
        fs::write(page.join(name), "").expect("OUT_DIR can be written to");
    }
    if wish != "off" {
        println!("cargo:warning=koiter view will not work: {reason}");
    }
    println!("cargo:rustc-env=KOITER_VIEWER_MISSING={reason}");
}

/// Copies the sources, installs what they need there, and bundles.
fn bundle(work: &Path, page: &Path) -> Result<(), String> {
    let viewer = Path::new(VIEWER);
    if !viewer.join("package.json").is_file() {
        return Err("its sources are not there".to_owned());
    }
    fs::create_dir_all(work).map_err(|error| error.to_string())?;
    let _ = fs::remove_dir_all(work.join("src"));
    for source in SOURCES {
        copy(&viewer.join(source), &work.join(source)).map_err(|e| format!("{source}: {e}"))?;
    }
    install(work)?;
    let page = page.to_str().ok_or("OUT_DIR is no text")?;
    run(work, "node", &["bundle.mjs", page])
}

/// `npm ci`, unless these very packages are there.
fn install(work: &Path) -> Result<(), String> {
    let read = |name: &str| fs::read(work.join(name)).unwrap_or_default();
    let lock = read("package-lock.json");
    if lock == read("installed-lock.json") {
        return Ok(());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    // Without the registry this must fail soon, not after minutes of trying again.
    let arguments = [
        "ci",
        "--omit=dev",
        "--ignore-scripts",
        "--prefer-offline",
        "--fetch-retries=0",
        "--fetch-timeout=20000",
        "--loglevel=error",
    ];
    run(work, npm, &arguments)?;
    fs::write(work.join("installed-lock.json"), lock).map_err(|error| error.to_string())
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> Result<(), String> {
    let mut command = Command::new(program);
    let output = command.args(arguments).current_dir(folder).output();
    let output = output.map_err(|error| format!("{program} cannot be run ({error})"))?;
    if output.status.success() {
        return Ok(());
    }
    // One line: it becomes a message and an environment variable.
    let text = String::from_utf8_lossy(&output.stderr);
    let line = text
        .lines()
        .find(|line| !line.trim().is_empty())
        .unwrap_or_default();
    let arguments = arguments.first().unwrap_or(&"");
    Err(format!("{program} {arguments} failed: {}", line.trim()))
}

fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if !from.is_dir() {
        return fs::copy(from, to).map(drop);
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        copy(&from.join(&name), &to.join(&name))?;
    }
    Ok(())
}
