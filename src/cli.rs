//! The command line: every flag and subcommand, checked against the limits, and what each starts.

mod choices;
mod parse;
mod scene;
mod view;

use choices::{GainChoice, Quality, RepeatChoice, Sdf, Switch, ToneMapChoice};
use std::ffi::OsString;
use std::io::{BufWriter, IsTerminal, Write};
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

use parse::{parse_duration, parse_fade, parse_fps, parse_latency, parse_seconds, parse_size};

use crate::app;
use crate::config::{ListenChoice, PlaySettings};
use crate::demo_track::{DEMO_TRACK, song_or_demo};
use crate::ending::{self, Signal};
use crate::export::analyze::{AnalyzeRequest, print_features};
use crate::export::bench::{AllRequest, BenchRequest, measure, measure_all};
use crate::export::painter::SceneChoice;
use crate::export::print::{print_line, tell};
use crate::export::still::{StillRequest, write_still};
use crate::export::video::{VideoRequest, write_video};
use crate::gpu::scene_resources::CellUse;
use crate::gpu::shader_source::ShaderLibrary;
use crate::program_cache::ProgramCache;
use crate::scenes::{SceneError, SceneSource};
use mariana_player::decode::quiet_contained_panics;
use mariana_player::devices::list_devices;
use mariana_player::playlist::Playlist;
use mariana_player::track::Repeat;

/// A music visualizer whose worlds are formulas: plays music and shows it.
#[derive(Parser)]
#[command(name = "mariana", version, args_conflicts_with_subcommands = true, after_help = PLAY_EXAMPLES)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    play: PlayArguments,
}

const PLAY_EXAMPLES: &str = "\
Formats: wav, aiff, flac, mp3, ogg (vorbis, opus), m4a (aac, alac), caf, mkv and webm; any rate, up to 32 channels.

Examples:
  mariana                         play the built-in demo track
  mariana song.flac               play a song
  mariana song.mp3 --once         ... and end with it
  mariana album/ list.m3u8 x.ogg  play folders, lists (m3u, m3u8, pls, cue) and files, without gaps
  mariana music/ --shuffle        ... in random order
  mariana song.ogg --latency 180  ... over Bluetooth headphones that lag by 180 ms
  mariana song.flac --scene metaballs  ... in another scene, or a file of your own
  mariana --system                show what the computer plays
  mariana --mic --device USB      show what a microphone hears
  mariana --scene \"min(y, length(p - vec3(0, 1, 0)) - 1)\"
  mariana still song.flac --at 12.5 --size 1280x720 -o frame.png
  mariana help still              what a subcommand takes

Press H in the window to see the keys.";

#[derive(Args)]
struct PlayArguments {
    /// Songs, folders and lists (m3u, m3u8, pls, cue); if none is given, the built-in demo track plays
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Show what a microphone or another input hears, instead of a song
    #[arg(long, conflicts_with_all = ["files", "system", "silent", "once"])]
    mic: bool,
    /// Show what the computer plays, instead of a song
    #[arg(long, conflicts_with_all = ["files", "silent", "once"])]
    system: bool,
    /// Play the tracks in random order
    #[arg(long)]
    shuffle: bool,
    /// Which tracks are repeated
    #[arg(long, value_name = "WHAT", default_value = "all")]
    repeat: RepeatChoice,
    /// Output device, or input with --mic and --system: an id or name from 'mariana devices', or part of one
    #[arg(long, value_name = "NAME", conflicts_with = "silent")]
    device: Option<String>,
    /// Play without sound, in real time
    #[arg(long)]
    silent: bool,
    /// End with the last track instead of starting over
    #[arg(long, conflicts_with = "repeat")]
    once: bool,
    /// Volume at the start, in percent
    #[arg(long, value_name = "PERCENT", default_value = "100", value_parser = clap::value_parser!(u8).range(0..=100), allow_negative_numbers = true)]
    volume: u8,
    /// How much later the sound is heard than the device reports; negative for earlier [default: what [ and ] set last]
    #[arg(long, value_name = "MS", value_parser = parse_latency, allow_negative_numbers = true)]
    latency: Option<f64>,
    /// Maximum frames per second [default: the monitor's rate]
    #[arg(long, value_name = "FPS", value_parser = parse_fps, allow_negative_numbers = true)]
    fps_cap: Option<f64>,
    /// How good the picture is; auto draws fewer pixels if frames take too long
    #[arg(long, value_name = "HOW", default_value = "auto")]
    quality: Quality,
    /// Whether flashes are dimmed if there are more than three a second, as WCAG 2.3.1 asks for
    #[arg(long, value_name = "ON-OFF", default_value = "on")]
    flash_limiter: Switch,
    /// How many seconds one scene fades into another with N and P; 0 cuts
    #[arg(long, value_name = "SECONDS", default_value = "0.5", value_parser = parse_fade, allow_negative_numbers = true)]
    fade: f64,
    /// Whether the next and the previous scene are prepared while one is shown
    #[arg(long, value_name = "ON-OFF", default_value = "on", overrides_with = "prepare_ahead")]
    prepare_ahead: Switch,
    /// Whether programs that the driver has compiled are kept, in the user's folder for caches
    #[arg(long, value_name = "ON-OFF", default_value = "on")]
    program_cache: Switch,
    /// Start in full screen
    #[arg(long)]
    fullscreen: bool,
    /// Size of the window in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size, allow_hyphen_values = true)]
    size: (u32, u32),
    /// Print which OpenGL is available, and exit
    #[arg(long)]
    gl_info: bool,
    #[command(flatten)]
    view: view::ViewArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Args)]
