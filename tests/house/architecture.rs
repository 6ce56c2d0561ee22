//! Holds the walls between the rooms: who may use whom, what stays where, and how large files may grow.
//!
//! The rules are the tables below; ARCHITECTURE.md explains them. The tests read the sources, so a wall that falls
//! names the file and the line.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod source;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use source::{Token, references, stands_at, tokens, without_tests};

/// What stands in a row of [`ROOMS`] for a room that may use every other one.
const EVERYTHING: &[&str] = &["*"];

/// Each room (a folder or a file under `src/`) and the rooms it may use besides itself.
const ROOMS: &[(&str, &[&str])] = &[
    ("main", EVERYTHING),
    ("lib", EVERYTHING),
    ("cli", EVERYTHING),
    ("limits", &[]),
    ("ending", &[]),
    ("faults", &[]),
    ("atomic_file", &["ending"]),
    ("lang", &["graph", "limits"]),
    ("graph", &["limits"]),
    ("tape", &["graph", "limits"]),
    ("region", &["world", "graph", "tape", "limits"]),
    // How many bands there are is the sound's to say.
    ("world", &["lang", "graph", "tape", "dsp", "limits"]),
    ("dsp", &["limits"]),
    ("audio", &["dsp", "limits"]),
    ("frame", &["world", "graph", "dsp", "limits"]),
    ("view", &["frame", "world", "limits"]),
    ("flash", &["limits"]),
    ("gpu", &["frame", "view", "flash", "world", "region", "graph", "tape", "faults", "limits"]),
    ("scenes", &["lang", "world", "region", "limits"]),
    (
        "app",
        &[
            "lang", "graph", "tape", "region", "world", "scenes", "dsp", "audio", "frame", "view", "gpu",
            "export", "config", "flash", "ending", "limits",
        ],
    ),
    (
        "export",
        &[
            "world",
            "region",
            "scenes",
            "frame",
            "view",
            "flash",
            "gpu",
            "audio",
            "dsp",
            "config",
            "atomic_file",
            "ending",
            "limits",
        ],
    ),
    ("config", &["dsp", "atomic_file", "limits"]),
];

/// Crates that only some rooms may use. `egui` stands for `egui_winit` and its like too.
const OUTSIDE: &[(&str, &[&str])] = &[
    ("glow", &["gpu"]),
    ("glutin", &["gpu", "app"]),
    ("glutin_winit", &["app"]),
    ("winit", &["app"]),
    ("x11_dl", &["app"]),
    // The overlay, and the letters of legends.
    ("egui", &["app", "view"]),
    ("cpal", &["audio"]),
    ("symphonia", &["audio"]),
    // Generated GLSL is validated where it is generated.
    ("naga", &["world"]),
    // The desktop's controls are the window's.
    ("mpris_server", &["app"]),
    // The process ends in one place.
    ("signal_hook", &["ending"]),
    // Files are watched in one place.
    ("notify", &["scenes"]),
];

/// Rooms that do no I/O, read no clock, spawn no thread and know no library of devices.
const PURE_ROOMS: &[&str] = &["dsp", "flash", "lang", "graph", "tape", "region"];
const IMPURE_PATHS: &[&str] = &[
    "std::env",
    "std::fs",
    "std::io",
    "std::net",
    "std::process",
    "std::thread",
    "std::time::Instant",
    "std::time::SystemTime",
];
const IMPURE_MACROS: &[&str] = &["print", "println", "eprint", "eprintln", "dbg"];
/// The dependencies of Cargo.toml that a pure room may use.
const PURE_CRATES: &[&str] = &["multiversion", "rustfft", "serde", "thiserror"];

/// Rooms whose files may hold `unsafe`, each with its reason in `#![expect(unsafe_code, reason = ...)]`.
const UNSAFE_ROOMS: &[&str] = &["gpu", "app"];

const LINES_MAX: usize = 600;
const LINES_MEDIAN_MAX: usize = 250;
/// Files that may be longer than [`LINES_MAX`], and why.
const LONG_FILES: &[(&str, &str)] =
    &[("tests/decoding.rs", "every format and every kind of damage is measured against one signal")];

