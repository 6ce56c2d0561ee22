//! Reports changes of some files.
//!
//! Editors save in many ways: into the file, by a rename over it, by moving it aside and writing another, by deleting
//! it first. A watch on the file itself would stay with the old file, so the folders are watched, and only the events
//! that concern the files are reported. If a folder is missing, the one above it is watched; if a file is a link, the
//! folder that the link leads to is watched too.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use notify::event::{AccessKind, AccessMode, CreateKind, ModifyKind, RemoveKind};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use super::debounce::Kind;

/// What the thread that receives the events needs to know, and what it found out.
#[derive(Debug, Default)]
struct Wanted {
    /// From the path that an event names to the files that it concerns.
    files: HashMap<PathBuf, BTreeSet<PathBuf>>,
    /// Paths that were deleted or moved: no folder there is watched any more, even if there is one of the same
    /// identity (the inode numbers of deleted folders are used again).
    lost: BTreeSet<PathBuf>,
}

/// A watch on some files.
pub(super) struct Watch {
    watcher: Option<RecommendedWatcher>,
    /// Folders that are watched, with their identities: another folder may have taken the place since.
    folders: BTreeMap<PathBuf, Identity>,
    wanted: Arc<Mutex<Wanted>>,
    /// Whether every relevant folder is watched.
    complete: bool,
    /// Whether the log already says that they are not.
    reported: bool,
}

/// Receives a file that may have changed, and what is known about the change.
pub(super) type Tell = Box<dyn Fn(PathBuf, Kind) + Send>;

/// What distinguishes folders of the same path, if the system has such a thing.
type Identity = Option<(u64, u64)>;

/// Most links that are followed from one file.
const LINKS_MAX: usize = 16;

impl Watch {
    /// Watches nothing yet. `tell` is called on a thread of the watch with a file that may have changed, named as it
    /// was given to [`Self::set`].
    pub(super) fn new(tell: Tell) -> Self {
        let mut watch = Self::blind();
        let known = Arc::clone(&watch.wanted);
        match notify::recommended_watcher(move |event| sort(event, &known, &tell)) {
            Ok(watcher) => watch.watcher = Some(watcher),
            Err(error) => watch.tell_blindness(&error.to_string()),
        }
        watch
    }

    /// A watch that reports nothing, as when the system has no watches left.
    pub(super) fn blind() -> Self {
        let wanted = Arc::new(Mutex::new(Wanted::default()));
        Self { watcher: None, folders: BTreeMap::new(), wanted, complete: false, reported: false }
    }

    /// Watches these files and no others. To be called again after each reported change, because folders may have
    /// come, gone, or been replaced.
    pub(super) fn set(&mut self, files: &[PathBuf]) {
        let mut wanted: HashMap<PathBuf, BTreeSet<PathBuf>> = HashMap::new();
        let mut folders = BTreeSet::new();
        for file in files {
            for (folder, name) in places(file) {
                for path in [folder.join(name), folder.clone()] {
                    wanted.entry(path).or_default().insert(file.clone());
                }
                folders.insert(folder);
            }
        }
        // Before the folders, so that nothing that they report is thrown away.
        let lost = {
            let mut shared = lock(&self.wanted);
            shared.files = wanted;
            std::mem::take(&mut shared.lost)
        };
        let Some(watcher) = &mut self.watcher else { return };
        self.folders.retain(|folder, identity| {
            let same = !lost.contains(folder) && *identity == self::identity(folder);
            let kept = same && folders.contains(folder);
            if !kept {
                // A folder that was deleted is not watched any more, which is no error.
                let _ = watcher.unwatch(folder);
            }
            kept
        });
        let mut refused = None;
        self.complete = true;
        for folder in folders {
            if self.folders.contains_key(&folder) {
                continue;
            }
            let identity = identity(&folder);
            match watcher.watch(&folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    self.folders.insert(folder, identity);
                }
                Err(error) => {
                    self.complete = false;
                    refused = Some(error).filter(|_| folder.is_dir()).or(refused);
                }
            }
        }
        if let Some(error) = refused {
            self.tell_blindness(&error.to_string());
        }
    }

    /// Whether the system reports every change; if not, the caller has to look.
    pub(super) fn is_complete(&self) -> bool {
        self.complete
    }

    fn tell_blindness(&mut self, reason: &str) {
        if !std::mem::replace(&mut self.reported, true) {
            tracing::warn!(
                "the system does not report changed scenes ({reason}): they are checked repeatedly instead"
            );
        }
    }
}

