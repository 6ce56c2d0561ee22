//! Generates the shipped demo track and textures, and measures the program in a window of this desktop:
//! `cargo run --manifest-path tools/Cargo.toml -- TOOL [ARGUMENTS]`.

#[cfg(unix)]
mod controllers;
mod demo_track;
mod textures;
#[cfg(unix)]
mod typing;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((tool, rest)) if tool == "demo-track" => demo_track::run(rest),
        Some((tool, rest)) if tool == "textures" => textures::run(rest),
        #[cfg(unix)]
        Some((tool, rest)) if tool == "controllers" => controllers::run(rest),
        #[cfg(unix)]
        Some((tool, rest)) if tool == "typing" => typing::run(rest),
        _ => anyhow::bail!(
            "expected a tool: demo-track OUT.wav, textures [FOLDER], controllers PROGRAM [SECONDS], or typing PROGRAM [KEYS]"
        ),
    }
}
