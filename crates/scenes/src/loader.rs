//! Loads scenes on a background thread, and loads a scene again when its files change.
//!
//! The loader passes finished values to the show, so a large or broken scene delays no frame. It watches folders
//! instead of files, because most editors save by replacing the file.
//!
//! A file counts as changed when its bytes differ from the loaded bytes. A save without changes does not reload the
//! scene, and two events of one save reload the scene once. A file is read 20 ms after its last event, but not while
//! its writer has it open. The loader waits for a missing file for at most 400 ms, because some editors delete a file
//! before they write a new one. Every two seconds the loader checks all files, because replaced parent folders and
//! files on a network cause no events. If the system has no watches left, the loader checks five times a second.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, TryLockError};
use std::time::{Duration, Instant, SystemTime};
use std::{fs, io};

use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_files::reading::read_at_most;
use mariana_work::{Background, lock};

use super::SceneSource;
use super::watch::{Changes, Kind, Tell, Waits, Watch};
use crate::limits;

/// The result of loading a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loaded<T> {
    /// The loaded source.
    pub source: SceneSource,
    /// The value that the load function returned.
    pub value: T,
    /// The files that are watched for this source.
    pub files: Vec<PathBuf>,
    /// Duration of the load function.
    pub took: Duration,
}

/// A thread that loads one source at a time and watches its files. Dropping this ends the thread after the current
/// load, without waiting. No result is published after the drop.
#[derive(Debug)]
pub struct Loader<T> {
    requests: Sender<Message>,
    shared: Arc<Shared<T>>,
}

#[derive(Debug)]
struct Shared<T> {
    newest: Mutex<Option<Loaded<T>>>,
    ended: AtomicBool,
}

enum Message {
    Load(SceneSource),
    Again,
    Changed(PathBuf, Kind),
    End,
}

