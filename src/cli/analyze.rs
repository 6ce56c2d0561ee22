//! The subcommand `analyze`.

use std::io::BufWriter;
use std::path::PathBuf;

use clap::Args;

use super::choices::choice;
use super::files::song_or_demo;
use super::parse::{parse_duration, parse_fps, parse_seconds};
use crate::config::Choice;
use crate::export::analyze::{AnalyzeRequest, print_features};
use mariana_music::Gain;

#[derive(Args)]
pub(super) struct AnalyzeArguments {
    /// The song, or '-' for standard input; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// One JSON object per line: t, volume as [left, right], bands as 32 numbers, ...
    #[arg(long)]
    json: bool,
    /// Whether quiet and loud sound are levelled in the values from 0 to 1
    #[arg(long, value_name = "AUTO-OFF", default_value = Gain::default().name(), value_parser = choice::<Gain>())]
    gain: Gain,
    /// Lines per second
    #[arg(long, default_value = "60", value_parser = parse_fps, allow_negative_numbers = true)]
    fps: f64,
    /// Where to start, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    start: f64,
    /// Length, as 80 or 1:20.5 [default: to the end]
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_negative_numbers = true)]
    duration: Option<f64>,
}

pub(super) fn run(arguments: AnalyzeArguments) -> anyhow::Result<()> {
    let request = AnalyzeRequest {
        song: song_or_demo(arguments.file)?,
        fps: arguments.fps,
        start: arguments.start,
        duration: arguments.duration,
        gain: arguments.gain,
        json: arguments.json,
    };
    print_features(&request, &mut BufWriter::new(std::io::stdout().lock()))?;
    Ok(())
}
