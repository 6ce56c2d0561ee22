//! Flags and helpers of several subcommands.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::prelude::*;
use tracing_subscriber::registry::LookupSpan;

use super::files::scene_of;
use super::parse::choice;
use crate::config::SdfChoice;
use crate::ending::{self, Signal};
use crate::export::{Output, SceneChoice, print_message};
use crate::frame::held_inputs::Setting;
use crate::gpu::{CellUse, ShaderLibrary};
use crate::view::{self, ViewChoice};
use mariana_field::world::ToneMap;
use mariana_music::Gain;

/// `None` is the scene's own tone map. The alias is needed because clap treats an `Option<Option<T>>` as a flag with an
/// optional value.
type WantedToneMap = Option<ToneMap>;

#[derive(Args)]
pub(super) struct CommonArguments {
    /// Interpret or compile the scene's formulas; auto interprets at once and compiles in the background
    #[arg(long, value_name = "HOW", default_value = "auto", value_parser = choice::<SdfChoice>())]
    sdf: SdfChoice,
    /// Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default:
    /// on where that is faster; bench measures both]
    #[arg(long, value_name = "ON-OFF", value_parser = choice::<bool>())]
    pub(super) regions: Option<bool>,
    /// Conversion of light to screen colours [default: the scene's own, or in a window the last choice there]
    #[arg(long, value_name = "MAP", value_parser = choice::<WantedToneMap>())]
    pub(super) tone_map: Option<WantedToneMap>,
    /// Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed
    /// [default: auto, or in a window the last choice there]
    #[arg(long, value_name = "AUTO-OFF", value_parser = choice::<Gain>())]
    pub(super) gain: Option<Gain>,
    /// Read the shaders from this folder, to work on them
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
    /// Log what the program does; twice for more
    #[arg(short, long, action = clap::ArgAction::Count)]
    verbose: u8,
}

pub(super) const DEFAULT_SCENE: &str = "speakers";

#[derive(Args)]
pub(super) struct OneScene {
    /// The scene to show: a file, the name of a shipped scene ('mariana scenes' lists them), or a formula such as
    /// "length(p) - 1" [default: speakers]
    #[arg(long, value_name = "SCENE", allow_hyphen_values = true)]
    scene: Option<OsString>,
}

impl OneScene {
    pub(super) fn is_default(&self) -> bool {
        self.scene.is_none()
    }

    pub(super) fn choose(
        &self,
        file: Option<PathBuf>,
        common: &CommonArguments,
    ) -> anyhow::Result<SceneChoice> {
        match (&self.scene, file) {
            (Some(scene), Some(file)) => {
                bail!("two scenes were given, {} and {}: give one of them", scene.display(), file.display())
            }
            (Some(scene), None) => common.scene(scene),
            (None, Some(file)) => common.scene(file.as_os_str()),
            (None, None) => common.scene(DEFAULT_SCENE.as_ref()),
        }
    }
}

#[derive(Args)]
pub(super) struct SetArguments {
    /// Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than
    /// once
    #[arg(long, value_name = "NAME=VALUE")]
    pub(super) set: Vec<Setting>,
}

#[derive(Args)]
pub(super) struct ViewArguments {
    #[arg(long, value_name = "VIEW", help = view::help(), allow_hyphen_values = true)]
    pub(super) view: Option<ViewChoice>,
}

/// True if `stream` is a terminal and NO_COLOR is not set (no-color.org), so that text may be coloured.
pub(super) fn colors(stream: &impl IsTerminal) -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()) && stream.is_terminal()
}

pub(super) fn refuse_a_terminal(output: &Output, example: &str) -> anyhow::Result<()> {
    if *output == Output::Standard && std::io::stdout().is_terminal() {
        bail!("standard output is a terminal: send it to a program or a file, such as '{example}'");
    }
    Ok(())
}

/// Ends the line of the progress bar, if there may be one.
fn end_progress_line() {
    if std::io::stderr().is_terminal() {
        let _ = writeln!(std::io::stderr());
    }
}

pub(super) fn end_by_signals() {
    end_by_signals_and("unfinished files are removed");
}

/// `rest` ends the message: what becomes of the files.
pub(super) fn end_by_signals_and(rest: &'static str) {
    answer_signals(move |signal| {
        ending::end_now(signal, || {
            end_progress_line();
            print_message(&format!("{signal} ended the work; {rest}"));
        })
    });
}

/// Lets the first signal finish an image early. A later signal ends the process.
pub(super) fn finish_by_signals() {
    answer_signals(|signal| {
        end_progress_line();
        print_message(&format!(
            "{signal}: finishing the image with the paths so far; send it again to write no image"
        ));
    });
}

fn answer_signals(answer: impl Fn(Signal) + Send + 'static) {
    if let Err(error) = ending::watch(answer) {
        tracing::warn!(
            "signals cannot be caught ({error}); if a signal ends this run, the next run removes the unfinished files"
        );
    }
}

/// Prints warnings and errors of the log like the program's other messages.
struct Sentences;

impl<S, N> FormatEvent<S, N> for Sentences
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut out: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        let kind = if *event.metadata().level() == Level::ERROR { "error" } else { "warning" };
        write!(out, "mariana: {kind}: ")?;
        context.format_fields(out.by_ref(), event)?;
        writeln!(out)
    }
}

impl CommonArguments {
    /// Starts the log on standard error. The log contains the program's warnings, with -v also the program's progress
    /// and the libraries' warnings, and with -vv also debug messages.
    pub(super) fn start_log(&self) {
        let (own, others) = match self.verbose {
            0 => (LevelFilter::WARN, LevelFilter::OFF),
            1 => (LevelFilter::INFO, LevelFilter::WARN),
            _ => (LevelFilter::DEBUG, LevelFilter::INFO),
        };
        let filter = Targets::new().with_default(others).with_target(env!("CARGO_CRATE_NAME"), own);
        let lines = tracing_subscriber::fmt::layer()
            .with_writer(std::io::stderr)
            .with_ansi(colors(&std::io::stderr()))
            .without_time();
        let lines = match self.verbose {
            0 => lines.event_format(Sentences).boxed(),
            _ => lines.boxed(),
        };
        tracing_subscriber::registry().with(lines.with_filter(filter)).init();
    }

    pub(super) fn scene(&self, scene: &OsStr) -> anyhow::Result<SceneChoice> {
        Ok(SceneChoice {
            sdf: self.sdf,
            shaders: self.shaders.as_deref().map_or_else(ShaderLibrary::embedded, ShaderLibrary::on_disk),
            cells: match self.regions {
                None => CellUse::WhereTheyPay,
                Some(true) => CellUse::Always,
                Some(false) => CellUse::Never,
            },
            tone_map: self.tone_map.flatten(),
            verbose: self.verbose > 0,
            ..SceneChoice::from(scene_of(scene)?)
        })
    }
}
