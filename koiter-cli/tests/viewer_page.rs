//! The viewer's page by its own checks: types, unit tests, and a real browser.
//!
//! They need Node.js, `npm ci` in `viewer/`, and for the browser Chromium and a program that holds the page. Without them they
//! say so and pass; with `KOITER_REQUIRE_VIEWER` set they fail.

use std::path::{Path, PathBuf};
use std::process::Command;

fn viewer() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../viewer")
}

/// Whether this can be checked; if not, says why.
fn can_check(missing: &[(&str, bool)]) -> bool {
    let Some((what, _)) = missing.iter().find(|(_, is_missing)| *is_missing) else {
        return true;
    };
    assert!(
        std::env::var_os("KOITER_REQUIRE_VIEWER").is_none(),
        "KOITER_REQUIRE_VIEWER is set, but {what}"
    );
    eprintln!("skipped: {what}");
    false
}

fn packages_are_missing() -> (&'static str, bool) {
    let installed = viewer().join("node_modules/playwright-core").is_dir();
    (
        "the packages of viewer/ are not installed: npm ci there",
        !installed,
    )
}

fn browser_is_missing() -> (&'static str, bool) {
    let named = std::env::var_os("KOITER_BROWSER").map(PathBuf::from);
    let usual = ["chromium", "chromium-browser", "google-chrome"];
    let usual = usual.map(|name| Path::new("/usr/bin").join(name));
    let found = named.into_iter().chain(usual).any(|path| path.is_file());
    (
        "there is no Chromium, nor is it named in KOITER_BROWSER",
        !found,
    )
}

/// Runs a script of `viewer/package.json`.
fn npm(script: &str) {
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let output = Command::new(npm)
        .args(["run", "--silent", script])
        .current_dir(viewer())
        .env("KOITER_PROGRAM", env!("CARGO_BIN_EXE_koiter"))
        .output()
        .expect("npm runs where packages are installed");
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    assert!(output.status.success(), "npm run {script}:\n{text}");
}

#[test]
fn types_and_units_of_the_page_are_right() {
    if can_check(&[packages_are_missing()]) {
        npm("check");
        npm("test");
    }
}

#[test]
fn the_page_works_in_a_browser() {
    let reason = env!("KOITER_VIEWER_MISSING");
    let bundle_is_missing = ("the program was built without the page", !reason.is_empty());
    if can_check(&[
        packages_are_missing(),
        browser_is_missing(),
        bundle_is_missing,
    ]) {
        npm("test:browser");
    }
}