/// Everything that the repository holds at its top.
const TOP_LEVEL: &[&str] = &[
    ".ci",
    ".editorconfig",
    ".gitattributes",
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
    "deny.toml",
    "docs",
    "examples",
    "fuzz",
    "rustfmt.toml",
    "scripts",
    "shaders",
    "src",
    "tests",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every file under `folder`, as paths from the repository's root with `/` between, sorted.
fn files_under(folder: &str) -> Vec<String> {
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

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn rust_sources() -> Vec<(String, String)> {
    let files: Vec<String> = files_under("src").into_iter().filter(|file| file.ends_with(".rs")).collect();
    assert!(files.len() > 20, "only {} sources were found: the walk is broken", files.len());
    files.into_iter().map(|file| (file.clone(), read(&file))).collect()
}

/// `src/audio/decode/mod.rs` is the module `["audio", "decode"]`; the first name is the room.
fn module_of(file: &str) -> Vec<String> {
    let inner = file.strip_prefix("src/").unwrap().strip_suffix(".rs").unwrap_or(file);
    let mut module: Vec<String> = inner.split('/').map(str::to_owned).collect();
    if module.len() > 1 && module.last().is_some_and(|name| name == "mod") {
        module.pop();
    }
    module
}

fn room_of(file: &str) -> String {
    module_of(file).swap_remove(0)
}

fn row(room: &str) -> Option<&'static [&'static str]> {
    ROOMS.iter().find(|(name, _)| *name == room).map(|(_, allowed)| *allowed)
}

/// The names in Cargo.toml's `[dependencies]`, as code spells them.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let section = manifest.lines().skip_while(|line| line.trim() != "[dependencies]").skip(1);
    let entries = section.take_while(|line| !line.starts_with('[')).filter(|line| !line.starts_with('#'));
    entries.filter_map(|line| Some(line.split_once('=')?.0.trim().replace('-', "_"))).collect()
}

/// Whether the path reaches what `banned` names: below it, or by a glob above it.
fn reaches(path: &[String], banned: &str) -> bool {
    let banned: Vec<&str> = banned.split("::").collect();
    match path.split_last() {
        Some((last, above)) if last == "*" && above.len() < banned.len() => above == &banned[..above.len()],
        _ => path.len() >= banned.len() && path[..banned.len()] == banned[..],
    }
}

/// What is wrong with one reference from `room`, if anything is.
fn broken_wall(room: &str, path: &[String], dependencies: &BTreeSet<String>) -> Option<String> {
    let allowed = row(room)?;
    if path[0] == "crate" {
        let target = path.get(1)?;
        let fits = allowed == EVERYTHING || target == room || allowed.contains(&target.as_str());
        return (!fits).then(|| match row(target) {
            Some(_) => format!("{room} must not use {target}"),
            None => format!("crate::{target} is in no room, name the room it comes from"),
        });
    }
    let covers = |name: &str| path[0] == name || path[0].starts_with(&format!("{name}_"));
    let crate_row = OUTSIDE.iter().filter(|(name, _)| covers(name)).max_by_key(|(name, _)| name.len());
    if let Some((name, rooms)) = crate_row.filter(|(_, rooms)| !rooms.contains(&room)) {
        return Some(format!("the crate {name} belongs to {} alone", rooms.join(" and ")));
    }
    if PURE_ROOMS.contains(&room) {
        if let Some(banned) = IMPURE_PATHS.iter().find(|banned| reaches(path, banned)) {
            return Some(format!("{room} is pure and must not use {banned}"));
        }
        if dependencies.contains(&path[0]) && !PURE_CRATES.contains(&path[0].as_str()) {
            return Some(format!("{room} is pure and must not use the crate {}", path[0]));
        }
    }
    None
}

/// Every wall that the text of `file` breaks, one line each; a wall once per file.
fn broken_walls(file: &str, text: &str, dependencies: &BTreeSet<String>) -> Vec<String> {
    let (room, tokens) = (room_of(file), tokens(text));
    let mut found: Vec<(usize, String)> = references(&tokens, &module_of(file))
        .iter()
        .filter_map(|reference| Some((reference.line, broken_wall(&room, &reference.path, dependencies)?)))
        .collect();
    if PURE_ROOMS.contains(&room.as_str()) {
        let prints = |i: &usize| {
            IMPURE_MACROS.contains(&tokens[*i].text.as_str()) && stands_at(&tokens, i + 1, &["!"])
        };
        found.extend(
            (0..tokens.len()).filter(prints).map(|i| (tokens[i].line, format!("{room} must not print"))),
        );
    }
    found.sort();
    let mut told = BTreeSet::new();
    found.retain(|(_, what)| told.insert(what.clone()));
    found.into_iter().map(|(line, what)| format!("{file}:{line}: {what}")).collect()
}

