//! Dependency rules that Cargo cannot express. ARCHITECTURE.md explains these rules. `walls` lists the packages that
//! each crate may depend on, the modules that each module of the program may use, and the modules that may access the
//! outside world. Clippy checks `unwrap` and `unsafe` (see `[workspace.lints]`).

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::walls::{CRATES, EVERYTHING, IMPURE, OUTSIDE, PURE, ROOMS, UNSAFE};

const LINES_MAX: usize = 600;

const TOP_LEVEL: &[&str] = &[
    ".cargo",
    ".ci",
    ".editorconfig",
    ".gitattributes",
    ".github",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "SECURITY.md",
    "assets",
    "benches",
    "clippy.toml",
    "crates",
    "deny.toml",
    "docs",
    "editors",
    "examples",
    "fuzz",
    "packaging",
    "rustfmt.toml",
    "scripts",
    "shaders",
    "src",
    "tests",
    "tools",
];

pub(super) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns all files under `folder` as sorted paths from the repository's root, with `/` as the separator.
pub(super) fn files_under(folder: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).unwrap() {
            let entry = entry.unwrap();
            let path = folder.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                folders.push(path);
            } else {
                found.push(path.to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

pub(super) fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

pub(super) fn sources(folder: &str) -> Vec<(String, String)> {
    let files: Vec<String> = files_under(folder).into_iter().filter(|file| file.ends_with(".rs")).collect();
    assert!(!files.is_empty(), "no sources under {folder}: the search is broken");
    files.into_iter().map(|file| (file.clone(), read(&file))).collect()
}

fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(number, line)| (number + 1, line.split("//").next().unwrap_or_default()))
}

/// Returns the lines of code without the unit tests at the end of the file.
fn shipped_code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let tests = text.find("\n#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    code(&text[..tests])
}

/// Returns the program's module (a folder or file under `src/`) that contains `file`.
fn room_of(file: &str) -> &str {
    let inner = file.strip_prefix("src/").unwrap();
    inner.split('/').next().unwrap().trim_end_matches(".rs")
}

fn row(room: &str) -> Option<&'static [&'static str]> {
    ROOMS.iter().find(|(name, _)| *name == room).map(|(_, allowed)| *allowed)
}

fn names_behind<'a>(line: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let starts = line.match_indices(prefix).map(|(at, _)| at);
    let whole = starts.filter(move |&at| {
        !line[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_' || before == ':')
    });
    whole.map(move |at| {
        let rest = &line[at + prefix.len()..];
        &rest[..rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())]
    })
}

/// Returns the rules that `line` in `file` breaks. `deeper` is the number of inline modules around the line.
fn broken_walls(file: &str, deeper: usize, line: &str) -> Vec<String> {
    let room = room_of(file);
    let mut wrong = Vec::new();
    for prefix in ["crate::", "mariana::"] {
        for name in names_behind(line, prefix) {
            match row(room).unwrap_or_default() {
                allowed if allowed == EVERYTHING || name == room || allowed.contains(&name) => {}
                _ if row(name).is_some() => wrong.push(format!("{room} must not use {name}")),
                _ => wrong.push("name the module after `crate::`, one in each path".to_owned()),
            }
        }
    }
    if line.contains("crate as ") {
        wrong.push("name the module after `crate::`, one in each path".to_owned());
    }
    let inner = file.strip_prefix("src/").unwrap();
    let is_top = inner.ends_with("/mod.rs") || inner.ends_with("/lib.rs");
    let depth = inner.matches('/').count() + 1 - usize::from(is_top) + deeper;
    if line.contains(&"super::".repeat(depth)) && row(room) != Some(EVERYTHING) {
        wrong.push("`super` leaves the module: write `crate::`".to_owned());
    }
    for (package, rooms) in OUTSIDE {
        let uses = line.match_indices(package).any(|(at, _)| {
            let (before, rest) = (&line[..at], &line[at + package.len()..]);
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            // `glutin_winit` has a row, so the row of `glutin` does not apply to it.
            let own_row = OUTSIDE.iter().any(|(other, _)| *other == format!("{package}{}", &rest[..end]));
            let is_path =
                rest[end..].starts_with("::") || rest[end..].starts_with(" as ") || rest[end..] == *";";
            (end == 0 || rest.starts_with('_') && !own_row)
                && is_path
                && !before.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':' || c == '"')
        });
        if uses && !rooms.contains(&room) {
            wrong.push(format!("{package} belongs to {} alone", rooms.join(" and ")));
        }
    }
    wrong
}

