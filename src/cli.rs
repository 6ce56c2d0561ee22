//! The command line: all flags and subcommands. Values are checked against the limits in [`crate::limits`]; each
//! subcommand has a module here that turns its arguments into a request for [`crate::export`] or the window.

mod analyze;
mod bench;
mod check;
mod common;
mod controlled;
mod files;
mod format;
mod frame_options;
mod headings;
mod import;
mod light;
mod lsp;
mod mesh;
mod page;
mod parse;
mod play;
mod progress;
mod projection;
mod scene;
mod scenes;
mod setting_flags;
mod show;
mod still;
mod video;

use std::ffi::OsString;
use std::path::Path;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use crate::config::Folders;
use crate::ending;
use crate::export::{ExportError, print_line};
use crate::scenes::SceneError;
use crate::session::Prepared;
use common::colors;
use mariana_field::lang::nearest;
use mariana_player::decode::quiet_contained_panics;
use mariana_player::devices::list_devices;

/// A music visualizer whose worlds are formulas: plays music and shows it.
#[derive(Parser)]
#[command(
    name = "mariana",
    version,
    args_conflicts_with_subcommands = true,
    after_help = FIRST_EXAMPLES,
    after_long_help = PLAY_EXAMPLES,
    mut_args = headings::of_show,
    mut_subcommands = |command| command.mut_args(headings::under_heading)
)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    play: play::PlayArguments,
}

const FIRST_EXAMPLES: &str = "\
Examples:
  mariana                         play the built-in demo track
  mariana song.flac --scene orb   play a song in another scene
  mariana --system                show what the computer plays
  mariana help still              show the flags of a subcommand

Press H in the window to see the keys. 'mariana --help' lists all flags.";

const PLAY_EXAMPLES: &str = "\
Formats: wav, aiff, flac, mp3, ogg (vorbis, opus), m4a (aac, alac), caf, mkv and webm; any rate, up to 32 channels.

Examples:
  mariana                         play the built-in demo track
  mariana song.flac               play a song
  mariana song.mp3 --once         ... and end with it
  mariana album/ list.m3u8 x.ogg  play folders, lists (m3u, m3u8, pls, cue) and files, without gaps
  mariana music/ --shuffle        ... in random order
  mariana song.ogg --latency 180  ... over Bluetooth headphones that lag by 180 ms
  mariana song.flac --scene metaballs  ... in another scene
  mariana my.scene song.ogg       ... in your own scene; 'mariana scenes' lists the shipped ones
  mariana --system                show what the computer plays
  mariana --mic --device USB      show what a microphone hears
  mariana --scene \"min(y, length(p - vec3(0, 1, 0)) - 1)\"
  mariana still song.flac --at 12.5 --size 1280x720 -o frame.png
  mariana help still              show the flags of a subcommand

Press H in the window to see the keys.";