/// `unsafe` where it must not be, one line each.
fn misplaced_unsafe(file: &str, text: &str) -> Vec<String> {
    let tokens = tokens(text);
    let excused = (0..tokens.len())
        .any(|i| stands_at(&tokens, i, &["#", "!", "[", "expect", "(", "unsafe_code", ",", "reason", "="]));
    let room = room_of(file);
    let what = match (UNSAFE_ROOMS.contains(&room.as_str()), excused) {
        (true, true) => return Vec::new(),
        (true, false) => {
            "unsafe needs #![expect(unsafe_code, reason = ...)] at the top of its file".to_owned()
        }
        (false, _) => format!("unsafe belongs to {} alone", UNSAFE_ROOMS.join(" and ")),
    };
    lines_where(&tokens, |i| tokens[i].text == "unsafe")
        .map(|line| format!("{file}:{line}: {what}"))
        .collect()
}

/// Calls of `unwrap` and `expect`, by line, less those that carry `#[expect(clippy::..., reason = ...)]`. (That the
/// attribute stands at a call is clippy's to check: an idle one is a warning.)
fn unwraps(tokens: &[Token]) -> Vec<usize> {
    let excuses = ["unwrap_used", "expect_used"]
        .map(|lint| ["#", "[", "expect", "(", "clippy", "::", lint, ",", "reason"]);
    let excused =
        (0..tokens.len()).filter(|&i| excuses.iter().any(|excuse| stands_at(tokens, i, excuse))).count();
    let calls: Vec<usize> = lines_where(tokens, |i| {
        matches!(tokens[i].text.as_str(), "unwrap" | "expect")
            && i > 0
            && matches!(tokens[i - 1].text.as_str(), "." | "::")
    })
    .collect();
    if calls.len() <= excused { Vec::new() } else { calls }
}

fn lines_where<'a>(
    tokens: &'a [Token],
    wanted: impl Fn(usize) -> bool + 'a,
) -> impl Iterator<Item = usize> + 'a {
    (0..tokens.len()).filter(move |&i| wanted(i)).map(|i| tokens[i].line)
}

/// Where the module `name`, declared in `file`, may live.
fn module_files(file: &str, module: &source::TestModule) -> Vec<String> {
    let (folder, own_name) = file.rsplit_once('/').unwrap();
    if let Some(path) = &module.path {
        return vec![format!("{folder}/{path}")];
    }
    let folder = match own_name {
        "mod.rs" | "lib.rs" | "main.rs" => folder,
        _ => file.trim_end_matches(".rs"),
    };
    vec![format!("{folder}/{}.rs", module.name), format!("{folder}/{}/mod.rs", module.name)]
}

/// What git tracks at the top; without git (an unpacked archive) what lies there and is not ignored.
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

#[track_caller]
fn assert_none(found: &[String], advice: &str) {
    assert!(found.is_empty(), "{advice}:\n  {}", found.join("\n  "));
}

#[test]
fn every_room_has_a_row() {
    let rooms: BTreeSet<String> = rust_sources().iter().map(|(file, _)| room_of(file)).collect();
    let unknown: Vec<String> = rooms.into_iter().filter(|room| row(room).is_none()).collect();
    assert_none(&unknown, "give these rooms under src/ a row in the table of this test");
    for (room, allowed) in ROOMS.iter().chain(OUTSIDE) {
        let strangers: Vec<_> = allowed.iter().filter(|name| **name != "*" && row(name).is_none()).collect();
        assert!(strangers.is_empty(), "the row of {room} names {strangers:?}, which have no row");
    }
}

#[test]
fn rooms_keep_to_their_walls() {
    let dependencies = dependencies(&read("Cargo.toml"));
    assert!(dependencies.contains("glow") && dependencies.contains("symphonia_adapter_libopus"));
    let found: Vec<String> =
        rust_sources().iter().flat_map(|(file, text)| broken_walls(file, text, &dependencies)).collect();
    assert_none(&found, "these uses break the walls between the rooms");
}

#[test]
fn unsafe_stays_where_it_is_explained() {
    let found: Vec<String> =
        rust_sources().iter().flat_map(|(file, text)| misplaced_unsafe(file, text)).collect();
    assert_none(&found, "unsafe is misplaced");
}

#[test]
fn nothing_unwraps_outside_tests() {
    let (mut found, mut test_files) = (Vec::new(), Vec::new());
    for (file, text) in rust_sources() {
        let (kept, modules) = without_tests(&tokens(&text));
        test_files.extend(modules.iter().flat_map(|module| module_files(&file, module)));
        found.extend(unwraps(&kept).into_iter().map(|line| (file.clone(), line)));
    }
    found.retain(|(file, _)| !test_files.contains(file));
    let found: Vec<String> = found.into_iter().map(|(file, line)| format!("{file}:{line}")).collect();
    assert_none(&found, "return an error instead of calling unwrap or expect");
}