struct CommonArguments {
    /// The scene to show: a file, the name of a shipped scene, or a formula such as "length(p) - 1"
    #[arg(long, value_name = "SCENE", default_value = DEFAULT_SCENE, allow_hyphen_values = true)]
    scene: OsString,
    /// How the scene's formulas are run; auto interprets at once and compiles in the background
    #[arg(long, value_name = "HOW", default_value = "auto")]
    sdf: Sdf,
    /// Whether rays skip empty space and run tapes shortened for the place; the picture is the same [default: where
    /// that costs less; bench measures both]
    #[arg(long, value_name = "ON-OFF")]
    regions: Option<Switch>,
    /// How light is turned into screen colours [default: as the scene says, otherwise agx]
    #[arg(long, value_name = "MAP")]
    tone_map: Option<ToneMapChoice>,
    /// Whether quiet and loud sound are levelled for the picture; values in decibels are as measured either way
    #[arg(long, value_name = "AUTO-OFF", default_value = "auto")]
    gain: GainChoice,
    /// Read the shaders from this folder, to work on them
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
    /// Log what happens; twice for more
    #[arg(short, long, action = clap::ArgAction::Count)]
    verbose: u8,
}

/// The scene that is shown by default.
const DEFAULT_SCENE: &str = "speakers";

#[derive(Subcommand)]
enum Command {
    /// Render one moment of a song to a PNG or JPEG, without a window and without a sound card
    #[command(after_help = "Examples:\n  mariana still song.flac --at 12.5 --size 1280x720 -o frame.png\n  \
                            mariana still --at 30 -o demo.png       of the demo track")]
    Still(StillArguments),
    /// Render a stretch of a song to a video (needs ffmpeg) or to numbered stills
    #[command(after_help = "Examples:\n  mariana video song.flac -o song.mp4\n  \
                            mariana video song.flac --start 60 --duration 10 --fps 30 --size 640x360 -o part.mp4\n  \
                            mariana video --duration 10 --fps 1 -o stills/    a folder: numbered PNGs")]
    Video(VideoArguments),
    /// Print the features of a song, one line for each frame
    #[command(after_help = "Examples:\n  mariana analyze song.flac --json > song.jsonl\n  \
                            mariana analyze song.flac --fps 10 --start 30 --duration 5")]
    Analyze(AnalyzeArguments),
    /// Measure frame times and distance evaluations, without a window
    #[command(
        after_help = "Examples:\n  mariana bench\n  mariana bench song.flac --at 30 --size 1280x720 --json\n  \
                      mariana bench --all --json > measured.json"
    )]
    Bench(BenchArguments),
    /// Check scenes: print every mistake with its place, or what the scene costs
    #[command(after_help = "Examples:\n  mariana check speakers\n  mariana check my/*.scene")]
    Check(scene::CheckArguments),
    /// Print the tape of a scene's distance: the clauses that an interpreter runs
    #[command(after_help = "Examples:\n  mariana tape \"max(sqrt(x*x+y*y)-1, 0.5-sqrt(x*x+y*y))\"\n  \
                            mariana tape speakers --glsl\n  \
                            mariana tape \"min(y, length(p) - 1)\" --dot | dot -Tsvg > graph.svg")]
    Tape(scene::TapeArguments),
    /// Evaluate a scene's distance at points, one number per line
    #[command(after_help = "Examples:\n  mariana eval \"length(p) - 1\" --at 0,2,0\n  \
                            mariana eval speakers --points points.csv --set \"band(3)=0.5\" --set volume.x=0.2")]
    Eval(scene::EvalArguments),
    /// List the sound systems, inputs and outputs with what they support
    #[command(after_help = "Examples:\n  mariana devices\n  mariana devices --json\n  \
                            mariana song.flac --device \"USB\"       play on the first one with USB in its name")]
    Devices {
        /// Print JSON instead of text
        #[arg(long)]
        json: bool,
    },
}

