//! Generates the shipped demo track, textures and icon and the moving image of the README, and measures the program in a
//! window of this desktop: `cargo run --manifest-path tools/Cargo.toml -- TOOL [ARGUMENTS]` in the project's folder.

#[cfg(unix)]
mod controllers;
mod demo_track;
mod icon;
mod melt;
mod textures;
#[cfg(unix)]
mod typing;

/// A tool: its name, arguments and function.
type Tool = (&'static str, &'static str, fn(&[String]) -> anyhow::Result<()>);

const TOOLS: &[Tool] = &[
    #[cfg(unix)]
    ("controllers", "PROGRAM [SECONDS]", controllers::run),
    ("demo-track", "OUT.wav", demo_track::run),
    ("icon", "[FOLDER]", icon::run),
    ("melt", "PROGRAM", melt::run),
    ("textures", "[FOLDER]", textures::run),
    #[cfg(unix)]
    ("typing", "PROGRAM [KEYS]", typing::run),
];

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let tool = arguments.first().and_then(|name| TOOLS.iter().find(|(tool, ..)| tool == name));
    let Some((.., run)) = tool else {
        let list = TOOLS.iter().map(|(name, takes, _)| format!("\n  {name} {takes}"));
        anyhow::bail!("expected a tool:{}", list.collect::<String>());
    };
    run(&arguments[1..])
}
