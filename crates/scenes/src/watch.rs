//! Watches a set of files for changes.
//!
//! Editors save in several ways: they write the file in place, rename another file over it, or first move or delete
//! the old file. A watch on a file would stay with the old file. [`Watch`] therefore watches the folders and reports
//! only events of the wanted files. If a folder is missing, its nearest existing parent is watched. For a link, the
//! folder of its target is watched as well.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mariana_work::lock;
use notify::event::{AccessKind, AccessMode, CreateKind, ModifyKind, RemoveKind};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

/// State shared with the thread that receives the events.
#[derive(Debug, Default)]
struct Wanted {
    /// The key is a path that an event may contain. The value is the wanted files that this event affects.
    files: HashMap<PathBuf, BTreeSet<PathBuf>>,
    /// Paths that were deleted or moved. Their watches are gone even if the path now has a folder with the same
    /// identity, because the system reuses the inode numbers of deleted folders.
    lost: BTreeSet<PathBuf>,
}

pub(super) struct Watch {
    watcher: Option<RecommendedWatcher>,
    /// Watched folders with their identities, to detect a replaced folder.
    folders: BTreeMap<PathBuf, Identity>,
    wanted: Arc<Mutex<Wanted>>,
    /// True if every relevant folder is watched.
    pub(super) complete: bool,
    /// True if the log already has a warning about missing watches.
    reported: bool,
}

/// Receives a file that may have changed, and the kind of the change.
pub(super) type Tell = Box<dyn Fn(PathBuf, Kind) + Send>;

/// Device and inode number of a folder; `None` on systems without them.
type Identity = Option<(u64, u64)>;

const LINKS_MAX: usize = 16;

impl Watch {
    /// Creates a watch without files. On its own thread, the watch calls `tell` with the path of each file that may
    /// have changed, as passed to [`Self::set`].
    pub(super) fn new(tell: Tell) -> Self {
        let mut watch = Self::blind();
        let known = Arc::clone(&watch.wanted);
        match notify::recommended_watcher(move |event| sort(event, &known, &tell)) {
            Ok(watcher) => watch.watcher = Some(watcher),
            Err(error) => watch.report_blindness(&error.to_string()),
        }
        watch
    }

    /// Creates a watch without events, as when the system has no watches left.
    pub(super) fn blind() -> Self {
        let wanted = Arc::new(Mutex::new(Wanted::default()));
        Self { watcher: None, folders: BTreeMap::new(), wanted, complete: false, reported: false }
    }

    /// Watches these files and no others. Call this again after each reported change, because folders may have
    /// been created, removed or replaced.
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
        // Set the files before watching the folders, so that no event of a new folder is discarded.
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
                // The call fails for a deleted folder, because its watch is gone already.
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
            self.report_blindness(&error.to_string());
        }
    }

    fn report_blindness(&mut self, reason: &str) {
        if !std::mem::replace(&mut self.reported, true) {
            tracing::warn!(
                "the system does not report changed scenes ({reason}): Mariana checks the files repeatedly instead"
            );
        }
    }
}

/// Reports the wanted files that an event affects.
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
        // Events were lost, so any file may have changed.
        _ => {
            let all: BTreeSet<PathBuf> = lock(wanted).files.values().flatten().cloned().collect();
            all.into_iter().map(|file| (file, Kind::Touched)).collect::<Vec<_>>()
        }
    };
    for (file, kind) in files {
        tell(file, kind);
    }
}

/// Returns the kind of change; `None` for read accesses.
fn kind(event: &EventKind) -> Option<Kind> {
    match event {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => Some(Kind::Written),
        EventKind::Access(_) => None,
        // Other systems do not report the closing of a file.
        EventKind::Modify(ModifyKind::Data(_)) if cfg!(target_os = "linux") => Some(Kind::Writing),
        EventKind::Modify(ModifyKind::Name(_))
        | EventKind::Create(CreateKind::File)
        | EventKind::Remove(RemoveKind::File) => Some(Kind::Written),
        _ => Some(Kind::Touched),
    }
}

/// Returns the folders in which changes of `file` appear, each with the entry that changes. A link has several folders.
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

/// Returns the nearest existing folder above `path`, with links resolved, and the entry in it that leads to `path`.
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