impl<T: Send + 'static> Loader<T> {
    /// Starts the thread, which waits for the first request. `load` returns a value and the files it depends on,
    /// including missing ones ([`SceneSource::files`]). The thread calls `wake` after each result. A panic in
    /// `load` is logged and gives no result; the files are still watched.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(
        load: impl FnMut(&SceneSource) -> (T, Vec<PathBuf>) + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        Self::start_with(load, wake, Waits::USUAL, Watch::new)
    }

    fn start_with(
        load: impl FnMut(&SceneSource) -> (T, Vec<PathBuf>) + Send + 'static,
        wake: impl Fn() + Send + 'static,
        waits: Waits,
        watch: impl FnOnce(Tell) -> Watch + Send + 'static,
    ) -> io::Result<Self> {
        let (requests, inbox) = channel();
        let shared = Arc::new(Shared { newest: Mutex::new(None), ended: AtomicBool::new(false) });
        let (changes, results) = (requests.clone(), Arc::clone(&shared));
        Background::start("scene loader", move || {
            let watch = watch(Box::new(move |file, kind| {
                // The receiver may be gone at exit.
                let _ = changes.send(Message::Changed(file, kind));
            }));
            let publish = move |loaded| {
                if !results.ended.load(Ordering::Acquire) {
                    // Drop the old value outside the lock, because it may be large.
                    let old = lock(&results.newest).replace(loaded);
                    drop(old);
                    wake();
                }
            };
            let changes = Changes::default();
            Worker { load, publish, watch, waits, changes, current: None, gone_since: None }.run(&inbox);
        })?;
        Ok(Self { requests, shared })
    }

    /// Requests `source`, and watches it instead of the previous source. The request replaces a request that has not
    /// started. A request of the same source loads the source again.
    pub fn request(&self, source: SceneSource) {
        if self.requests.send(Message::Load(source)).is_err() {
            tracing::error!("the thread that loads scenes has ended: this is a bug in Mariana");
        }
    }

    /// Loads the current source again, because a dependency other than its files has changed.
    pub fn load_again(&self) {
        if self.requests.send(Message::Again).is_err() {
            tracing::error!("the thread that loads scenes has ended: this is a bug in Mariana");
        }
    }

    /// Returns the newest result, unless it was returned before. Never blocks.
    pub fn poll(&self) -> Option<Loaded<T>> {
        match self.shared.newest.try_lock() {
            Ok(mut newest) => newest.take(),
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner().take(),
            // The thread is storing the result and calls `wake` afterwards.
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

impl<T> Drop for Loader<T> {
    fn drop(&mut self) {
        self.shared.ended.store(true, Ordering::Release);
        let _ = self.requests.send(Message::End);
    }
}

enum Asked {
    Source(SceneSource),
    Again,
}

/// The current source, and for each of its files the state before the load; `None` if the file may have changed during
/// the load.
struct Current {
    source: SceneSource,
    seen: BTreeMap<PathBuf, Option<Look>>,
}

impl Current {
    fn files(&self) -> Vec<PathBuf> {
        self.seen.keys().cloned().collect()
    }
}

struct Worker<Load, Publish> {
    load: Load,
    publish: Publish,
    watch: Watch,
    waits: Waits,
    changes: Changes,
    current: Option<Current>,
    gone_since: Option<Instant>,
}

/// Maximum lag of a file's modification time behind the clock. File systems use the time of the last kernel tick.
const FILE_CLOCK_STEP: Duration = Duration::from_millis(12);

impl<T, Load, Publish> Worker<Load, Publish>
where
    Load: FnMut(&SceneSource) -> (T, Vec<PathBuf>),
    Publish: Fn(Loaded<T>),
{
    fn run(&mut self, inbox: &Receiver<Message>) {
        let mut asked: Option<Asked> = None;
        let mut looked = Instant::now();
        loop {
            let watching = self.current.as_ref().is_some_and(|current| !current.seen.is_empty());
            let every = if self.watch.complete { self.waits.look } else { self.waits.look_blind };
            let look = watching.then_some(looked + every);
            let given_up = self.gone_since.map(|since| since + self.waits.patience);
            let due = [self.changes.due(&self.waits), given_up, look].into_iter().flatten().min();
            // Handle all messages before due work, so that the last of several requests wins.
            let message = match (&asked, due) {
                (Some(_), _) => inbox.recv_timeout(Duration::ZERO),
                (None, Some(due)) => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
                (None, None) => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match message {
                Ok(Message::Load(source)) => asked = Some(Asked::Source(source)),
                Ok(Message::Again) => asked = asked.or(Some(Asked::Again)),
                Ok(Message::Changed(file, kind)) => self.changes.record(file, kind, Instant::now()),
                Ok(Message::End) | Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => match asked.take() {
                    Some(Asked::Source(source)) => self.begin(source),
                    // The source is the same, so the same files stay watched.
                    Some(Asked::Again) => {
                        if let Some(current) = self.current.take() {
                            self.load(current);
                        }
                    }
                    None => {
                        if look.is_some_and(|look| look <= Instant::now()) {
                            looked = Instant::now();
                            self.check_files();
                        }
                        self.check();
                    }
                },
            }
        }
    }

    /// Loads another source, or the same source from scratch.
    fn begin(&mut self, source: SceneSource) {
        let before = self.current.take().filter(|current| current.source == source);
        let mut files = before.map_or_else(Vec::new, |current| current.files());
        files.extend(source.file().map(PathBuf::from));
        self.watch.set(&files);
        self.changes.drain();
        let seen = files.into_iter().map(|file| (file.clone(), Some(Look::at(&file)))).collect();
        self.load(Current { source, seen });
    }

    /// Finds files that look changed although no event arrived.
    fn check_files(&mut self) {
        let Some(current) = &self.current else { return };
        self.watch.set(&current.files());
        for (file, seen) in &current.seen {
            if seen.as_ref().is_none_or(|seen| seen.stamp != Stamp::of(file)) {
                self.changes.record(file.clone(), Kind::Touched, Instant::now());
            }
        }
    }

    /// Loads the source again if a changed file is due.
    fn check(&mut self) {
        let now = Instant::now();
        let given_up = self.gone_since.is_some_and(|since| since + self.waits.patience <= now);
        let due = self.changes.due(&self.waits).is_some_and(|due| due <= now);
        if !due && !given_up {
            return;
        }
        let mut touched: BTreeSet<PathBuf> = self.changes.drain();
        let Some(mut current) = self.current.take() else { return };
        // Watch the files before reading them, so that a change in between is reported.
        self.watch.set(&current.files());
        if self.gone_since.is_some() {
            // The last check postponed its changes because a file was missing. Check all files again.
            touched.extend(current.seen.keys().cloned());
        }
        let mut changed = BTreeMap::new();
        let mut gone = false;
        for file in touched {
            let Some(seen) = current.seen.get_mut(&file) else { continue };
            let look = Look::at(&file);
            match seen {
                Some(seen) if seen.content == look.content => *seen = look,
                _ => {
                    let was_there = |seen: &Look| look.content.is_gone_since(&seen.content);
                    gone |= seen.as_ref().is_some_and(was_there);
                    changed.insert(file, Some(look));
                }
            }
        }
        if gone && !given_up {
            self.gone_since.get_or_insert(now);
            self.current = Some(current);
        } else if changed.is_empty() {
            self.gone_since = None;
            self.current = Some(current);
        } else {
            current.seen.extend(changed);
            self.load(current);
        }
    }

    /// Loads `current`. The caller has already watched and read the known files of `current`.
    fn load(&mut self, current: Current) {
        self.gone_since = None;
        let Current { source, mut seen } = current;
        let began = SystemTime::now().checked_sub(FILE_CLOCK_STEP).unwrap_or(SystemTime::UNIX_EPOCH);
        let load = &mut self.load;
        let begun = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| load(&source)));
        let took = begun.elapsed();
        let files = match &outcome {
            Ok((_, files)) => files.clone(),
            Err(_) => seen.keys().cloned().collect(),
        };
        self.watch.set(&files);
        let mut looks = BTreeMap::new();
        for file in &files {
            let look = seen.remove(file).unwrap_or_else(|| {
                // This dependency was unknown until now. If the file changed during the load, the loaded version is
                // uncertain.
                let look = Look::at(file);
                let doubtful = look.stamp.is_since(began);
                if doubtful {
                    self.changes.record(file.clone(), Kind::Touched, Instant::now());
                }
                Some(look).filter(|_| !doubtful)
            });
            looks.insert(file.clone(), look);
        }
        self.current = Some(Current { source: source.clone(), seen: looks });
        match outcome {
            Ok((value, files)) => (self.publish)(Loaded { source, value, files, took }),
            Err(_) => tracing::error!("loading {} failed: this is a bug in Mariana", source.name()),
        }
    }
}

// The content of a file at one time, to decide if the file has really changed.

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Look {
    pub content: Content,
    pub stamp: Stamp,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Content {
    Missing,
    /// Length and hash of a file. If the file is larger than any scene may read, `hash` is 0.
    Bytes {
        length: u64,
        hash: u64,
    },
    /// A folder, a pipe, or a file that the system refuses to read.
    Unreadable(String),
}

/// Length and modification time, known without reading the file. Equal stamps do not prove that a file is unchanged:
/// two saves within one tick of the file system's clock have equal stamps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Stamp(Option<(u64, Option<SystemTime>)>);

impl Stamp {
    pub(super) fn of(path: &Path) -> Self {
        let metadata = fs::metadata(path).ok();
        Self(metadata.map(|metadata| (metadata.len(), metadata.modified().ok())))
    }

    /// True if the file may have changed at `time` or later.
    pub(super) fn is_since(&self, time: SystemTime) -> bool {
        matches!(self.0, Some((_, Some(modified))) if modified >= time)
    }
}

impl Look {
    pub(super) fn at(path: &Path) -> Self {
        // Take the stamp first: if the file changes in between, the next check finds a different stamp.
        let stamp = Stamp::of(path);
        let content = match hash(path) {
            Ok((length, hash)) => Content::Bytes { length, hash },
            Err(error) if error.kind() == io::ErrorKind::NotFound => Content::Missing,
            Err(error) => Content::Unreadable(error.to_string()),
        };
        Self { content, stamp }
    }
}

impl Content {
    /// True if the file has become missing or empty, as in a save that first empties or deletes the file.
    pub(super) fn is_gone_since(&self, before: &Self) -> bool {
        let nothing = |content: &Self| matches!(content, Self::Missing | Self::Bytes { length: 0, .. });
        nothing(self) && !nothing(before)
    }
}

fn hash(path: &Path) -> io::Result<(u64, u64)> {
    let max = limits::TEXTURE_BYTES_MAX.max(FIELD_LIMITS.scene_bytes_max);
    let Some(bytes) = read_at_most(path, max)? else { return Ok((fs::metadata(path)?.len(), 0)) };
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok((bytes.len() as u64, hasher.finish()))
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod content_tests {
    use super::*;

    #[test]
    fn content_decides_and_not_the_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert_eq!(Look::at(&path).content, Content::Missing);
        fs::write(&path, "one").unwrap();
        let first = Look::at(&path);
        let file = fs::File::options().append(true).open(&path).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        let touched = Look::at(&path);
        assert_eq!(first.content, touched.content);
        assert_ne!(first.stamp, touched.stamp);
        fs::write(&path, "two").unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        let second = Look::at(&path);
        assert_eq!(second.stamp, touched.stamp);
        assert_ne!(second.content, touched.content);
        assert!(matches!(Look::at(folder.path()).content, Content::Unreadable(_)));
    }

    #[test]
    fn empty_after_something_is_gone_but_empty_from_the_start_is_not() {
        let [empty, full] = [0, 7].map(|length| Content::Bytes { length, hash: 1 });
        assert!(empty.is_gone_since(&full) && Content::Missing.is_gone_since(&full));
        assert!(!empty.is_gone_since(&Content::Missing) && !Content::Missing.is_gone_since(&empty));
        assert!(!full.is_gone_since(&full));
    }
}
