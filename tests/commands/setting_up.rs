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

/// Links `others` and the tools that every script needs into `folder`.
fn link_tools(folder: &Path, others: &[&str]) {
    for tool in ["bash", "dirname", "uname", "cat", "sed", "awk", "grep"].iter().chain(others) {
        let found = ["/usr/bin", "/bin"].map(|place| Path::new(place).join(tool));
        symlink(found.iter().find(|path| path.exists()).unwrap(), folder.join(tool)).unwrap();
    }
}

#[test]
fn a_computer_without_a_known_package_manager_is_told_what_is_missing() {
    let place = tempfile::tempdir().unwrap();
    let root = scripts_in_an_odd_place(place.path());
    let programs = place.path().join("programs");
    std::fs::create_dir(&programs).unwrap();
    link_tools(&programs, &[]);
    let words =
        last_words(&root, "scripts/run", &[("PATH", programs.to_str().unwrap()), ("MARIANA_SETUP", "")]);
    assert!(words.starts_with("Mariana needs ") && words.contains("cmake"), "{words}");
    assert!(words.contains("found no package manager that it supports"), "{words}");
}

/// The programs of a computer. `$OFFERED` has rustup and a new Rust; `$APT_HAS` names a package; `$OFFLINE` cuts the
/// network.
const STAND_INS: [(&str, &str); 5] = [
    (
        "apt-cache",
        r#"case $2 in rustc) echo Candidate: 1.85.0 ;; "$APT_HAS") echo Candidate: 1.27.1 ;; esac"#,
    ),
    ("apt-get", r#"case "$*" in *" rustup "*) cp "$OFFERED/rustup" "${0%/*}" ;; esac"#),
    ("dpkg-query", "echo installed"),
    ("sudo", r#"exec "$@""#),
    (
        "curl",
        r#"[ -z "$OFFLINE" ] && echo 'mkdir -p "$HOME/.cargo/bin" && cp "$OFFERED/rustup" "$HOME/.cargo/bin"'"#,
    ),
];
const OLD_CARGO: &str = "echo cargo 1.63.0";
const NEW_CARGO: &str = "echo cargo 1.999.0";
/// Accepts no command that changes the default toolchain.
const RUSTUP: &str = r#"stable=$HOME/stable
case "$1 $2 $3" in
"toolchain install stable") [ -z "$OFFLINE" ] && mkdir -p "$stable/bin" && cp "$OFFERED/cargo" "$stable/bin" ;;
"run stable cargo") "$stable/bin/cargo" ;;
"run stable rustc") echo "$stable" ;;
*) exit 1 ;;
esac"#;

const CHECK_THE_NETWORK: &str =
    " Check the network, or set HTTPS_PROXY if yours has a proxy, then run this again.";

struct Computer(tempfile::TempDir);

impl Computer {
    fn with(programs: &[(&str, &str)]) -> Self {
        let place = tempfile::tempdir().unwrap();
        scripts_in_an_odd_place(place.path());
        for folder in ["programs", "offered", "home"] {
            std::fs::create_dir(place.path().join(folder)).unwrap();
        }
        link_tools(&place.path().join("programs"), &["cp", "env", "mkdir", "sh"]);
        let write = |folder: &str, (name, text): &(&str, &str)| {
            let file = place.path().join(folder).join(name);
            std::fs::write(&file, format!("#!/bin/sh\n{text}\n")).unwrap();
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
        };
        for program in STAND_INS.iter().chain(programs) {
            write("programs", program);
        }
        write("offered", &("rustup", RUSTUP));
        write("offered", &("cargo", NEW_CARGO));
        Self(place)
    }

    /// Sets up a build without a terminal. Returns all messages and, if it worked, the version of cargo.
    fn set_up(&self, variables: &[(&str, &str)]) -> String {
        let place = self.0.path();
        let mut command = Command::new("/usr/bin/setsid");
        command.args(["--wait", "/usr/bin/env", "bash", "-c"]);
        command.arg("set -euo pipefail; source \"$0\"; mariana_setup build; cargo --version >&2");
        command.arg(place.join("ein Ordner für Mariana/scripts/lib/setup.sh"));
        command.env_clear().envs(variables.iter().copied());
        for (name, folder) in [("PATH", "programs"), ("HOME", "home"), ("OFFERED", "offered")] {
            command.env(name, place.join(folder));
        }
        String::from_utf8(command.output().unwrap().stderr).unwrap().trim_end().to_owned()
    }
}

#[test]
fn a_missing_rust_is_installed_with_the_rustup_of_the_package_manager() {
    let computer = Computer::with(&[]);
    let words = computer.set_up(&[("APT_HAS", "rustup")]);
    assert!(words.contains(": rustup ca-certificates\nInstalling with rustup: Rust stable\n"), "{words}");
    assert!(words.ends_with("cargo 1.999.0"), "{words}");
    assert_eq!(computer.set_up(&[]), "cargo 1.999.0");
}

#[test]
fn rustup_with_an_old_rust_gets_the_stable_one() {
    let computer = Computer::with(&[("cargo", OLD_CARGO), ("rustup", RUSTUP)]);
    let words = computer.set_up(&[("MARIANA_SETUP", "dry-run")]);
    assert_eq!(words, "Would install with rustup: Rust stable\nDry run: nothing was installed.");
    let words = computer.set_up(&[("OFFLINE", "yes")]);
    assert!(words.contains("\nrustup could not install Rust stable; the reason is above."), "{words}");
    assert!(words.ends_with(CHECK_THE_NETWORK), "{words}");
    assert_eq!(computer.set_up(&[]), "Installing with rustup: Rust stable\ncargo 1.999.0");
    assert_eq!(computer.set_up(&[("OFFLINE", "yes")]), "cargo 1.999.0");
}

#[test]
fn the_installer_of_rustup_runs_only_after_a_yes() {
    // The package of rustup conflicts with the old Rust.
    let computer = Computer::with(&[("cargo", OLD_CARGO)]);
    let apt = ("APT_HAS", "rustup");
    assert_eq!(
        computer.set_up(&[apt, ("MARIANA_SETUP", "dry-run")]),
        "Would install with https://sh.rustup.rs: rustup\nWould install with rustup: Rust stable\n\
         Dry run: nothing was installed."
    );
    assert_eq!(
        computer.set_up(&[apt]),
        "Mariana needs Rust 1.95 or newer, but this computer has 1.63.0. Run scripts/run or scripts/test with \
         --yes to install it with https://sh.rustup.rs, or install it yourself from https://rustup.rs."
    );
    let words = computer.set_up(&[("MARIANA_SETUP", "yes"), ("OFFLINE", "yes")]);
    assert!(words.contains("\nCannot download https://sh.rustup.rs."), "{words}");
    assert!(words.ends_with(CHECK_THE_NETWORK), "{words}");
    assert_eq!(std::fs::read_dir(computer.0.path().join("home")).unwrap().count(), 0);
    assert_eq!(
        computer.set_up(&[apt, ("MARIANA_SETUP", "yes")]),
        "Installing with https://sh.rustup.rs: rustup\nInstalling with rustup: Rust stable\ncargo 1.999.0"
    );
    assert_eq!(computer.set_up(&[apt]), "cargo 1.999.0");
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
    assert_eq!(words, "MARIANA_SETUP is 'maybe'. Use dry-run, skip or yes, or unset it.");
}
