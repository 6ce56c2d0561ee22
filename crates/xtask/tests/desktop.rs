//! Checks that `assets/desktop` has the manual pages and completions that the code generates.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const REMEDY: &str = "run `cargo xtask desktop`";

/// Returns every generated file, by its path relative to `folder`.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = ["man", "completions"].map(|made| folder.join(made)).to_vec();
    while let Some(inner) = folders.pop() {
        for entry in std::fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Returns the text to compare.
fn content(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap().replace("\r\n", "\n")
}

#[test]
fn desktop_files_are_up_to_date() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("desktop");
    let _ = std::fs::remove_dir_all(&folder);
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("desktop").arg(&folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let stored = files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/desktop"));
    let made = files(&folder);
    assert!(
        made.keys().eq(stored.keys()),
        "generated files\n{:?}\ndiffer from stored files\n{:?}: {REMEDY}",
        made.keys(),
        stored.keys()
    );
    for (path, bytes) in made {
        assert!(content(&bytes) == content(&stored[&path]), "{} is out of date: {REMEDY}", path.display());
    }
}