#[track_caller]
pub(super) fn assert_none(found: &[String], advice: &str) {
    assert!(found.is_empty(), "{advice}:\n  {}", found.join("\n  "));
}

#[test]
fn crates_have_the_allowed_dependencies() {
    // The developers' tool depends on the program, so it has no row.
    let folders = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().file_name());
    let folders: BTreeSet<String> =
        folders.filter_map(|name| name.into_string().ok()).filter(|name| name != "xtask").collect();
    let rows: BTreeSet<String> = CRATES.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(folders, rows, "the crates do not match the rows in the table CRATES");
    for (name, allowed) in CRATES {
        let manifest: toml::Table = read(&format!("crates/{name}/Cargo.toml")).parse().unwrap();
        let of_systems = manifest.get("target").and_then(toml::Value::as_table).into_iter().flatten();
        let of_systems = of_systems.filter_map(|(_, system)| system.get("dependencies"));
        let tables = manifest.get("dependencies").into_iter().chain(of_systems);
        let names: BTreeSet<&str> =
            tables.flat_map(|t| t.as_table().unwrap().keys()).map(String::as_str).collect();
        let known: BTreeSet<&str> = allowed.iter().copied().collect();
        assert_eq!(
            names, known,
            "the dependencies of crates/{name} do not match its row in the table CRATES"
        );
    }
}

#[test]
fn modules_use_only_allowed_modules() {
    let mut found = Vec::new();
    for (file, text) in sources("src") {
        assert!(row(room_of(&file)).is_some(), "{file} belongs to a module without a row in the table ROOMS");
        let own_tests = shipped_code(&text).count();
        for (number, line) in code(&text) {
            let deeper = usize::from(number > own_tests + 2);
            found.extend(
                broken_walls(&file, deeper, line)
                    .into_iter()
                    .map(|wrong| format!("{file}:{number}: {wrong}")),
            );
        }
    }
    assert_none(&found, "these lines use modules or packages that their module must not use");
}

#[test]
fn pure_modules_have_no_side_effects() {
    let mut found = Vec::new();
    for (file, text) in PURE.iter().flat_map(|folder| sources(folder)) {
        for (number, line) in shipped_code(&text).filter(|_| !file.contains("test")) {
            let touched = IMPURE.iter().find(|impure| line.contains(**impure));
            found.extend(touched.map(|impure| format!("{file}:{number}: {impure}")));
        }
    }
    assert_none(&found, "these modules do no I/O, read no clock and start no threads");
}

/// These files may read the system's clock. The session's builder of regions measures durations in real time even if
/// time is simulated.
const MEASURES: &[&str] = &["crates/ui/src/clock.rs", "src/session/scene/region_builder.rs"];

#[test]
fn a_session_reads_the_time_from_its_clock() {
    let mut found = Vec::new();
    for (file, text) in ["src/session", "crates/ui/src"].into_iter().flat_map(sources) {
        if MEASURES.contains(&file.as_str()) || file.contains("test") {
            continue;
        }
        let lines = shipped_code(&text).filter(|(_, line)| line.contains("Instant::now("));
        found.extend(lines.map(|(number, _)| format!("{file}:{number}")));
    }
    assert_none(&found, "write `clock::now()`, so that tests can simulate the time");
}

fn is_excuse(line: &str) -> bool {
    let attribute = line.trim_start().trim_start_matches("#!").trim_start_matches('#');
    ["[expect(", "[allow("].iter().any(|start| attribute.starts_with(start))
}

#[test]
fn unsafe_code_is_in_allowed_folders_and_disabled_lints_have_reasons() {
    let mut found = Vec::new();
    for (file, text) in ["src", "crates"].into_iter().flat_map(sources) {
        for (number, line) in shipped_code(&text).filter(|(_, line)| is_excuse(line)) {
            let start = text.split_inclusive('\n').take(number - 1).map(str::len).sum::<usize>();
            let excuse = text[start..].split(']').next().unwrap_or_default();
            if excuse.contains("unsafe_code") && !UNSAFE.iter().any(|folder| file.starts_with(folder)) {
                found.push(format!(
                    "{file}:{number}: unsafe code is allowed only in {}",
                    UNSAFE.join(" and ")
                ));
            }
            let is_test = ["/tests", "/testing", "/examples/", "/benches/", "tests.rs"]
                .iter()
                .any(|t| file.contains(t));
            if !is_test && !excuse.contains("reason = ") {
                found.push(format!("{file}:{number}: {line} gives no reason"));
            }
        }
    }
    assert_none(&found, "these lines disable a lint");
}

