//! Reads folders on threads. Each folder has its own thread, so that a folder that does not answer, such as one on a
//! lost network disk, does not delay the next folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use directories::UserDirs;
use mariana_player::playlist::{AUDIO_EXTENSIONS, Kind, compare_names};
use mariana_scenes::{is_scene_file, is_shader_file};
use mariana_work::{Awaited, once};

use super::{FileEntry, FileKind, Place, PlaceKind};
use crate::limits;

pub(super) type Listing = Result<Vec<FileEntry>, String>;

pub(super) enum Answer {
    Folder(PathBuf, Listing),
    /// The folders that the system provides.
    Places(Vec<Place>),
}

pub(super) struct FolderReader {
    read: Arc<dyn Fn(&Path) -> Listing + Send + Sync>,
    wake: Arc<dyn Fn() + Send + Sync>,
    /// The answers of the threads that are reading.
    open: Vec<Awaited<Answer>>,
    /// The answers that have come.
    come: Vec<Answer>,
}

impl FolderReader {
    pub(super) fn new(
        read: impl Fn(&Path) -> Listing + Send + Sync + 'static,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        Self { read: Arc::new(read), wake: Arc::new(wake), open: Vec::new(), come: Vec::new() }
    }

    /// Reads a folder. Fails if too many folders do not answer, or without threads.
    pub(super) fn request(&mut self, folder: PathBuf) -> Result<(), String> {
        self.collect();
        if self.open.len() >= limits::FOLDERS_READ_MAX {
            return Err("several folders do not answer: check the disks and the network".to_owned());
        }
        let read = self.read.clone();
        self.start(move || {
            let listing = read(&folder);
            Answer::Folder(folder, listing)
        })
    }

    /// Returns the answers that have come.
    pub(super) fn answers(&mut self) -> Vec<Answer> {
        self.collect();
        std::mem::take(&mut self.come)
    }

    fn collect(&mut self) {
        self.come.extend(self.open.iter_mut().filter_map(|one| one.poll()?.ok()));
        self.open.retain(Awaited::is_awaited);
    }

    pub(super) fn start(&mut self, work: impl FnOnce() -> Answer + Send + 'static) -> Result<(), String> {
        let wake = self.wake.clone();
        let started = once("folder", move || wake(), work);
        self.open.push(
            started
                .map_err(|error| format!("the system starts no thread ({error}): close other programs"))?,
        );
        Ok(())
    }
}

/// The visible entries of a folder: folders, then music, lists and scenes, then other files, each in natural order.
pub(super) fn entries_of(folder: &Path) -> Listing {
    let listing = fs::read_dir(folder).map_err(|error| error.to_string())?;
    let mut entries: Vec<FileEntry> =
        listing.flatten().take(limits::FOLDER_ENTRIES_MAX).filter_map(|entry| entry_of(&entry)).collect();
    let rank = |kind| match kind {
        FileKind::Folder => 0,
        FileKind::Music | FileKind::List | FileKind::Scene => 1,
        FileKind::Other => 2,
    };
    entries.sort_by(|a, b| rank(a.kind).cmp(&rank(b.kind)).then_with(|| compare_names(&a.name, &b.name)));
    Ok(entries)
}

fn entry_of(entry: &fs::DirEntry) -> Option<FileEntry> {
    let name = entry.file_name().to_string_lossy().replace(char::is_control, " ");
    if name.starts_with('.') {
        return None;
    }
    let path = entry.path();
    // Only links need a second look, which is slow on a network disk.
    let kind = entry.file_type().ok()?;
    let is_folder = if kind.is_symlink() { path.is_dir() } else { kind.is_dir() };
    Some(FileEntry { name, kind: kind_of(&path, is_folder), path })
}

fn kind_of(path: &Path, is_folder: bool) -> FileKind {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if is_folder {
        FileKind::Folder
    } else if AUDIO_EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        FileKind::Music
    } else if Kind::of(path).is_some() {
        FileKind::List
    } else if is_scene_file(path) || is_shader_file(path) {
        FileKind::Scene
    } else {
        FileKind::Other
    }
}

pub(super) fn common_places() -> Vec<Place> {
    let user = UserDirs::new();
    let home = user.as_ref().map(|user| user.home_dir().to_owned());
    let here = std::env::current_dir().ok();
    let root = here.as_ref().and_then(|here| here.ancestors().last().map(Path::to_owned));
    let folder = |folder: fn(&UserDirs) -> Option<&Path>| user.as_ref().and_then(folder).map(Path::to_owned);
    let all = [
        ("Music", folder(UserDirs::audio_dir)),
        ("Home", home.clone()),
        ("Downloads", folder(UserDirs::download_dir)),
        ("Desktop", folder(UserDirs::desktop_dir)),
        ("Here", here),
        ("Computer", root),
    ];
    let mut places: Vec<Place> = Vec::new();
    for (name, path) in all {
        let Some(path) = path.filter(|path| path.is_dir()) else { continue };
        if !places.iter().any(|place| place.path == path) {
            places.push(Place { name: name.to_owned(), path, kind: PlaceKind::Common });
        }
    }
    places.extend(media(home.as_deref()));
    places
}

/// The folders in which desktops mount disks. The disks themselves are not touched, because they may be slow.
fn media(home: Option<&Path>) -> Vec<Place> {
    let user = home.and_then(Path::file_name).unwrap_or_default();
    let above = ["/run/media", "/media"].map(|above| Path::new(above).join(user));
    let folders = above.into_iter().chain(["/media", "/mnt", "/Volumes"].map(PathBuf::from));
    let mut places: Vec<Place> = Vec::new();
    for folder in folders {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten().take(limits::MEDIA_PLACES_MAX) {
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            let (path, name) = (entry.path(), entry.file_name());
            let is_new = name != user && !places.iter().any(|place| place.path == path);
            let name = name.to_string_lossy().replace(char::is_control, " ");
            if is_folder && is_new && !name.starts_with('.') {
                places.push(Place { name, path, kind: PlaceKind::Media });
            }
        }
    }
    places.truncate(limits::MEDIA_PLACES_MAX);
    places
}