#[derive(Args)]
struct StillArguments {
    /// The song; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// The moment, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    at: f64,
    /// Size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size, allow_hyphen_values = true)]
    size: (u32, u32),
    /// The PNG or JPEG file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    view: view::ViewArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Args)]
struct VideoArguments {
    /// The song; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// Where to start, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    start: f64,
    /// Length, as 80 or 1:20.5 [default: to the end]
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Frames per second
    #[arg(long, default_value = "30", value_parser = parse_fps, allow_negative_numbers = true)]
    fps: f64,
    /// Size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size, allow_hyphen_values = true)]
    size: (u32, u32),
    /// Whether flashes are dimmed if there are more than three a second, as WCAG 2.3.1 asks for
    #[arg(long, value_name = "ON-OFF", default_value = "on")]
    flash_limiter: Switch,
    /// The video to write, or a folder ending in '/' for numbered PNGs
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    view: view::ViewArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Args)]
struct AnalyzeArguments {
    /// The song; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// One JSON object per line: t, volume as [left, right], bands as 32 numbers, ...
    #[arg(long)]
    json: bool,
    /// Whether quiet and loud sound are levelled in the values from 0 to 1
    #[arg(long, value_name = "AUTO-OFF", default_value = "auto")]
    gain: GainChoice,
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

#[derive(Args)]
struct BenchArguments {
    /// The song that drives the picture; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// The moment that is drawn, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    at: f64,
    /// Size in pixels
    #[arg(long, value_name = "WxH", default_value = "640x360", value_parser = parse_size, allow_hyphen_values = true)]
    size: (u32, u32),
    /// Frames to time
    #[arg(long, default_value = "60", value_parser = clap::value_parser!(u16).range(1..=10_000), allow_negative_numbers = true)]
    frames: u16,
    /// Measure all shipped scenes
    #[arg(long, conflicts_with = "scene")]
    all: bool,
    /// With --all: only the scenes whose names contain this; may be given several times
    #[arg(long, value_name = "PART", requires = "all")]
    only: Vec<String>,
    /// Also compare the picture at edges with one of 64 samples per pixel; slow
    #[arg(long)]
    edges: bool,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    common: CommonArguments,
}

/// Parses the arguments and does what they say.
///
/// # Errors
/// What the job could not do; usage errors end the program with code 2 before that.
pub fn run() -> anyhow::Result<()> {
    quiet_contained_panics();
    ending::outlive_file_limits();
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    crate::gpu::address_space::spare_where_limited();
    dispatch(Arguments::parse()).map_err(colored_on_a_terminal)
}

/// A scene's mistakes in colour, if they are printed on a terminal.
fn colored_on_a_terminal(error: anyhow::Error) -> anyhow::Error {
    let mistakes = error.chain().find_map(|cause| match cause.downcast_ref() {
        Some(SceneError::Mistakes { name, colored, .. }) => {
            Some(format!("{name} has mistakes: correct what is underlined\n{}", colored.trim_end()))
        }
        _ => None,
    });
    match mistakes {
        Some(text) if std::io::stderr().is_terminal() => anyhow::Error::msg(text),
        _ => error,
    }
}

fn dispatch(arguments: Arguments) -> anyhow::Result<()> {
    let Arguments { command, play } = arguments;
    match command {
        None => run_play(play),
        Some(Command::Still(arguments)) => run_still(arguments),
        Some(Command::Video(arguments)) => run_video(arguments),
        Some(Command::Analyze(arguments)) => run_analyze(arguments),
        Some(Command::Bench(arguments)) => run_bench(arguments),
        Some(Command::Check(arguments)) => scene::run_check(&arguments),
        Some(Command::Tape(arguments)) => scene::run_tape(&arguments),
        Some(Command::Eval(arguments)) => scene::run_eval(&arguments),
        Some(Command::Devices { json }) => run_devices(json),
    }
}

/// Scale factors at which a window is still readable.
const SCALE_FACTORS: std::ops::RangeInclusive<f64> = 0.1..=20.0;

/// Refuses values at which winit, which reads this variable on X11, or egui panics.
fn check_scale_factor() -> anyhow::Result<()> {
    const NAME: &str = "WINIT_X11_SCALE_FACTOR";
    let value = std::env::var(NAME).unwrap_or_default();
    let is_number = value.parse().is_ok_and(|factor: f64| SCALE_FACTORS.contains(&factor));
    if value.is_empty() || value.eq_ignore_ascii_case("randr") || is_number {
        return Ok(());
    }
    let (least, most) = (SCALE_FACTORS.start(), SCALE_FACTORS.end());
    anyhow::bail!(
        "the variable {NAME} is '{value}': set it to a number from {least} to {most} or to randr, or unset it"
    )
}

fn run_play(arguments: PlayArguments) -> anyhow::Result<()> {
    let common = arguments.common.start_log();
    check_scale_factor()?;
    let listen = match (arguments.mic, arguments.system) {
        (true, _) => Some(ListenChoice::Microphone),
        (false, true) => Some(ListenChoice::System),
        (false, false) => None,
    };
    let settings = PlaySettings {
        device: arguments.device,
        silent: arguments.silent,
        once: arguments.once,
        volume: f32::from(arguments.volume) / 100.0,
        latency: arguments.latency.map(|milliseconds| milliseconds / 1000.0),
        gain: common.gain.into(),
        listen,
        fps_cap: arguments.fps_cap,
        quality: arguments.quality.into(),
        limit_flashes: arguments.flash_limiter == Switch::On,
        fade: arguments.fade,
        prepare_ahead: arguments.prepare_ahead == Switch::On,
        program_cache: match arguments.program_cache {
            Switch::On => ProgramCache::of_user(),
            Switch::Off => ProgramCache::off(),
        },
        fullscreen: arguments.fullscreen,
        size: arguments.size,
        gl_info: arguments.gl_info,
    };
    let repeat = match arguments.repeat {
        _ if arguments.once => Repeat::Off,
        RepeatChoice::All => Repeat::All,
        RepeatChoice::One => Repeat::One,
        RepeatChoice::Off => Repeat::Off,
    };
    let scene = SceneChoice { view: arguments.view.view, ..common.scene()? };
    let tracks = match listen {
        Some(_) => None,
        None if arguments.files.is_empty() => Some(Playlist::of_song(DEMO_TRACK, repeat)),
        None => Some(Playlist::open(&arguments.files, repeat, arguments.shuffle)?),
    };
    app::run(tracks, settings, scene)
}

/// Lets Ctrl-C and similar signals end a job that writes files.
fn end_by_signals() {
    let answer = |signal: Signal| {
        ending::end_now(signal, || {
            if std::io::stderr().is_terminal() {
                // After the number of the frame.
                let _ = writeln!(std::io::stderr());
            }
            tell(&format!("{signal} ended the work: unfinished files are removed"));
        })
    };
    if let Err(error) = ending::watch(answer) {
        tracing::warn!("signals cannot be caught; the next run removes what they leave unfinished ({error})");
    }
}

fn run_still(arguments: StillArguments) -> anyhow::Result<()> {
    let common = arguments.common.start_log();
    end_by_signals();
    write_still(&StillRequest {
        song: song_or_demo(arguments.file),
        at: arguments.at,
        size: arguments.size,
        gain: common.gain.into(),
        output: arguments.output,
        scene: SceneChoice { view: arguments.view.view, ..common.scene()? },
    })?;
    Ok(())
}

fn run_video(arguments: VideoArguments) -> anyhow::Result<()> {
    let common = arguments.common.start_log();
    end_by_signals();
    let request = VideoRequest {
        song: song_or_demo(arguments.file),
        start: arguments.start,
        duration: arguments.duration,
        fps: arguments.fps,
        size: arguments.size,
        gain: common.gain.into(),
        limit_flashes: arguments.flash_limiter == Switch::On,
        output: arguments.output,
        scene: SceneChoice { view: arguments.view.view, ..common.scene()? },
    };
    let on_terminal = std::io::stderr().is_terminal();
    let mut progress = |done: u64, expected: Option<u64>| {
        if on_terminal {
            // A terminal that is gone is no reason to stop.
            let _ = match expected {
                Some(expected) => write!(std::io::stderr(), "\rframe {done} of {expected}"),
                None => write!(std::io::stderr(), "\rframe {done}"),
            };
        }
    };
    let written = write_video(&request, &mut progress);
    if on_terminal {
        let _ = writeln!(std::io::stderr());
    }
    Ok(print_line(&format!("{} frames in {}", written?, request.output.display()))?)
}

fn run_analyze(arguments: AnalyzeArguments) -> anyhow::Result<()> {
    let request = AnalyzeRequest {
        song: song_or_demo(arguments.file),
        fps: arguments.fps,
        start: arguments.start,
        duration: arguments.duration,
        gain: arguments.gain.into(),
        json: arguments.json,
    };
    print_features(&request, &mut BufWriter::new(std::io::stdout().lock()))?;
    Ok(())
}

fn run_bench(arguments: BenchArguments) -> anyhow::Result<()> {
    let common = arguments.common.start_log();
    let request = BenchRequest {
        song: song_or_demo(arguments.file),
        at: arguments.at,
        size: arguments.size,
        frames: arguments.frames.into(),
        gain: common.gain.into(),
        scene: common.scene()?,
        both: common.regions.is_none(),
        edges: arguments.edges,
    };
    if arguments.all {
        let request = AllRequest { each: request, only: arguments.only };
        let report = measure_all(&request, &mut |scene, number, count| {
            tell(&format!("{scene}, {number} of {count}"));
        });
        return if arguments.json { print_json(&report) } else { Ok(print_line(&report.to_string())?) };
    }
    let report = measure(&request)?;
    if arguments.json { print_json(&report) } else { Ok(print_line(&report.to_string())?) }
}

fn run_devices(json: bool) -> anyhow::Result<()> {
    let report = list_devices();
    if json { print_json(&report) } else { Ok(print_line(report.to_string().trim_end())?) }
}

fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    Ok(print_line(&serde_json::to_string_pretty(value)?)?)
}