// Decides when changed files should be read: after writers have finished. Callers pass the present time.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A program has opened the file for writing and has not closed the file yet.
    Writing,
    /// The file was closed after writing, replaced or removed.
    Written,
    /// Any other event.
    Touched,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Waits {
    /// Time without events before the files are read.
    pub quiet: Duration,
    /// Maximum delay of a read while events continue, a writer has the file open, or a file is missing.
    pub patience: Duration,
    /// Interval of the checks that need no event, because events are lost if a parent folder was replaced or the file
    /// is on a network.
    pub look: Duration,
    /// Interval of checks on systems without events.
    pub look_blind: Duration,
}

impl Waits {
    pub(super) const USUAL: Self = Self {
        quiet: Duration::from_millis(20),
        patience: Duration::from_millis(400),
        look: Duration::from_secs(2),
        look_blind: Duration::from_millis(200),
    };
}

#[derive(Debug, Default)]
pub(super) struct Changes {
    touched: BTreeSet<PathBuf>,
    writing: BTreeSet<PathBuf>,
    first: Option<Instant>,
    last: Option<Instant>,
}

impl Changes {
    pub(super) fn record(&mut self, file: PathBuf, kind: Kind, now: Instant) {
        match kind {
            Kind::Writing => {
                self.writing.insert(file.clone());
            }
            Kind::Written => {
                self.writing.remove(&file);
            }
            Kind::Touched => {}
        }
        self.touched.insert(file);
        self.first.get_or_insert(now);
        self.last = Some(now);
    }

    /// Returns the time at which to read the files; `None` if nothing has changed.
    pub(super) fn due(&self, waits: &Waits) -> Option<Instant> {
        let latest = self.first? + waits.patience;
        if !self.writing.is_empty() {
            return Some(latest);
        }
        Some(latest.min(self.last? + waits.quiet))
    }

    pub(super) fn drain(&mut self) -> BTreeSet<PathBuf> {
        std::mem::take(self).touched
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;

    /// The system sends no event when a parent folder is replaced; the next call must notice it.
    #[test]
    fn setting_the_files_again_watches_a_replaced_folder() {
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
        assert!(watch.complete);
        fs::write(&file, "new").unwrap();
        assert_eq!(reported.recv_timeout(Duration::from_secs(10)), Ok(file));
    }

    #[test]
    fn link_targets_and_missing_files_have_watchable_folders() {
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

#[cfg(test)]
mod debounce_tests {
    use super::*;

    const WAITS: Waits = Waits::USUAL;

    fn after(changes: &[(u64, Kind)]) -> Option<Duration> {
        let start = Instant::now();
        let mut list = Changes::default();
        for (milliseconds, kind) in changes {
            list.record("file".into(), *kind, start + Duration::from_millis(*milliseconds));
        }
        list.due(&WAITS).map(|due| due - start)
    }

    #[test]
    fn files_are_read_when_they_are_quiet() {
        assert_eq!(after(&[]), None);
        assert_eq!(after(&[(0, Kind::Touched)]), Some(WAITS.quiet));
        let ten = Duration::from_millis(10);
        assert_eq!(after(&[(0, Kind::Touched), (10, Kind::Touched)]), Some(WAITS.quiet + ten));
    }

    #[test]
    fn open_writers_delay_reading_but_not_for_ever() {
        assert_eq!(after(&[(0, Kind::Writing)]), Some(WAITS.patience));
        assert_eq!(after(&[(0, Kind::Writing), (10, Kind::Touched)]), Some(WAITS.patience));
        let hundred = Duration::from_millis(100);
        assert_eq!(after(&[(0, Kind::Writing), (100, Kind::Written)]), Some(WAITS.quiet + hundred));
        let endless: Vec<(u64, Kind)> = (0..1000).map(|i| (i, Kind::Touched)).collect();
        assert_eq!(after(&endless), Some(WAITS.patience));
    }

    #[test]
    fn taken_changes_are_cleared() {
        let mut list = Changes::default();
        list.record("a".into(), Kind::Writing, Instant::now());
        list.record("b".into(), Kind::Touched, Instant::now());
        assert_eq!(list.drain(), ["a".into(), "b".into()].into());
        assert_eq!(list.due(&WAITS), None);
        assert_eq!(list.drain(), [].into());
    }
}
