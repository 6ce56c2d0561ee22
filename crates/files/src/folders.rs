use std::path::{Path, PathBuf};

use directories::{ProjectDirs, UserDirs};

/// Paths of the user's folders and of the program. A path is `None` if the system has no such folder. Mariana then
/// stores no files of that kind.
#[derive(Debug, Clone, Default)]
pub struct Folders {
    /// Settings and mappings.
    pub config: Option<PathBuf>,
    /// Files that can be made again.
    pub cache: Option<PathBuf>,
    /// Files that the user has made.
    pub data: Option<PathBuf>,
    /// Pictures that the user has taken.
    pub pictures: Option<PathBuf>,
    /// Videos that the user has made.
    pub videos: Option<PathBuf>,
    /// Backups of unsaved texts, and the queue of videos.
    pub state: Option<PathBuf>,
    /// In test builds, a folder that replaces the MIDI ports; `None` for the system's ports.
    pub midi_ports: Option<PathBuf>,
    /// The program that draws thumbnails; `None` for the running program.
    pub program: Option<PathBuf>,
}

impl Folders {
    /// Folders of the user who runs the program. `MARIANA_MIDI_FOLDER` sets [`Self::midi_ports`].
    pub fn of_user() -> Self {
        let Some(places) = ProjectDirs::from("", "", "mariana") else { return Self::default() };
        let user = UserDirs::new();
        // A system without desktop names no folders for pictures and videos.
        let of_kind = |named: fn(&UserDirs) -> Option<&Path>, usual: &str| {
            let user = user.as_ref()?;
            let folder = named(user).map_or_else(|| user.home_dir().join(usual), Path::to_owned);
            Some(folder.join("Mariana"))
        };
        Self {
            pictures: of_kind(UserDirs::picture_dir, "Pictures"),
            videos: of_kind(UserDirs::video_dir, "Videos"),
            config: Some(places.config_dir().to_owned()),
            cache: Some(places.cache_dir().to_owned()),
            data: Some(places.data_dir().to_owned()),
            state: Some(places.state_dir().unwrap_or(places.data_local_dir()).to_owned()),
            midi_ports: std::env::var_os("MARIANA_MIDI_FOLDER").map(PathBuf::from),
            program: None,
        }
    }

    /// The folder of the scenes that the user has made.
    pub fn own_scenes(&self) -> Option<PathBuf> {
        self.data.as_ref().map(|data| data.join("scenes"))
    }

    /// Returns subfolders of `folder`. Uses the system's MIDI ports.
    pub fn within(folder: &Path) -> Self {
        let part = |name: &str| Some(folder.join(name));
        Self {
            config: part("config"),
            cache: part("cache"),
            data: part("data"),
            pictures: part("pictures"),
            videos: part("videos"),
            state: part("state"),
            midi_ports: None,
            program: None,
        }
    }
}
