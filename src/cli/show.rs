//! The subcommand `show`, and the flag `--show` of other subcommands.

use std::convert::Infallible;
use std::path::PathBuf;

use clap::Args;

use super::common::end_by_signals;
use super::files::{scene_of, song_or_demo};
use crate::export::show_file::write_show_file;
use crate::export::{Output, print_line};
use crate::scenes::{SceneSource, shipped_names};
use crate::show::ShowSource;

/// The value of `--show`; `None` for `off`. The alias is needed because clap treats an `Option<Option<T>>` as a flag
/// with an optional value.
pub(super) type WantedShow = Option<ShowSource>;

pub(super) fn parse_show(text: &str) -> Result<WantedShow, Infallible> {
    Ok(match text {
        "off" => None,
        "auto" => Some(ShowSource::Auto),
        "demo" => Some(ShowSource::Demo),
        file => Some(ShowSource::File(PathBuf::from(file))),
    })
}

/// Returns the scenes among which the director chooses: `scenes`, or the shipped ones if there are none.
pub(super) fn or_shipped(scenes: Vec<SceneSource>) -> Vec<SceneSource> {
    if scenes.is_empty() { shipped_names().into_iter().map(SceneSource::Shipped).collect() } else { scenes }
}

#[derive(Args)]
pub(super) struct ShowArguments {
    /// The song, or '-' for standard input; if none is given, the built-in demo track
    file: Option<PathBuf>,
    /// A scene from which to choose; can be given more than once [default: all shipped scenes]
    #[arg(long, value_name = "SCENE", allow_hyphen_values = true)]
    scene: Vec<std::ffi::OsString>,
    /// The show file to write; '-' is standard output
    #[arg(short, long, value_name = "FILE.show", default_value = "-")]
    output: PathBuf,
}

pub(super) fn run(arguments: ShowArguments) -> anyhow::Result<()> {
    end_by_signals();
    let scenes = arguments.scene.iter().map(scene_of).collect::<anyhow::Result<Vec<_>>>()?;
    let (song, output) = (song_or_demo(arguments.file)?, Output::from(arguments.output));
    let entries = write_show_file(&song, &or_shipped(scenes), &output)?;
    match output {
        Output::Standard => Ok(()),
        Output::Path(path) => Ok(print_line(&format!("{entries} entries in {}", path.display()))?),
    }
}
