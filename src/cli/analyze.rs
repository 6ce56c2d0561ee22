//! The subcommand `analyze`.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Args;

use super::common::end_by_signals;
use super::files::song_or_demo;
use super::parse::{choice, parse_duration, parse_fps, parse_seconds};
use crate::config::Choice;
use crate::export::analyze::print_features;
use crate::export::song_features::SongFeatures;
use crate::export::structure::print_structure;
use mariana_music::Gain;

#[derive(Args)]
pub(super) struct AnalyzeArguments {
    /// The song, or '-' for standard input; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// Print the structure of the whole song instead of its moments: tempo, bars, key, sections, builds, drops
    #[arg(long, conflicts_with_all = ["gain", "fps", "start", "duration"])]
    structure: bool,
    /// Draw the song on one page: waveform, energy, beats, bars, sections, builds, drops, chords, chroma, and the
    /// director's show
    #[arg(long, value_name = "FILE.svg", conflicts_with_all = ["gain", "fps", "start", "duration"])]
    plot: Option<PathBuf>,
    /// Also print the position in the whole song at each moment: bar, section, energy, build, drop, ...
    #[arg(long, conflicts_with_all = ["structure", "plot"])]
    song: bool,
    /// Print one JSON object per line: t, volume as [left, right], bands as 32 numbers, ...; with --structure a single
    /// object
    #[arg(long)]
    json: bool,
    /// Automatic gain: quiet and loud songs reach the same values from 0 to 1
    #[arg(long, value_name = "AUTO-OFF", default_value = Gain::default().name(), value_parser = choice::<Gain>())]
    gain: Gain,
    /// Lines per second
    #[arg(long, default_value = "60", value_parser = parse_fps, allow_negative_numbers = true)]
    fps: f64,
    /// Start, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    start: f64,
    /// Length, as 80 or 1:20.5 [default: to the end]
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_negative_numbers = true)]
    duration: Option<f64>,
}

pub(super) fn run(arguments: AnalyzeArguments) -> anyhow::Result<()> {
    if arguments.structure || arguments.plot.is_some() {
        end_by_signals();
        let mut out = std::io::stdout().lock();
        let out: Option<&mut dyn Write> = if arguments.structure { Some(&mut out) } else { None };
        let song = song_or_demo(arguments.file)?;
        return Ok(print_structure(&song, arguments.plot.as_deref(), out, arguments.json)?);
    }
    let mut song = SongFeatures::open_with(&song_or_demo(arguments.file)?, arguments.start, arguments.gain)?;
    song.require(arguments.start)?;
    let offsets = (0_u64..).map(|index| index as f64 / arguments.fps);
    let is_within = |offset: &f64| arguments.duration.is_none_or(|duration| *offset < duration);
    let times = offsets.take_while(is_within).map(|offset| arguments.start + offset);
    let mut out = BufWriter::new(std::io::stdout().lock());
    Ok(print_features(&mut song, times, arguments.song, arguments.json, &mut out)?)
}
