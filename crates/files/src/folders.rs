//! Paths of the user's folders, and of the program.

use std::path::{Path, PathBuf};

use directories::ProjectDirs;

/// See the module. `None` where the system has no such place: then nothing is kept there.
#[derive(Debug, Clone, Default)]
pub struct Folders {
    /// Settings and mappings.
    pub config: Option<PathBuf>,
    /// What can be made again.
    pub cache: Option<PathBuf>,
    /// What the user has made.
    pub data: Option<PathBuf>,
    /// What was not saved.
    pub state: Option<PathBuf>,
    /// In builds for tests, a folder that stands for the ports of MIDI devices; the system's ports otherwise.
    pub midi_ports: Option<PathBuf>,
    /// The program that draws thumbnails; `None` for the one that runs.
    pub program: Option<PathBuf>,
}

impl Folders {
    /// Those of the user who runs the program. `MARIANA_MIDI_FOLDER` names the folder for ports.
    pub fn of_user() -> Self {
        let Some(places) = ProjectDirs::from("", "", "mariana") else { return Self::default() };
        Self {
            config: Some(places.config_dir().to_owned()),
            cache: Some(places.cache_dir().to_owned()),
            data: Some(places.data_dir().to_owned()),
            state: Some(places.state_dir().unwrap_or(places.data_local_dir()).to_owned()),
            midi_ports: std::env::var_os("MARIANA_MIDI_FOLDER").map(PathBuf::from),
            program: None,
        }
    }

    /// Folders within another one. The ports are the system's.
    pub fn within(folder: &Path) -> Self {
        let part = |name: &str| Some(folder.join(name));
        Self {
            config: part("config"),
            cache: part("cache"),
            data: part("data"),
            state: part("state"),
            midi_ports: None,
            program: None,
        }
    }
}