#[test]
fn files_stay_small() {
    let texts = |folder| {
        let files = files_under(folder).into_iter();
        files.filter(|file| [".rs", ".glsl", ".vert", ".frag"].iter().any(|end| file.ends_with(end)))
    };
    let lines = |file: &str| read(file).lines().count();
    let long: Vec<String> = ["src", "shaders", "tests"]
        .into_iter()
        .flat_map(texts)
        .filter(|file| lines(file) > LINES_MAX)
        .collect();
    let excused = |file: &str| LONG_FILES.iter().any(|(name, _)| *name == file);
    let too_long: Vec<String> = long.iter().filter(|file| !excused(file)).cloned().collect();
    assert_none(
        &too_long,
        "split these files of more than 600 lines, or give a reason in the table of this test",
    );
    for (file, _) in LONG_FILES {
        assert!(long.iter().any(|name| name == file), "{file} is no longer long: take it out of the table");
    }

    let mut lengths: Vec<usize> = texts("src").map(|file| lines(&file)).collect();
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    assert!(median < LINES_MEDIAN_MAX, "the median file under src/ has {median} lines");
}

#[test]
fn the_top_of_the_repository_holds_the_agreed_entries() {
    let entries = top_level_entries();
    assert!(entries.contains("src") && entries.contains("Cargo.toml"), "only {entries:?} were found");
    let strangers: Vec<String> =
        entries.into_iter().filter(|name| !TOP_LEVEL.contains(&name.as_str())).collect();
    assert_none(&strangers, "find these a place in a folder, or a row in the table of this test");
}

/// The scanner itself: what it must find, and what it must leave alone.
mod scanner {
    use super::*;

    fn walls(file: &str, text: &str) -> Vec<String> {
        let dependencies = ["glow", "cpal", "tempfile", "rustfft"].map(str::to_owned).into();
        broken_walls(file, text, &dependencies)
    }

    #[track_caller]
    fn breaks(file: &str, text: &str, message: &str) {
        assert_eq!(walls(file, text), [format!("{file}:{message}")], "in {text}");
    }

    #[test]
    fn finds_rooms_however_they_are_named() {
        for text in [
            "use crate::gpu;",
            "use crate::gpu::gl::Gl;",
            "use crate::{limits::LIMITS, gpu::gl};",
            "use crate::{limits, gpu::{self as pictures, gl::*}};",
            "pub use super::super::gpu::Gl;",
            "use crate as root; fn f() { root::gpu::draw() }",
            "fn f() -> crate::gpu::Gl { todo!() }",
            "fn f() { let gl = <crate::gpu::Gl as Default>::default(); }",
            "mod inner { use super::super::super::gpu::Gl; }",
            "#[cfg(test)] mod tests { use crate::gpu::Gl; }",
        ] {
            breaks("src/dsp/bands.rs", text, "1: dsp must not use gpu");
        }
        breaks("src/limits.rs", "\n\nuse crate::dsp::Features;", "3: limits must not use dsp");
        breaks("src/frame/mod.rs", "use super::audio::Player;", "1: frame must not use audio");
        breaks("src/app/mod.rs", "use mariana::cli;", "1: app must not use cli");
        breaks("src/audio/mod.rs", "use crate::*;", "1: crate::* is in no room, name the room it comes from");
    }

    #[test]
    fn finds_crates_outside_their_rooms() {
        breaks("src/app/window.rs", "use glow::HasContext;", "1: the crate glow belongs to gpu alone");
        breaks("src/gpu/gl.rs", "use egui_winit::State;", "1: the crate egui belongs to app and view alone");
        breaks("src/gpu/gl.rs", "use glutin_winit::X;", "1: the crate glutin_winit belongs to app alone");
        breaks(
            "src/export/still.rs",
            "fn f(d: &cpal::Device) {}",
            "1: the crate cpal belongs to audio alone",
        );
        breaks("src/main.rs", "use {symphonia as s};", "1: the crate symphonia belongs to audio alone");
        breaks("src/audio/mod.rs", "use glutin::x;", "1: the crate glutin belongs to gpu and app alone");
        breaks("src/frame/mod.rs", "fn f() { ::winit::run() }", "1: the crate winit belongs to app alone");
    }

