//! Access to a scene's folder. A scene can read files only from its own folder.

use mariana_files::reading::read_at_most;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};

/// The extension of scene files.
pub(super) const ENDING: &str = "scene";

/// The reason why a scene cannot read a file. The reason follows the words "`name` cannot be ...: ".
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum Refusal {
    #[error("the path leaves the scene's folder")]
    Leaves,
    #[error("it is a link that leads out of the scene's folder")]
    LinkOut,
    #[error("there is no such file in the scene's folder")]
    Missing,
    #[error("it is not a file")]
    NoFile,
    #[error("the system reports: {0}")]
    Unreadable(String),
    #[error("it is larger than {0} bytes")]
    TooLarge(usize),
    #[error("it is not text: byte {0} is not UTF-8")]
    NotText(usize),
}

#[derive(Debug, Clone)]
pub(super) struct Folder(PathBuf);

/// Maximum number of folder entries to search for a suggestion.
const ENTRIES_MAX: usize = 10_000;

impl Folder {
    pub(super) fn of(scene: &Path) -> Self {
        Self(scene.parent().map_or_else(PathBuf::new, Path::to_owned))
    }

    /// Joins `name` to the folder, without resolving links.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(super) fn bytes(&self, name: &str, max: usize) -> Result<Vec<u8>, Refusal> {
        // Check before opening: opening a pipe blocks until another program writes to it.
        read_at_most(&self.file(name)?, max).map_err(refused)?.ok_or(Refusal::TooLarge(max))
    }

    /// Returns the path of a file, with links resolved.
    pub(super) fn file(&self, name: &str) -> Result<PathBuf, Refusal> {
        let path = self.inside(name)?;
        if fs::metadata(&path).map_err(refused)?.is_file() { Ok(path) } else { Err(Refusal::NoFile) }
    }

    pub(super) fn text(&self, name: &str, max: usize) -> Result<String, Refusal> {
        Self::text_of(self.bytes(name, max)?)
    }

    pub(super) fn text_of(bytes: Vec<u8>) -> Result<String, Refusal> {
        String::from_utf8(bytes).map_err(|error| Refusal::NotText(error.utf8_error().valid_up_to()))
    }

    /// Returns the files in the same folder as `name`, with the same prefix. Skips names that are not UTF-8.
    pub(super) fn beside(&self, name: &str) -> Vec<String> {
        let (prefix, folder) = match name.rsplit_once('/') {
            Some((folder, _)) => (format!("{folder}/"), self.inside(folder)),
            None => (String::new(), Ok(self.opened().to_owned())),
        };
        let entries = folder.ok().and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten();
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        names.take(ENTRIES_MAX).map(|found| format!("{prefix}{found}")).collect()
    }

    /// Resolves links in `name`. Fails if the result is outside the folder.
    fn inside(&self, name: &str) -> Result<PathBuf, Refusal> {
        if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(Refusal::Leaves);
        }
        let missing = |error: io::Error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Refusal::Missing,
            _ => Refusal::Unreadable(error.to_string()),
        };
        let folder = self.opened().canonicalize().map_err(missing)?;
        let path = folder.join(name).canonicalize().map_err(missing)?;
        if path.starts_with(&folder) { Ok(path) } else { Err(Refusal::LinkOut) }
    }

    /// Returns the folder's path, or `.` for an empty path, which means the current folder.
    fn opened(&self) -> &Path {
        if self.0.as_os_str().is_empty() { Path::new(".") } else { &self.0 }
    }
}

/// True if the name has one of these endings, in any case.
pub(super) fn ends_with_one_of(name: &str, endings: &[&str]) -> bool {
    name.rsplit_once('.').is_some_and(|(_, end)| endings.iter().any(|known| end.eq_ignore_ascii_case(known)))
}

fn refused(error: io::Error) -> Refusal {
    Refusal::Unreadable(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (tempfile::TempDir, Folder) {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir_all(place.path().join("in/sub")).unwrap();
        fs::write(place.path().join("outside"), "secret").unwrap();
        fs::write(place.path().join("in/sub/part"), "part").unwrap();
        let folder = Folder::of(&place.path().join("in/main.scene"));
        (place, folder)
    }

    #[test]
    fn each_refusal_has_its_own_reason() {
        let (place, folder) = folder();
        assert_eq!(folder.bytes("sub/part", 4), Ok(b"part".to_vec()));
        assert_eq!(folder.bytes("sub/part", 3), Err(Refusal::TooLarge(3)));
        assert_eq!(folder.bytes("sub/none", 4), Err(Refusal::Missing));
        assert_eq!(folder.bytes("sub/part/none", 4), Err(Refusal::Missing));
        assert_eq!(folder.bytes("sub", 4), Err(Refusal::NoFile));
        assert_eq!(folder.bytes("../outside", 9), Err(Refusal::Leaves));
        assert_eq!(folder.bytes(place.path().join("outside").to_str().unwrap(), 9), Err(Refusal::Leaves));
        fs::write(place.path().join("in/latin"), [b'a', 0xe4]).unwrap();
        assert_eq!(folder.text("latin", 9), Err(Refusal::NotText(1)));
    }

    #[cfg(unix)]
    #[test]
    fn links_may_point_within_the_folder_but_not_out_of_it() {
        use std::os::unix::fs::symlink;
        let (place, folder) = folder();
        let link = |from: &str, to: &str| symlink(to, place.path().join("in").join(from)).unwrap();
        link("near", "sub/part");
        link("far", "../outside");
        link("up", "..");
        link("round", "round");
        assert_eq!(folder.text("near", 9), Ok("part".to_owned()));
        assert_eq!(folder.text("far", 9), Err(Refusal::LinkOut));
        assert_eq!(folder.text("up/outside", 9), Err(Refusal::LinkOut));
        assert_eq!(folder.text("up/in/sub/part", 9), Ok("part".to_owned()));
        assert!(matches!(folder.text("round", 9), Err(Refusal::Unreadable(_))));
        assert_eq!(folder.beside("up/x"), [""; 0]);
        assert_eq!(folder.beside("sub/x"), ["sub/part"]);
    }

    /// Tests run in the package's folder.
    #[test]
    fn a_bare_name_is_in_the_current_folder() {
        let folder = Folder::of(Path::new("bare.scene"));
        assert_eq!(folder.path("Cargo.toml"), Path::new("Cargo.toml"));
        assert!(folder.bytes("Cargo.toml", 1 << 20).is_ok());
        assert!(folder.beside("").contains(&"Cargo.toml".to_owned()));
        assert!(folder.beside("src/x").contains(&"src/lib.rs".to_owned()));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_is_refused_without_waiting() {
        let (place, folder) = folder();
        let pipe = place.path().join("in/pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert_eq!(folder.bytes("pipe", 9), Err(Refusal::NoFile));
    }
}
