//! What is done with hostile input: a plain function for each kind of it, which panics where a promise is broken.
//!
//! libFuzzer runs them (`bin/`, by `scripts/fuzz`), and `tests/fuzz_targets.rs` takes this file in to run them over all
//! seeds and changed ones in every test run.

mod bytes;
mod control;
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

pub(crate) use seeds::{Seed, changed, dictionary};

/// A kind of input.
pub(crate) struct Target {
    /// What it is called, as its program in `bin/`.
    pub name: &'static str,
    /// Takes an input in.
    pub run: fn(&[u8]),
    /// Inputs to begin with.
    pub seeds: fn() -> Vec<Seed>,
    /// Whether the scene language's words help.
    pub speaks: bool,
    /// How many changed seeds the test suite runs: what it does in a second or two.
    pub changes: usize,
}

/// Lexer and parser.
pub(crate) const SYNTAX: Target =
    Target { name: "syntax", run: text::syntax, seeds: seeds::scenes, speaks: true, changes: 400 };
/// From a text to tapes and GLSL.
pub(crate) const SCENE: Target =
    Target { name: "scene", run: text::scene, seeds: seeds::scenes, speaks: true, changes: 100 };
/// Regions of the scene that a text is.
pub(crate) const REGIONS: Target =
    Target { name: "regions", run: regions::regions, seeds: seeds::small_scenes, speaks: true, changes: 60 };
/// Tapes of expressions, and their words.
pub(crate) const TAPE: Target =
    Target { name: "tape", run: expression::tape, seeds: seeds::steps, speaks: false, changes: 1_000 };
/// All evaluators of an expression.
pub(crate) const DIFFERENTIAL: Target = Target {
    name: "differential",
    run: expression::differential,
    seeds: seeds::steps,
    speaks: false,
    changes: 300,
};
/// A sound in any container.
pub(crate) const DECODE: Target =
    Target { name: "decode", run: files::decode, seeds: seeds::sounds, speaks: false, changes: 600 };
/// A playlist or cue sheet.
pub(crate) const LISTS: Target =
    Target { name: "lists", run: files::lists, seeds: seeds::lists, speaks: false, changes: 600 };
/// The file of settings.
pub(crate) const SETTINGS: Target =
    Target { name: "settings", run: files::settings, seeds: seeds::settings, speaks: false, changes: 300 };
/// What a network sends to the page for phones.
pub(crate) const PHONES: Target =
    Target { name: "phones", run: phones::phones, seeds: seeds::phones, speaks: false, changes: 40_000 };

/// A packet of OSC.
pub(crate) const OSC: Target =
    Target { name: "osc", run: control::osc, seeds: seeds::packets, speaks: false, changes: 4_000 };
/// The bytes of a MIDI device.
pub(crate) const MIDI: Target =
    Target { name: "midi", run: control::midi, seeds: seeds::midi, speaks: false, changes: 4_000 };

/// A show file.
pub(crate) const SHOWS: Target =
    Target { name: "shows", run: shows::shows, seeds: seeds::shows, speaks: false, changes: 1_000 };

/// All of them.
pub(crate) const TARGETS: [&Target; 12] = [
    &SYNTAX,
    &SCENE,
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
];

/// What a libFuzzer program begins with. Where `MARIANA_FUZZ_SEEDS` names a folder, seeds and the dictionary are written
/// there and the program ends.
///
/// # Panics
/// They cannot be written.
pub(crate) fn prepare(target: &Target) {
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