#[test]
fn the_scanner_finds_forbidden_paths() {
    for (file, line) in [
        ("src/sending/mod.rs", "use crate::gpu;"),
        ("src/sending/stream.rs", "    let gl = <crate::gpu::Gl as Default>::default();"),
        ("src/sending/stream.rs", "use super::super::gpu::Gl;"),
        ("src/sending/mod.rs", "use super::gpu::Gl;"),
        ("src/sending/mod.rs", "use crate::{limits, gpu};"),
        ("src/sending/mod.rs", "use crate::*;"),
        ("src/sending/mod.rs", "use mariana_render::gpu;"),
        ("src/shell/mod.rs", "use mariana::cli;"),
        ("src/export/mod.rs", "use glutin::display;"),
        ("src/export/mod.rs", "use egui_winit::State;"),
        ("src/export/mod.rs", "use glutin_winit::X;"),
        ("src/sending/mod.rs", "fn f(player: &mariana_player::Player) {}"),
    ] {
        assert_eq!(broken_walls(file, 0, line).len(), 1, "{file}: {line}: {:?}", broken_walls(file, 0, line));
    }
    for (file, line) in [
        ("src/sending/stream.rs", "use super::Frame;"),
        ("src/shell/window.rs", "use glutin::display; use crate::gpu::gl::Gl;"),
        ("src/shell/window.rs", "use glutin_winit::X; let window = self.winit.window();"),
        ("src/session/scene/mod.rs", "use super::lay::Lay;"),
        ("src/main.rs", "use mariana::cli;"),
        ("src/export/mod.rs", "let text = \"winit\"; notify(one); glutin.fs::<u8>()"),
    ] {
        assert_eq!(broken_walls(file, 0, line), [""; 0], "{file}: {line}");
    }
    let text = "a\n#[cfg(test)]\nmod testing;\n// crate::gpu\nb // c\n#[cfg(test)]\nmod tests {\n}";
    assert_eq!(code(text).count(), 8);
    let shipped = [(1, "a"), (2, "#[cfg(test)]"), (3, "mod testing;"), (4, ""), (5, "b ")];
    assert_eq!(shipped_code(text).collect::<Vec<_>>(), shipped);
}

#[test]
fn files_stay_small() {
    let folders = ["src", "crates", "shaders", "tests"];
    let texts = folders.into_iter().flat_map(files_under);
    let texts = texts.filter(|file| [".rs", ".glsl", ".vert", ".frag"].iter().any(|end| file.ends_with(end)));
    let too_long: Vec<String> = texts.filter(|file| read(file).lines().count() > LINES_MAX).collect();
    assert_none(&too_long, "split these files of more than 600 lines");
}

/// Without Git (in an unpacked archive), returns the existing entries that .gitignore does not list.
fn top_level_entries() -> BTreeSet<String> {
    let git = Command::new("git")
        .args(["-c", "safe.directory=*", "ls-files", "-z"])
        .current_dir(root())
        .output()
        .ok()
        .filter(|output| output.status.success() && !output.stdout.is_empty());
    if let Some(output) = git {
        let names = String::from_utf8(output.stdout).unwrap();
        return names.split_terminator('\0').map(|name| name.split('/').next().unwrap().to_owned()).collect();
    }
    let ignored = read(".gitignore");
    let entries =
        fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    entries
        .filter(|name| name != ".git" && !ignored.lines().any(|line| line.trim_matches('/') == name))
        .collect()
}

#[test]
fn the_repository_has_only_known_top_level_entries() {
    let entries = top_level_entries();
    assert!(entries.contains("src") && entries.contains("Cargo.toml"), "found only {entries:?}");
    let strangers: Vec<String> =
        entries.into_iter().filter(|name| !TOP_LEVEL.contains(&name.as_str())).collect();
    assert_none(&strangers, "move these into a folder, or add them to the table TOP_LEVEL");
}