fn lock(wanted: &Mutex<Wanted>) -> MutexGuard<'_, Wanted> {
    wanted.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Reports what an event means for the wanted files.
fn sort(event: notify::Result<Event>, wanted: &Mutex<Wanted>, tell: &Tell) {
    let files = match &event {
        Ok(event) if !event.need_rescan() => {
            let Some(kind) = kind(&event.kind) else { return };
            let mut wanted = lock(wanted);
            if matches!(event.kind, EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_))) {
                let known = event.paths.iter().filter(|path| wanted.files.contains_key(*path));
                let lost: Vec<PathBuf> = known.cloned().collect();
                wanted.lost.extend(lost);
            }
            let concerned = event.paths.iter().filter_map(|path| wanted.files.get(path)).flatten();
            concerned.map(|file| (file.clone(), kind)).collect()
        }
        // Events were lost: any file may have changed.
        _ => {
            let all: BTreeSet<PathBuf> = lock(wanted).files.values().flatten().cloned().collect();
            all.into_iter().map(|file| (file, Kind::Touched)).collect::<Vec<_>>()
        }
    };
    for (file, kind) in files {
        tell(file, kind);
    }
}

/// What an event says about its file; none if it is only being read.
fn kind(event: &EventKind) -> Option<Kind> {
    match event {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => Some(Kind::Written),
        EventKind::Access(_) => None,
        // Other systems do not report when the file is closed.
        EventKind::Modify(ModifyKind::Data(_)) if cfg!(target_os = "linux") => Some(Kind::Writing),
        EventKind::Modify(ModifyKind::Name(_))
        | EventKind::Create(CreateKind::File)
        | EventKind::Remove(RemoveKind::File) => Some(Kind::Written),
        _ => Some(Kind::Touched),
    }
}

/// Where a change of `file` shows: existing folders, each with the relevant entry. More than one if the file is a
/// link.
fn places(file: &Path) -> Vec<(PathBuf, OsString)> {
    let mut found = Vec::new();
    let Ok(mut path) = std::path::absolute(file) else { return found };
    for _ in 0..LINKS_MAX {
        let Some(place) = place(&path) else { break };
        found.push(place);
        let (Some(folder), Ok(target)) = (path.parent(), fs::read_link(&path)) else { break };
        path = folder.join(target);
    }
    found
}

/// The nearest folder above `path` that exists, with links resolved, and the entry of it that `path` passes through.
fn place(path: &Path) -> Option<(PathBuf, OsString)> {
    path.ancestors().find_map(|entry| {
        let folder = entry.parent()?.canonicalize().ok().filter(|folder| folder.is_dir())?;
        Some((folder, entry.file_name()?.to_owned()))
    })
}

#[cfg(unix)]
fn identity(folder: &Path) -> Identity {
    use std::os::unix::fs::MetadataExt;
    let metadata = fs::metadata(folder).ok()?;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn identity(_folder: &Path) -> Identity {
    None
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;

    /// No event reports that a folder further up was replaced; the next call must find out.
    #[test]
    fn setting_the_files_again_watches_a_folder_that_took_the_place_of_another() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        for folder in ["a/b", "next/b"] {
            fs::create_dir_all(path(folder)).unwrap();
        }
        let (tell, reported) = channel();
        let mut watch = Watch::new(Box::new(move |file, _| tell.send(file).unwrap_or_default()));
        let file = path("a/b/file");
        watch.set(std::slice::from_ref(&file));
        fs::rename(path("a"), path("aside")).unwrap();
        fs::rename(path("next"), path("a")).unwrap();
        watch.set(std::slice::from_ref(&file));
        assert!(watch.is_complete());
        fs::write(&file, "new").unwrap();
        assert_eq!(reported.recv_timeout(Duration::from_secs(10)), Ok(file));
    }

    #[test]
    fn a_file_is_looked_for_where_links_lead_and_where_it_would_be() {
        let place = tempfile::tempdir().unwrap();
        let real = place.path().canonicalize().unwrap();
        let places = |name: &str| super::places(&place.path().join(name));
        assert_eq!(places("file"), [(real.clone(), "file".into())]);
        assert_eq!(places("no/such/file"), [(real.clone(), "no".into())]);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("no/file", place.path().join("link")).unwrap();
            std::os::unix::fs::symlink("round", place.path().join("round")).unwrap();
            assert_eq!(places("link"), [(real.clone(), "link".into()), (real.clone(), "no".into())]);
            assert_eq!(places("round").len(), LINKS_MAX);
        }
        assert_eq!(super::places(Path::new("bare")).len(), 1);
    }
}
