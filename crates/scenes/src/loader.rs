//! Loads scenes on a background thread, and loads a scene again when its files change.
//!
//! The loader passes finished values to the show, so a large or broken scene delays no frame.
//!
//! Ten times a second, the loader compares length and modification time of each file of the scene. This finds saves of
//! any kind, also of files on a network and in replaced folders. A file counts as changed when its bytes differ
//! from the loaded bytes, so that a save without changes does not reload the scene. Changed files are read as soon as
//! they have been quiet for 50 ms. The loader waits for a missing or empty file for at most 400 ms, because some
//! editors delete or empty a file before they write it.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime};
use std::{fs, io};

use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_files::reading::read_at_most;
use mariana_work::{Background, lock};

use super::SceneSource;
use crate::limits;

/// The result of loading a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loaded<T> {
    /// The loaded source.
    pub source: SceneSource,
    /// The value that the load function returned.
    pub value: T,
    /// Duration of the load function.
    pub took: Duration,
}

/// A thread that loads one source at a time and watches its files. Dropping this ends the thread after the current
/// load, without waiting. No result is published after the drop.
#[derive(Debug)]
pub struct Loader<T> {
    requests: Sender<Message>,
    newest: Arc<Mutex<Option<Loaded<T>>>>,
}

enum Message {
    Load(SceneSource),
    Again,
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
        Self::start_with(load, wake, PATIENCE)
    }

    fn start_with(
        load: impl FnMut(&SceneSource) -> (T, Vec<PathBuf>) + Send + 'static,
        wake: impl Fn() + Send + 'static,
        patience: Duration,
    ) -> io::Result<Self> {
        let (requests, inbox) = channel();
        let newest = Arc::new(Mutex::new(None));
        let results = Arc::downgrade(&newest);
        Background::start("scene loader", move || {
            let publish = move |loaded| {
                // The loader is gone: the result is not wanted.
                let Some(newest) = results.upgrade() else { return };
                // Drop the old value outside the lock, because it may be large.
                let old = lock(&newest).replace(loaded);
                drop(old);
                wake();
            };
            Worker { load, publish, patience, current: None, noticed: None }.run(&inbox);
        })?;
        Ok(Self { requests, newest })
    }

    /// Requests `source`, and watches it instead of the previous source. The request replaces a request that has not
    /// started. A request of the same source loads the source again.
    pub fn request(&self, source: SceneSource) {
        self.send(Message::Load(source));
    }

    /// Loads the current source again, because a dependency other than its files has changed.
    pub fn load_again(&self) {
        self.send(Message::Again);
    }

    fn send(&self, message: Message) {
        if self.requests.send(message).is_err() {
            tracing::error!("the thread that loads scenes has ended: this is a bug in Mariana");
        }
    }

    /// Returns the newest result, unless it was returned before. The thread holds the lock only to store a result.
    pub fn poll(&self) -> Option<Loaded<T>> {
        lock(&self.newest).take()
    }
}

/// The current source, and for each of its files the state before the load; `None` if the file may have changed during
/// the load.
struct Current {
    source: SceneSource,
    seen: BTreeMap<PathBuf, Option<Look>>,
}

struct Worker<Load, Publish> {
    load: Load,
    publish: Publish,
    patience: Duration,
    current: Option<Current>,
    noticed: Option<Noticed>,
}

/// A change that is not loaded yet, because its writer may not have finished.
struct Noticed {
    since: Instant,
    /// The stamps of all files in the last check.
    stamps: Vec<Stamp>,
}

/// Interval of the checks for changed files.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Time without changes before changed files are read.
const QUIET: Duration = Duration::from_millis(50);

/// Maximum delay of a read while changes continue or a file is missing.
const PATIENCE: Duration = Duration::from_millis(400);

/// Maximum lag of a file's modification time behind the clock. File systems use the time of the last kernel tick.
const FILE_CLOCK_STEP: Duration = Duration::from_millis(12);

/// The largest step of the modification times of any usual file system.
const COARSE_CLOCK_STEP: Duration = Duration::from_secs(2);