#[derive(Subcommand)]
enum Command {
    /// Render one moment of a song to a PNG, JPEG or WebP, without a window or a sound card
    #[command(after_help = "Examples:\n  mariana still song.flac --at 12.5 --size 1280x720 -o frame.png\n  \
                            mariana still --at 30 -o demo.png       the demo track\n  \
                            mariana still --scene orb --set volume.x=0.5 -o - > orb.png")]
    Still(still::StillArguments),
    /// Render a part of a song to a video (needs ffmpeg) or to numbered stills
    #[command(after_help = "Examples:\n  mariana video song.flac -o song.mp4\n  \
                            mariana video song.flac --start 60 --duration 10 --fps 30 --size 640x360 -o part.mp4\n  \
                            mariana video song.flac --for story --start 1:20 -o story.mp4\n  \
                            mariana video song.flac --scene orb --scene city@1:20 -o two.mp4\n  \
                            mariana video song.flac --show auto -o show.mp4\n  \
                            mariana video --duration 10 --fps 1 -o stills/    a folder: numbered PNGs\n  \
                            mariana video song.flac -o - | mpv -              frames without sound, as y4m")]
    Video(video::VideoArguments),
    /// Print the features of a song, one line for each frame
    #[command(after_help = "Examples:\n  mariana analyze song.flac --json > song.jsonl\n  \
                            mariana analyze song.flac --fps 10 --start 30 --duration 5\n  \
                            mariana analyze - < song.ogg")]
    Analyze(analyze::AnalyzeArguments),
    /// Measure frame times and distance evaluations, without a window
    #[command(
        after_help = "Examples:\n  mariana bench\n  mariana bench song.flac --at 30 --size 1280x720 --json\n  \
                      mariana bench --all --json > measured.json"
    )]
    Bench(bench::BenchArguments),
    /// Check scenes: print each mistake with its position, or the cost of the scene
    #[command(after_help = "Examples:\n  mariana check speakers\n  mariana check my/*.scene\n  \
                            mariana check my.scene --json    for editors: an object for each mistake")]
    Check(check::CheckArguments),
    /// Format scene files; the scenes stay the same
    #[command(after_help = "Examples:\n  mariana format my.scene\n  mariana format --check my/*.scene\n  \
                            mariana format - < my.scene > formatted.scene")]
    Format(format::FormatArguments),
    /// Run the language server for editors, on standard input and output
    #[command(
        after_help = "Examples:\n  mariana lsp    an editor starts this command; docs/editor.md shows how"
    )]
    Lsp(lsp::LspArguments),
    /// Print the tape of a scene's distance: the clauses that the interpreter runs
    #[command(after_help = "Examples:\n  mariana tape \"max(sqrt(x*x+y*y)-1, 0.5-sqrt(x*x+y*y))\"\n  \
                            mariana tape speakers --glsl\n  \
                            mariana tape \"min(y, length(p) - 1)\" --dot | dot -Tsvg > graph.svg")]
    Tape(scene::TapeArguments),
    /// Evaluate a scene's distance at points, one number per line
    #[command(after_help = "Examples:\n  mariana eval \"length(p) - 1\" --at 0,2,0\n  \
                            mariana eval speakers --points points.csv --set \"band(3)=0.5\" --set volume.x=0.2")]
    Eval(scene::EvalArguments),
    /// Make a scene from a shader in GLSL, such as one from Shadertoy
    #[command(after_help = "Examples:\n  mariana import snail.glsl\n  \
                            mariana import downloads/snail.glsl -o my/snail.scene\n  \
                            mariana import snail.glsl -o -    print the scene")]
    Import(import::ImportArguments),
    /// Write a scene's distance and colours as GLSL, for example for Shadertoy
    #[command(after_help = "Examples:\n  mariana export --glsl speakers\n  \
                            mariana export --glsl my.scene --main-image -o my.glsl")]
    Export(import::ExportArguments),
    /// Write the director's show for a song to a show file, for editing
    #[command(after_help = "Examples:\n  mariana show song.flac -o song.show\n  \
                            mariana video song.flac --show song.show -o song.mp4\n  \
                            mariana show song.flac --scene orb --scene city    only with these scenes")]
    Show(show::ShowArguments),
    /// Write the surfaces of a moment as triangles, for Blender and for printing
    #[command(after_help = "Examples:\n  mariana mesh my.scene -o my.glb\n  \
                            mariana mesh --scene heart song.mp3 --at 1:12 -o heart.stl\n  \
                            mariana mesh --scene \"max(gyroid(p, 1, 0.1), sphere(p, 2))\" --detail 256 -o gyroid.obj")]
    Mesh(mesh::MeshArguments),
    /// Write a web page that plays a song with a show or a scene, in one file
    #[command(after_help = "Examples:\n  mariana page song.mp3 -o song.html\n  \
                            mariana page song.mp3 --show song.show --loop -o song.html\n  \
                            mariana page song.flac --scene metaballs -o song.html")]
    Page(page::PageArguments),
    /// List the shipped scenes with their descriptions
    #[command(after_help = "Examples:\n  mariana scenes\n  mariana --scene orb    show one of them")]
    Scenes,
    /// List the sound systems with their inputs and outputs, and the formats of these devices
    #[command(after_help = "Examples:\n  mariana devices\n  mariana devices --json\n  \
                            mariana song.flac --device \"USB\"       play on the first device with USB in its name")]
    Devices {
        /// Print JSON instead of text
        #[arg(long)]
        json: bool,
    },
}

/// Parses the arguments and runs the command.
///
/// # Errors
/// Fails if the command fails. Usage errors exit the program with code 2 instead.
pub fn run() -> anyhow::Result<()> {
    #[cfg(target_os = "linux")]
    crate::gpu::driver_cache::leave_where_full();
    quiet_contained_panics();
    ending::outlive_file_limits();
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    crate::gpu::heaps::limit_heaps();
    if let Some((typed, meant)) = misspelt(std::env::args_os().nth(1)) {
        let message =
            format!("there is no command '{typed}', and no file of that name: did you mean '{meant}'?");
        Arguments::command().error(ErrorKind::InvalidSubcommand, message).exit();
    }
    dispatch(Arguments::parse()).map_err(colored_on_a_terminal)
}

