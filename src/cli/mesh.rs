//! The subcommand `mesh`.

use std::path::PathBuf;

use clap::Args;

use super::common::{CommonArguments, OneScene, SetArguments, end_by_signals};
use super::files::Files;
use super::parse::parse_seconds;
use crate::export::mesh::write_mesh;
use crate::export::print::{counted, print_line};

#[derive(Args)]
pub(super) struct MeshArguments {
    /// The scene, and the song to which it moves; if none is given, the built-in demo track
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The moment in the song, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    at: f64,
    /// The number of cells along the longest side: twice as many give four times as many triangles
    #[arg(long, value_name = "CELLS", default_value = "128", value_parser = clap::value_parser!(u16).range(4..=1024))]
    detail: u16,
    #[command(flatten)]
    scene: OneScene,
    #[command(flatten)]
    set: SetArguments,
    /// The file to write: .glb with colours, for Blender and others; .stl, for printing; or .obj
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: MeshArguments) -> anyhow::Result<()> {
    let common = arguments.common;
    common.start_log();
    end_by_signals();
    let (song, scene) = Files::of(arguments.files)?.song_and_scene()?;
    let (scene, gain) = (arguments.scene.choose(scene, &common)?.source, common.gain.unwrap_or_default());
    let (at, set, detail) = (arguments.at, arguments.set.set, arguments.detail.into());
    let triangles = write_mesh(&song, at, gain, &scene, &set, detail, &arguments.output)?;
    Ok(print_line(&format!("{}: {}", arguments.output.display(), counted(triangles, "triangle")))?)
}
