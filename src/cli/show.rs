//! The subcommand `show`, and the flag `--show` of other subcommands.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use super::common::end_by_signals;
use super::files::{scene_of, song_or_demo};
use crate::config::FollowChoice;
use crate::export::show_file::{ShowFileRequest, write_show_file};
use crate::export::{Output, Showing, print_line};
use crate::scenes::{SceneSource, shipped_names};
use crate::show::ShowSource;

/// The value of `--show`; `None` for `off`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ShowChoice(Option<ShowSource>);

const AUTO: &str = "auto";
const DEMO: &str = "demo";
const OFF: &str = "off";

impl FromStr for ShowChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(match text {
            OFF => None,
            AUTO => Some(ShowSource::Auto),
            DEMO => Some(ShowSource::Demo),
            file => Some(ShowSource::File(PathBuf::from(file))),
        }))
    }
}

impl ShowChoice {
    /// Returns the show for an export; `None` for `off`. The director chooses among `scenes`, or among the shipped
    /// scenes if `scenes` is empty.
    pub(super) fn showing(self, scenes: Vec<SceneSource>) -> Option<Showing> {
        Some(Showing::Show(self.0?, or_shipped(scenes)))
    }

    pub(super) fn is_on(&self) -> bool {
        self.0.is_some()
    }

    pub(super) fn follow(&self) -> FollowChoice {
        if self.is_on() { FollowChoice::On } else { FollowChoice::Off }
    }

    pub(super) fn into_named(self) -> Option<ShowSource> {
        self.0.filter(|source| *source != ShowSource::Auto)
    }
}

fn or_shipped(scenes: Vec<SceneSource>) -> Vec<SceneSource> {
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
    let request = ShowFileRequest {
        song: song_or_demo(arguments.file)?,
        scenes: or_shipped(scenes),
        output: Output::from(arguments.output),
    };
    let entries = write_show_file(&request)?;
    match &request.output {
        Output::Standard => Ok(()),
        Output::Path(path) => Ok(print_line(&format!("{entries} entries in {}", path.display()))?),
    }
}
