//! Generates files for the program and its documentation, and checks shaders: `cargo xtask TOOL [ARGUMENTS]`.

#![allow(unreachable_pub, reason = "a program has no public interface")]

mod animation;
mod desktop;
mod gallery;
mod gpu;
mod grammars;
mod language_page;
mod root;
mod thumbnails;

/// A tool: its name, arguments, description and function.
type Tool = (&'static str, &'static str, &'static str, fn(&[String]) -> anyhow::Result<()>);

const TOOLS: &[Tool] = &[
    ("desktop", "[FOLDER]", "writes manual pages and completions to assets/desktop", desktop::run),
    (
        "gallery",
        "[SCENE ...]",
        "writes docs/gallery.md and the images of these scenes, or of all scenes",
        gallery::run,
    ),
    (
        "gpu",
        "[--gpu NAME] [--shaders FOLDER] [--check | --accept] [PROGRAM ...]",
        "compiles the shader programs for other GPUs and prints the results",
        gpu::run,
    ),
    (
        "gpu-programs",
        "[--json] [--shaders FOLDER] [PROGRAM ...]",
        "compiles the shader programs for this GPU and prints the results",
        gpu::programs,
    ),
    ("grammars", "[FOLDER]", "writes the grammars for editors to editors", grammars::run),
    ("language-page", "[FOLDER]", "writes docs/language.md and the images of shapes", language_page::run),
    (
        "thumbnails",
        "[SCENE ...]",
        "draws assets/thumbnails for these shipped scenes, or for all shipped scenes",
        thumbnails::run,
    ),
];

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let tool = arguments.first().and_then(|name| TOOLS.iter().find(|(tool, ..)| tool == name));
    let Some((.., run)) = tool else {
        let list = TOOLS.iter().map(|(name, takes, makes, _)| format!("\n  {name} {takes}  {makes}"));
        anyhow::bail!("expected a tool:{}", list.collect::<String>());
    };
    run(&arguments[1..])
}
