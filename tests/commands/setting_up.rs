//! Checks what the scripts that set up and build say on computers that lack something.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Runs a script that must fail, and returns the last line of its messages.
fn last_words(root: &Path, script: &str, variables: &[(&str, &str)]) -> String {
    let mut command = Command::new("/usr/bin/env");
    command.arg("bash").arg(root.join(script)).envs(variables.iter().copied());
    let output = command.output().unwrap();
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{script} {variables:?}: {reported}");
    reported.lines().last().unwrap_or_default().to_owned()
}

/// Copies the scripts to a folder whose path has spaces and an umlaut.
fn scripts_in_an_odd_place(place: &Path) -> std::path::PathBuf {
    let root = place.join("ein Ordner für Mariana");
    std::fs::create_dir(&root).unwrap();
    let copied =
        Command::new("cp").arg("-r").arg(Path::new(ROOT).join("scripts")).arg(&root).status().unwrap();
    assert!(copied.success());
    std::fs::copy(Path::new(ROOT).join("Cargo.toml"), root.join("Cargo.toml")).unwrap();
    root
}

#[test]
fn a_computer_without_a_known_package_manager_is_told_what_is_missing() {
    let place = tempfile::tempdir().unwrap();
    let root = scripts_in_an_odd_place(place.path());
    let programs = place.path().join("programs");
    std::fs::create_dir(&programs).unwrap();
    for program in ["bash", "dirname", "uname", "cat", "sed", "awk", "grep"] {
        let found = ["/usr/bin", "/bin"].map(|folder| Path::new(folder).join(program));
        symlink(found.iter().find(|path| path.exists()).unwrap(), programs.join(program)).unwrap();
    }
    let words =
        last_words(&root, "scripts/run", &[("PATH", programs.to_str().unwrap()), ("MARIANA_SETUP", "")]);
    assert!(words.starts_with("Mariana needs ") && words.contains("cmake"), "{words}");
    assert!(words.contains("found no package manager that it supports"), "{words}");
}

#[test]
fn an_old_rust_is_named_with_the_one_that_is_needed() {
    let place = tempfile::tempdir().unwrap();
    let root = scripts_in_an_odd_place(place.path());
    for program in ["cargo", "rustup"] {
        let file = place.path().join(program);
        std::fs::write(&file, "#!/bin/sh\necho cargo 1.63.0\n").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = format!("{}:{}", place.path().display(), std::env::var("PATH").unwrap());
    let words = last_words(&root, "scripts/run", &[("PATH", &path), ("MARIANA_SETUP", "dry-run")]);
    assert!(words.starts_with("Mariana needs Rust 1.95 or newer, but rustup has 1.63.0."), "{words}");
}

#[test]
fn a_build_that_cannot_begin_ends_with_one_sentence() {
    let place = tempfile::tempdir().unwrap();
    let root = Path::new(ROOT);
    let file = place.path().join("file");
    std::fs::write(&file, "").unwrap();
    let file = file.to_str().unwrap();
    let words = last_words(root, "scripts/run", &[("MARIANA_SETUP", "skip"), ("CARGO_TARGET_DIR", file)]);
    assert_eq!(
        words,
        format!(
            "The folder {file} cannot be written. Set CARGO_TARGET_DIR to a folder for the build, then run this again."
        )
    );
    let folder = place.path().to_str().unwrap();
    let offline = [
        ("MARIANA_SETUP", "skip"),
        ("CARGO_TARGET_DIR", folder),
        ("CARGO_HOME", folder),
        ("CARGO_NET_OFFLINE", "true"),
    ];
    let words = last_words(root, "scripts/run", &offline);
    assert!(words.starts_with("Cargo could not get Mariana's libraries"), "{words}");
    let words = last_words(root, "scripts/test", &[("MARIANA_SETUP", "maybe")]);
    assert_eq!(words, "MARIANA_SETUP is 'maybe'. Use dry-run or skip, or unset it.");
}