impl CommonArguments {
    /// Starts the log on standard error: the program's own warnings; with -v what happens, and other libraries'
    /// warnings; with -vv details.
    fn start_log(self) -> Self {
        let (own, others) = match self.verbose {
            0 => (LevelFilter::WARN, LevelFilter::OFF),
            1 => (LevelFilter::INFO, LevelFilter::WARN),
            _ => (LevelFilter::DEBUG, LevelFilter::INFO),
        };
        let filter = Targets::new().with_default(others).with_target(env!("CARGO_CRATE_NAME"), own);
        let lines = tracing_subscriber::fmt::layer()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal())
            .without_time();
        tracing_subscriber::registry().with(lines.with_filter(filter)).init();
        self
    }

    fn scene(&self) -> anyhow::Result<SceneChoice> {
        Ok(SceneChoice {
            source: SceneSource::find(&self.scene)?,
            sdf: self.sdf.into(),
            shaders: self.shaders.as_deref().map_or_else(ShaderLibrary::embedded, ShaderLibrary::on_disk),
            cells: self.regions.map_or(CellUse::WhereTheyPay, Into::into),
            view: None,
            tone_map: self.tone_map.map(Into::into),
            verbose: self.verbose > 0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_argument_parser_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_subcommand_shows_examples() {
        for command in Arguments::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Examples:"), "{} has none", command.get_name());
        }
    }
}
