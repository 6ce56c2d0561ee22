//! The subcommand `bench`.

use std::path::PathBuf;

use clap::Args;

use super::common::{CommonArguments, OneScene};
use super::files::Files;
use super::parse::{parse_seconds, parse_size, whole_number};
use super::print_json;
use crate::export::bench::{BenchRequest, measure, measure_all};
use crate::export::print::{print_line, print_message};

#[derive(Args)]
pub(super) struct BenchArguments {
    /// The song that drives the scene, or '-' for standard input; if none is given, the built-in demo track. A .scene
    /// file is the scene to measure
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The moment of the song to draw, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    at: f64,
    /// Size in pixels
    #[arg(long, value_name = "WxH", default_value = "640x360", value_parser = parse_size, allow_hyphen_values = true)]
    size: (u32, u32),
    /// Frames to time
    #[arg(long, default_value = "60", value_parser = whole_number::<u16>(1, 10_000, "frames"), allow_negative_numbers = true)]
    frames: u16,
    /// Measure all shipped scenes
    #[arg(long, conflicts_with = "scene")]
    all: bool,
    /// With --all: measure only scenes whose names contain this text; can be given more than once
    #[arg(long, value_name = "PART", requires = "all")]
    only: Vec<String>,
    /// Also measure time and quality for each number of samples at edges, at several sizes, which is slow
    #[arg(long)]
    edges: bool,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scene: OneScene,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: BenchArguments) -> anyhow::Result<()> {
    let common = arguments.common;
    common.start_log();
    let (song, scene) = Files::of(arguments.files)?.song_and_scene()?;
    if arguments.all
        && let Some(scene) = &scene
    {
        anyhow::bail!("--all measures the shipped scenes: leave out {} or --all", scene.display());
    }
    let request = BenchRequest {
        song,
        at: arguments.at,
        size: arguments.size,
        frames: arguments.frames.into(),
        gain: common.gain.unwrap_or_default(),
        scene: arguments.scene.choose(scene, &common)?,
        both: common.regions.is_none(),
        edges: arguments.edges,
    };
    if arguments.all {
        let report = measure_all(&request, &arguments.only, &mut |scene, number, count| {
            print_message(&format!("{scene}, {number} of {count}"));
        });
        return if arguments.json { print_json(&report) } else { Ok(print_line(&report.to_string())?) };
    }
    let report = measure(&request)?;
    if arguments.json { print_json(&report) } else { Ok(print_line(&report.to_string())?) }
}