impl<T, Load, Publish> Worker<Load, Publish>
where
    Load: FnMut(&SceneSource) -> (T, Vec<PathBuf>),
    Publish: Fn(Loaded<T>),
{
    fn run(&mut self, inbox: &Receiver<Message>) {
        let mut asked: Option<Message> = None;
        loop {
            let watching = self.current.as_ref().is_some_and(|current| !current.seen.is_empty());
            let wait = if self.noticed.is_some() { QUIET } else { CHECK_INTERVAL };
            // Handle all messages before due work, so that the last of several requests wins.
            let message = match &asked {
                Some(_) => inbox.recv_timeout(Duration::ZERO),
                None if watching => inbox.recv_timeout(wait),
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match message {
                // The waiting request loads all files anyway.
                Ok(Message::Again) if asked.is_some() => {}
                Ok(message) => asked = Some(message),
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => match asked.take() {
                    Some(Message::Load(source)) => self.begin(source),
                    // The source is the same, so the same files stay watched.
                    Some(Message::Again) => self.load(),
                    None => self.check(),
                },
            }
        }
    }

    /// Loads another source, or the same source from scratch.
    fn begin(&mut self, source: SceneSource) {
        let before = self.current.take().filter(|current| current.source == source);
        let mut files = before.map_or_else(Vec::new, |current| current.seen.into_keys().collect());
        files.extend(source.file().map(PathBuf::from));
        let seen = files.into_iter().map(|file| (file.clone(), Some(Look::at(&file)))).collect();
        self.current = Some(Current { source, seen });
        self.load();
    }

    /// Loads the source again if its files have changed and their writers seem to have finished.
    fn check(&mut self) {
        let Some(current) = &mut self.current else { return };
        let stamps: Vec<Stamp> = current.seen.keys().map(|file| stamp_of(file)).collect();
        let noticed = self.noticed.take();
        let known = |seen: &Option<Look>, stamp| seen.as_ref().is_some_and(|seen| seen.proves(stamp));
        let files = current.seen.iter().zip(&stamps).filter(|((_, seen), stamp)| !known(seen, stamp));
        let doubtful: Vec<PathBuf> = files.map(|((file, _), _)| file.clone()).collect();
        if doubtful.is_empty() {
            return;
        }
        let since = noticed.as_ref().map_or_else(Instant::now, |noticed| noticed.since);
        let quiet = noticed.is_some_and(|noticed| noticed.stamps == stamps);
        let patient = since.elapsed() < self.patience;
        if patient && !quiet {
            self.noticed = Some(Noticed { since, stamps });
            return;
        }
        let looks: BTreeMap<PathBuf, Look> =
            doubtful.into_iter().map(|file| (file.clone(), Look::at(&file))).collect();
        let before = |file| current.seen.get(file)?.as_ref().map(|seen| seen.content);
        let gone =
            |(file, look): (_, &Look)| before(file).is_some_and(|before| is_gone(look.content, before));
        if patient && looks.iter().any(gone) {
            self.noticed = Some(Noticed { since, stamps });
            return;
        }
        let changed = looks.iter().any(|(file, look)| before(file) != Some(look.content));
        current.seen.extend(looks.into_iter().map(|(file, look)| (file, Some(look))));
        if changed {
            self.load();
        }
    }

    /// Loads the current source. The caller has already read its known files.
    fn load(&mut self) {
        self.noticed = None;
        let Some(Current { source, mut seen }) = self.current.take() else { return };
        let began = SystemTime::now().checked_sub(FILE_CLOCK_STEP).unwrap_or(SystemTime::UNIX_EPOCH);
        let load = &mut self.load;
        let begun = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| load(&source)));
        let took = begun.elapsed();
        let files = match &outcome {
            Ok((_, files)) => files.clone(),
            Err(_) => seen.keys().cloned().collect(),
        };
        let look = |file: &PathBuf| {
            // A dependency that was unknown until now may have changed during the load.
            let is_older = |look: &Look| look.modified().is_none_or(|modified| modified < began);
            let look = seen.remove(file).unwrap_or_else(|| Some(Look::at(file)).filter(is_older));
            (file.clone(), look)
        };
        let seen = files.iter().map(look).collect();
        self.current = Some(Current { source: source.clone(), seen });
        match outcome {
            Ok((value, _)) => (self.publish)(Loaded { source, value, took }),
            Err(_) => tracing::error!("loading {} failed: this is a bug in Mariana", source.name()),
        }
    }
}

// The content of a file at one time, to decide if the file has really changed.

#[derive(Debug, Clone, PartialEq, Eq)]
struct Look {
    content: Content,
    stamp: Stamp,
    /// True if the file was modified so recently that another change may have the same stamp.
    fresh: bool,
}

/// Length and hash of a file; `None` if it is missing or cannot be read. If the file is larger than any scene may read,
/// the hash is 0.
type Content = Option<(u64, u64)>;

/// Length and modification time, known without reading the file. Two saves within one tick of the file system's clock
/// may have equal stamps.
type Stamp = Option<(u64, Option<SystemTime>)>;

fn stamp_of(path: &Path) -> Stamp {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()))
}

impl Look {
    fn at(path: &Path) -> Self {
        // Take the stamp first: if the file changes in between, the next check finds a different stamp.
        let stamp = stamp_of(path);
        let look = Self { content: content_of(path).ok(), stamp, fresh: false };
        let now = SystemTime::now();
        let age = |modified| now.duration_since(modified).unwrap_or_else(|error| error.duration());
        Self { fresh: look.modified().is_some_and(|modified| age(modified) <= COARSE_CLOCK_STEP), ..look }
    }

    fn modified(&self) -> Option<SystemTime> {
        self.stamp?.1
    }

    /// True if a file with this stamp has the same content for certain.
    fn proves(&self, stamp: &Stamp) -> bool {
        // A file that could not be read may become readable without another stamp.
        !self.fresh && self.stamp == *stamp && self.content.is_some() == stamp.is_some()
    }
}

/// True if a file has become missing or empty, as in a save that first empties or deletes the file.
fn is_gone(now: Content, before: Content) -> bool {
    let is_nothing = |content: Content| content.is_none_or(|(length, _)| length == 0);
    is_nothing(now) && !is_nothing(before)
}

fn content_of(path: &Path) -> io::Result<(u64, u64)> {
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
        assert_eq!(Look::at(&path).content, None);
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
        assert_eq!(Look::at(folder.path()).content, None);
    }

    #[test]
    fn empty_after_something_is_gone_but_empty_from_the_start_is_not() {
        let [empty, full] = [0, 7].map(|length| Some((length, 1)));
        assert!(is_gone(empty, full) && is_gone(None, full));
        assert!(!is_gone(empty, None) && !is_gone(None, empty));
        assert!(!is_gone(full, full));
    }
}
