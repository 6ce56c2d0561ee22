//! Makes what the program ships and what its documentation shows: `cargo xtask TOOL [ARGUMENTS]`.

#![allow(unreachable_pub, reason = "a program has no outside")]

mod demo_track;
mod desktop;
mod gallery;
mod gpu;
#[cfg(unix)]
mod hands;
mod language_page;
mod root;
mod textures;
mod thumbnails;
#[cfg(unix)]
mod typing;

/// A tool: its name, its arguments, what it makes, and its work.
type Tool = (&'static str, &'static str, &'static str, fn(&[String]) -> anyhow::Result<()>);

const TOOLS: &[Tool] = &[
    ("demo-track", "OUT.wav", "composes the built-in song", demo_track::run),
    (
        "desktop",
        "[FOLDER]",
        "writes manual pages and completions and draws the icon, in assets/desktop",
        desktop::run,
    ),
    (
        "gallery",
        "[SCENE ...]",
        "draws docs/gallery.md and its pictures: of these scenes, or of all",
        gallery::run,
    ),
    (
        "gpu",
        "[--gpu NAME] [--shaders FOLDER] [--check | --accept] [PROGRAM ...]",
        "prints what the compilers of GPUs that are not there make of the programs",
        gpu::run,
    ),
    (
        "gpu-programs",
        "[--json] [--shaders FOLDER] [PROGRAM ...]",
        "the same for the GPU that is there",
        gpu::programs,
    ),
    #[cfg(unix)]
    (
        "hands",
        "PROGRAM [SECONDS]",
        "measures from a message of MIDI or OSC to the frame that shows it, and floods, in a window of this desktop",
        hands::run,
    ),
    ("language-page", "[FOLDER]", "writes docs/language.md and draws its shapes", language_page::run),
    ("textures", "[FOLDER]", "paints assets/textures", textures::run),
    (
        "thumbnails",
        "[SCENE ...]",
        "draws assets/thumbnails: of these shipped scenes, or of all",
        thumbnails::run,
    ),
    #[cfg(unix)]
    (
        "typing",
        "PROGRAM [KEYS]",
        "measures from a key of the editor to its letter and its picture, in a window of this desktop",
        typing::run,
    ),
];

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let tool = arguments.first().and_then(|name| TOOLS.iter().find(|(tool, ..)| tool == name));
    let Some((.., run)) = tool else {
        let list = TOOLS.iter().map(|(name, takes, makes, _)| format!("\n  {name} {takes}  {makes}"));
        anyhow::bail!("name one of the tools:{}", list.collect::<String>());
    };
    run(&arguments[1..])
}
