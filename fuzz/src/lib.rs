//! Fuzz targets: one function for each kind of hostile input. Each function panics if a guarantee is broken.
//!
//! libFuzzer runs these functions (`bin/`, with `scripts/fuzz`). `tests/fuzz_targets.rs` includes this file, and runs
//! the functions with all seeds and mutated seeds in every test run.

mod bytes;
mod control;
mod drawn;
mod expression;
mod files;
mod phones;
#[allow(dead_code, reason = "tests/pictures/agreement.rs uses the rest")]
#[path = "../../crates/field/tests/field/expression.rs"]
mod random;
mod regions;
mod seeds;
mod shows;
mod text;
mod words;

use std::path::Path;

pub use seeds::{Seed, changed, dictionary};

pub struct Target {
    /// Name of the target and of its program in `bin/`.
    pub name: &'static str,
    pub run: fn(&[u8]),
    pub seeds: fn() -> Vec<Seed>,
    /// True if words of the scene language make useful inputs.
    pub speaks: bool,
    /// Number of mutated seeds in the test suite, chosen so that a run takes a second or two.
    pub changes: usize,
}

/// Lexer and parser of scenes.
pub const SYNTAX: Target =
    Target { name: "syntax", run: text::syntax, seeds: seeds::scenes, speaks: true, changes: 400 };
/// Scenes, from text to tapes and GLSL.
pub const SCENE: Target =
    Target { name: "scene", run: text::scene, seeds: seeds::scenes, speaks: true, changes: 100 };
/// The import of GLSL.
pub const GLSL: Target =
    Target { name: "glsl", run: text::glsl, seeds: seeds::shaders, speaks: false, changes: 150 };
pub const REGIONS: Target =
    Target { name: "regions", run: regions::regions, seeds: seeds::small_scenes, speaks: true, changes: 60 };
/// Tapes of expressions, and their encoding.
pub const TAPE: Target =
    Target { name: "tape", run: expression::tape, seeds: seeds::steps, speaks: false, changes: 1_000 };
/// All evaluators of an expression.
pub const DIFFERENTIAL: Target = Target {
    name: "differential",
    run: expression::differential,
    seeds: seeds::steps,
    speaks: false,
    changes: 300,
};
/// Sound files of any container.
pub const DECODE: Target =
    Target { name: "decode", run: files::decode, seeds: seeds::sounds, speaks: false, changes: 600 };
pub const LISTS: Target =
    Target { name: "lists", run: files::lists, seeds: seeds::lists, speaks: false, changes: 600 };
pub const SETTINGS: Target =
    Target { name: "settings", run: files::settings, seeds: seeds::settings, speaks: false, changes: 300 };
pub const PHONES: Target =
    Target { name: "phones", run: phones::phones, seeds: seeds::phones, speaks: false, changes: 40_000 };

pub const OSC: Target =
    Target { name: "osc", run: control::osc, seeds: seeds::packets, speaks: false, changes: 4_000 };
pub const MIDI: Target =
    Target { name: "midi", run: control::midi, seeds: seeds::midi, speaks: false, changes: 4_000 };

pub const SHOWS: Target =
    Target { name: "shows", run: shows::shows, seeds: seeds::shows, speaks: false, changes: 1_000 };

/// Drawings (SVG) as shapes.
pub const DRAWINGS: Target =
    Target { name: "drawings", run: drawn::drawings, seeds: seeds::drawings, speaks: false, changes: 60 };
/// Fonts of letters as shapes.
pub const FONTS: Target =
    Target { name: "fonts", run: drawn::fonts, seeds: seeds::fonts, speaks: false, changes: 60 };
pub const LYRICS: Target =
    Target { name: "lyrics", run: drawn::lyrics, seeds: seeds::lyrics, speaks: false, changes: 4_000 };

pub const TARGETS: [&Target; 16] = [
    &SYNTAX,
    &SCENE,
    &GLSL,
    &REGIONS,
    &TAPE,
    &DIFFERENTIAL,
    &DECODE,
    &LISTS,
    &SETTINGS,
    &OSC,
    &MIDI,
    &PHONES,
    &SHOWS,
    &DRAWINGS,
    &FONTS,
    &LYRICS,
];

/// Initializes a libFuzzer program. If `MARIANA_FUZZ_SEEDS` names a folder, writes seeds and dictionary to that
/// folder and ends the program.
///
/// # Panics
/// Panics if the files cannot be written.
pub fn prepare(target: &Target) {
    let Some(folder) = std::env::var_os("MARIANA_FUZZ_SEEDS") else { return };
    let folder = Path::new(&folder);
    let seeds = folder.join("seeds");
    std::fs::create_dir_all(&seeds).unwrap();
    for seed in (target.seeds)() {
        std::fs::write(seeds.join(seed.name), seed.bytes).unwrap();
    }
    if target.speaks {
        std::fs::write(folder.join("dictionary"), dictionary()).unwrap();
    }
    std::process::exit(0);
}
