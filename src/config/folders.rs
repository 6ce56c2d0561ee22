//! The folders in which the program keeps things of its user.

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
}

impl Folders {
    /// Those of the user who runs the program.
    pub fn of_user() -> Self {
        let Some(places) = ProjectDirs::from("", "", "mariana") else { return Self::default() };
        Self {
            config: Some(places.config_dir().to_owned()),
            cache: Some(places.cache_dir().to_owned()),
            data: Some(places.data_dir().to_owned()),
            state: Some(places.state_dir().unwrap_or(places.data_local_dir()).to_owned()),
        }
    }

    /// Folders within another one.
    pub fn within(folder: &Path) -> Self {
        let part = |name: &str| Some(folder.join(name));
        Self { config: part("config"), cache: part("cache"), data: part("data"), state: part("state") }
    }
}