/// Parses the arguments of a show, such as `song.flac --scene orb`. Reads the settings from `folders`.
///
/// # Errors
/// Fails on a usage error, a subcommand, or an argument that is refused.
pub fn prepare_show<T: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = T>,
    folders: Folders,
) -> anyhow::Result<Prepared> {
    let named = arguments.into_iter().map(Into::into);
    let parsed = Arguments::try_parse_from(std::iter::once("mariana".into()).chain(named))?;
    anyhow::ensure!(parsed.command.is_none(), "a subcommand was given: give only the arguments of a show");
    play::prepare(parsed.play, folders)
}

/// If the first argument looks like a misspelt command, returns the argument and the command's name.
fn misspelt(first: Option<OsString>) -> Option<(String, String)> {
    let typed = first?.into_string().ok()?;
    let command = Arguments::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).chain(["help"]).collect();
    let is_word = typed.chars().all(char::is_alphabetic);
    if !is_word || names.contains(&typed.as_str()) || Path::new(&typed).exists() {
        return None;
    }
    let meant = nearest(&typed, names)?.to_owned();
    Some((typed, meant))
}

fn colored_on_a_terminal(error: anyhow::Error) -> anyhow::Error {
    let found = error.chain().find_map(|cause| match cause.downcast_ref() {
        Some(ExportError::Scene(error)) => Some(error),
        _ => cause.downcast_ref(),
    });
    let mistakes = match found {
        Some(SceneError::Mistakes { name, found }) => Some(format!(
            "{name} has mistakes: correct what is underlined\n{}",
            found.render(true).trim_end()
        )),
        _ => None,
    };
    match mistakes {
        Some(text) if colors(&std::io::stderr()) => anyhow::Error::msg(text),
        _ => error,
    }
}

fn dispatch(arguments: Arguments) -> anyhow::Result<()> {
    let Arguments { command, play } = arguments;
    match command {
        None => play::run(play),
        Some(Command::Still(arguments)) => still::run(arguments),
        Some(Command::Video(arguments)) => video::run(arguments),
        Some(Command::Analyze(arguments)) => analyze::run(arguments),
        Some(Command::Bench(arguments)) => bench::run(arguments),
        Some(Command::Check(arguments)) => check::run(&arguments),
        Some(Command::Format(arguments)) => format::run(&arguments),
        Some(Command::Lsp(arguments)) => lsp::run(&arguments),
        Some(Command::Tape(arguments)) => scene::run_tape(&arguments),
        Some(Command::Eval(arguments)) => scene::run_eval(&arguments),
        Some(Command::Import(arguments)) => import::run_import(&arguments),
        Some(Command::Export(arguments)) => import::run_export(&arguments),
        Some(Command::Show(arguments)) => show::run(arguments),
        Some(Command::Mesh(arguments)) => mesh::run(arguments),
        Some(Command::Page(arguments)) => page::run(arguments),
        Some(Command::Scenes) => scenes::run(),
        Some(Command::Devices { json }) => run_devices(json),
    }
}

fn run_devices(json: bool) -> anyhow::Result<()> {
    let report = list_devices();
    if json { print_json(&report) } else { Ok(print_line(report.to_string().trim_end())?) }
}

fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    Ok(print_line(&serde_json::to_string_pretty(value)?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_argument_parser_is_consistent() {
        Arguments::command().debug_assert();
    }

    /// `scripts/run` must list all commands that need no window.
    #[test]
    fn scripts_run_knows_every_command_without_a_window() {
        let cue_list = include_str!("../scripts/run");
        let listed =
            cue_list.lines().find(|line| line.trim_start().starts_with("still |")).unwrap_or_default();
        let listed: Vec<&str> = listed.split([' ', '|', ')']).filter(|word| !word.is_empty()).collect();
        let command = Arguments::command();
        for name in command.get_subcommands().map(clap::Command::get_name).chain(["help"]) {
            assert!(listed.contains(&name), "scripts/run opens a window for `mariana {name}`");
        }
    }

    #[test]
    fn every_subcommand_shows_examples() {
        for command in Arguments::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Examples:"), "the help of {} shows no examples", command.get_name());
        }
    }

    #[test]
    fn a_misspelt_command_was_taken_for_a_song() {
        let meant = |typed: &str| misspelt(Some(typed.into())).map(|(_, meant)| meant);
        for (typed, command) in
            [("stil", "still"), ("vidoe", "video"), ("analyse", "analyze"), ("scene", "scenes")]
        {
            assert_eq!(meant(typed).as_deref(), Some(command), "{typed}");
        }
        for typed in ["still", "song", "stil.ogg", "--help", "src", ""] {
            assert_eq!(meant(typed), None, "{typed}");
        }
    }
}
