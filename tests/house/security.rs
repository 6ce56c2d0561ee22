//! Checks that SECURITY.md lists every use of `unsafe`.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::path::{Path, PathBuf};

const HEAD: &str = "| file | places | why |\n|---|---|---|\n";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// The sources of the shipped crates. `testing` and `xtask` are for developers only.
fn of_crates(found: &mut Vec<PathBuf>) {
    for folder in fs::read_dir(root().join("crates")).unwrap() {
        let folder = folder.unwrap().path();
        if !folder.ends_with("testing") && !folder.ends_with("xtask") {
            sources(&folder.join("src"), found);
        }
    }
}

/// The rows of the table. A row contains a file with `unsafe`, the number of uses, and the reason.
fn rows() -> String {
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    of_crates(&mut files);
    files.sort();
    let mut rows = String::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let name = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
        let (places, unexplained) = places(&text);
        assert!(
            unexplained.is_empty(),
            "{name}: add a comment `// SAFETY: ...` to the lines {unexplained:?}"
        );
        let reason = text
            .split_once("#![expect(unsafe_code, reason = \"")
            .and_then(|(_, rest)| rest.split_once("\")]"));
        assert_eq!(
            reason.is_some(),
            places > 0,
            "{name} must give a reason for unsafe code if and only if it contains some"
        );
        if let Some((reason, _)) = reason {
            rows += &format!("| `{name}` | {places} | {reason} |\n");
        }
    }
    rows
}

/// Counts the word `unsafe` outside of comments and lints. Also returns the numbers of the lines that contain the word
/// but have no SAFETY comment above them or at their end.
fn places(text: &str) -> (usize, Vec<usize>) {
    let lines: Vec<&str> = text.lines().collect();
    let (mut count, mut unexplained) = (0, Vec::new());
    for (number, line) in lines.iter().enumerate() {
        let code = line.split("//").next().unwrap_or("");
        let here =
            code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| *word == "unsafe").count();
        if here == 0 || code.trim_start().starts_with("#![") {
            continue;
        }
        count += here;
        let explained = line.contains("SAFETY:")
            || lines[..number]
                .iter()
                .rev()
                .take_while(|above| {
                    above.trim_start().starts_with("//") || above.trim_start().starts_with("#[")
                })
                .any(|above| above.contains("SAFETY:"));
        if !explained {
            unexplained.push(number + 1);
        }
    }
    (count, unexplained)
}

#[test]
fn security_md_lists_every_use_of_unsafe_with_its_reason() {
    let path = root().join("SECURITY.md");
    let text = fs::read_to_string(&path).unwrap();
    let (before, after) = text.split_once(HEAD).expect("SECURITY.md contains the table of unsafe code");
    let end = after.find("\n\n").map_or(after.len(), |end| end + 1);
    let end = if after.starts_with('\n') { 0 } else { end };
    let rows = rows();
    if std::env::var_os("MARIANA_BLESS").is_some() {
        fs::write(&path, format!("{before}{HEAD}{rows}{}", &after[end..])).unwrap();
        return;
    }
    assert_eq!(
        &after[..end],
        rows,
        "run MARIANA_BLESS=1 cargo test --workspace --test house to update the table"
    );
}

#[test]
fn every_form_of_unsafe_is_found() {
    let text = "#![expect(unsafe_code, reason = \"x\")]\n// unsafe in words\n// SAFETY: so.\nunsafe { f() }\n\
                let a = g(unsafe { h() });\nfn not_unsafe() {}\n/// # Safety\n// SAFETY: because\n// of that.\n#[inline]\n\
                unsafe impl Send for X {}\n";
    assert_eq!(places(text), (3, vec![5]));
}

fn without_tests(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let of_tests = path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests"));
    if of_tests { String::new() } else { text.split("#[cfg(test)]").next().unwrap().to_owned() }
}

#[test]
fn one_builder_starts_ffmpeg_and_adds_its_inputs() {
    let mut files = Vec::new();
    of_crates(&mut files);
    sources(&root().join("src"), &mut files);
    let with = |mark: &str| {
        let files = files.iter().filter(|file| without_tests(file).contains(mark));
        let names = files.map(|file| file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/"));
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let builder = "crates/player/src/ffmpeg.rs";
    assert_eq!(
        with("Command::new("),
        [builder, "crates/scenes/src/thumbnails/drawing.rs", "src/shell/idle.rs", "src/videos/process.rs"],
        "only these files may start programs"
    );
    assert_eq!(with("\"-i\""), [builder], "only the builder may add inputs");
}