    #[test]
    fn finds_what_is_impure() {
        let instant = "1: dsp is pure and must not use std::time::Instant";
        for text in [
            "use std::time::Instant;",
            "use std::{time::{Duration, Instant as Now}, fmt};",
            "use std::time; fn f() { time::Instant::now(); }",
            "fn f() { std::time::Instant::now(); }",
        ] {
            breaks("src/dsp/volume.rs", text, instant);
        }
        breaks("src/dsp/volume.rs", "use std::thread;", "1: dsp is pure and must not use std::thread");
        breaks("src/tape/mod.rs", "use std::fs::File;", "1: tape is pure and must not use std::fs");
        breaks("src/dsp/mod.rs", "use tempfile::X;", "1: dsp is pure and must not use the crate tempfile");
        breaks("src/dsp/mod.rs", "fn f() {\n println!(\"\") }", "2: dsp must not print");
        assert_eq!(walls("src/dsp/mod.rs", "use std::time::*;").len(), 1);
        assert_eq!(walls("src/dsp/mod.rs", "use std::*;").len(), 1);
    }

    #[test]
    fn leaves_the_rest_alone() {
        for (file, text) in [
            (
                "src/dsp/mod.rs",
                "//! [`crate::gpu`] /* */\n/// crate::gpu::Gl\n/* /* */ use crate::gpu; */ fn f() {}",
            ),
            (
                "src/dsp/mod.rs",
                r##"const A: &str = "crate::gpu::x \" "; const B: &str = r#"" crate::gpu::x"#;"##,
            ),
            ("src/dsp/mod.rs", "fn f<'a>(c: &'a u8) -> char { if '\"' == 'x' { '\\'' } else { '\\u{20}' } }"),
            ("src/dsp/mod.rs", "use std::time::Duration; use rustfft::Fft; use crate::limits::LIMITS;"),
            (
                "src/dsp/track.rs",
                "use super::Features; mod tests { use super::super::Features; use super::*; }",
            ),
            ("src/dsp/track.rs", "fn f() -> impl Iterator + use<'_> { glow.fs::<u8>() }"),
            ("src/audio/decode/mod.rs", "use super::source; use std::{fs, thread}; use symphonia_core::x;"),
            ("src/gpu/headless.rs", "use glutin::display; use crate::frame::Frame;"),
            ("src/main.rs", "use mariana::{gpu::Gl, audio::Player}; mod cli;"),
        ] {
            assert_eq!(walls(file, text), [""; 0], "in {text}");
        }
    }

    #[test]
    fn finds_misplaced_unsafe() {
        let explained = "#![expect(unsafe_code, reason = \"C\")]\nfn f() { unsafe {} }";
        assert_eq!(misplaced_unsafe("src/gpu/gl.rs", explained), [""; 0]);
        assert_eq!(misplaced_unsafe("src/gpu/gl.rs", "// unsafe\nconst A: &str = \"unsafe\";"), [""; 0]);
        assert_eq!(misplaced_unsafe("src/gpu/gl.rs", "\nfn f() { unsafe {} }").len(), 1);
        assert_eq!(misplaced_unsafe("src/audio/mod.rs", explained).len(), 1);
    }

    #[test]
    fn finds_unwraps_outside_tests() {
        let text = "fn a() { b().unwrap(); c.map(Option::unwrap) }\n\
                    #[expect(lint)] fn d() { e.unwrap_or(f).expect(\"g\") }\n\
                    #[cfg(test)] #[allow(x)] mod tests { fn h() { i.unwrap() } }\n\
                    #[cfg(test)] #[path = \"j_tests.rs\"] mod j;\n#[cfg(test)] mod k;\n\
                    #[cfg(all(test, unix))] fn l(m: [u8; 2]) { n.unwrap() }\n\
                    #[cfg(not(test))] fn o() { p.expect(\"q\") } // .unwrap()";
        let (kept, modules) = without_tests(&tokens(text));
        assert_eq!(unwraps(&kept), [1, 1, 2, 7]);
        let excused = "#[expect(clippy::expect_used, reason = \"never empty\")] a.expect(\"b\");";
        assert_eq!(unwraps(&tokens(excused)), [0; 0]);
        assert_eq!(unwraps(&tokens(&format!("{excused} c.unwrap()"))), [1, 1]);
        let files: Vec<_> = modules.iter().map(|module| module_files("src/x/y.rs", module)).collect();
        assert_eq!(files, [vec!["src/x/j_tests.rs"], vec!["src/x/y/k.rs", "src/x/y/k/mod.rs"]]);
    }

    #[test]
    fn reads_the_manifest() {
        let manifest = "[lib]\nname = \"x\"\n[dependencies]\n# y = 1\na-b = \"1\"\nc = { d = 1 }\n\n[dev-dependencies]\ne = \"1\"";
        assert_eq!(dependencies(manifest), ["a_b", "c"].map(str::to_owned).into());
    }
}
