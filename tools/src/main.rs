//! Generates the shipped demo track and textures: `cargo run --manifest-path tools/Cargo.toml -- TOOL [ARGUMENTS]`.

mod demo_track;
mod textures;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((tool, rest)) if tool == "demo-track" => demo_track::run(rest),
        Some((tool, rest)) if tool == "textures" => textures::run(rest),
        _ => anyhow::bail!("expected a tool: demo-track OUT.wav, or textures [FOLDER]"),
    }
}
