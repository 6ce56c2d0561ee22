//! The thread that reads, saves and backs up texts, and watches the files of the texts for changes.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;
use std::time::{Duration, Instant, SystemTime};

use super::{Bytes, FileEvent, KeptTexts, OnDisk, stem_of};
use crate::atomic_file::AtomicFile;
use crate::reading::read_at_most;
use crate::{Folders, limits};

/// Interval of the checks for changes that other programs make to the files.
const LOOK: Duration = Duration::from_millis(400);
const KEEP: Duration = Duration::from_millis(300);
const NAMES_MAX: usize = 1_000;

/// A thread for file access. The thread ends when this is dropped and all requests are done.
#[derive(Debug)]
pub struct FileThread {
    orders: Sender<Order>,
    file_events: Receiver<FileEvent>,
    own_scenes: Option<PathBuf>,
}

enum Order {
    Open(PathBuf),
    Save { file: PathBuf, text: Bytes, believed: Option<OnDisk> },
    Create { folder: PathBuf, name: String, text: Bytes },
    Keep { file: PathBuf, text: Option<Bytes> },
    Finish(Sender<()>),
}

impl FileThread {
    /// Starts the thread. Backups and new scenes go into `folders`. The thread calls `wake` after each event.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(folders: &Folders, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let kept = KeptTexts::among(folders);
        let own_scenes = folders.own_scenes();
        let ((orders, inbox), (tell, file_events)) = (channel(), channel());
        Builder::new().name("documents".into()).spawn(move || {
            let tell = move |file_events| {
                // The receiver may be gone at exit.
                let _ = tell.send(file_events);
                wake();
            };
            FileThreadState { tell, kept, known: BTreeMap::new(), to_keep: BTreeMap::new() }.run(&inbox);
        })?;
        Ok(Self { orders, file_events, own_scenes })
    }

    /// Returns the folder for the user's copies of scenes; `None` if the system has no data folder.
    pub fn own_scenes(&self) -> Option<&Path> {
        self.own_scenes.as_deref()
    }

    /// Reads a file and watches it from now on.
    pub fn open(&self, file: &Path) {
        self.order(Order::Open(file.to_owned()));
    }

    /// Saves a text if the file still has the content `believed`. `None` overwrites any content.
    pub fn save(&self, file: &Path, text: Bytes, believed: Option<OnDisk>) {
        self.order(Order::Save { file: file.to_owned(), text, believed });
    }

    /// Creates a new scene file in `folder` with a name like `name`.
    pub fn create(&self, folder: &Path, name: &str, text: Bytes) {
        self.order(Order::Create { folder: folder.to_owned(), name: name.to_owned(), text });
    }

    /// Backs up an unsaved text; `None` removes the backup.
    pub fn keep(&self, file: &Path, text: Option<Bytes>) {
        self.order(Order::Keep { file: file.to_owned(), text });
    }

    /// Returns the next event. Never blocks.
    pub fn file_events(&self) -> Option<FileEvent> {
        self.file_events.try_recv().ok()
    }

    /// Waits until all requests are done, for at most `limit`.
    pub fn finish(&self, limit: Duration) {
        let (done, finished) = channel();
        self.order(Order::Finish(done));
        if finished.recv_timeout(limit).is_err() {
            tracing::warn!("the disk is slow: unsaved text may not be backed up");
        }
    }

    fn order(&self, order: Order) {
        if self.orders.send(order).is_err() {
            tracing::error!("the thread that saves files has ended: this is a bug in Mariana");
        }
    }
}

struct Known {
    stamp: Stamp,
    holds: OnDisk,
    /// True if this program wrote the content.
    is_own: bool,
}

/// Length and modification time; `None` if the file does not exist.
type Stamp = Option<(u64, Option<SystemTime>)>;

/// The next backup of a text, and the time of the previous backup.
struct ToKeep {
    text: Option<Bytes>,
    last: Option<Instant>,
}

struct FileThreadState<Tell> {
    tell: Tell,
    kept: KeptTexts,
    known: BTreeMap<PathBuf, Known>,
    to_keep: BTreeMap<PathBuf, ToKeep>,
}

impl<Tell: Fn(FileEvent)> FileThreadState<Tell> {
    fn run(&mut self, inbox: &Receiver<Order>) {
        let mut looked = Instant::now();
        loop {
            let look = (!self.known.is_empty()).then_some(looked + LOOK);
            let now = Instant::now();
            let keep = self.to_keep.values().filter(|one| one.text.is_some()).map(|one| one.due(now));
            let due = keep.chain(look).min();
            let order = match due {
                Some(due) => inbox.recv_timeout(due.saturating_duration_since(now)),
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match order {
                Ok(order) => self.obey(order),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.keep_all(true),
            }
            self.keep_all(false);
            if looked + LOOK <= Instant::now() {
                self.report_changed_files();
                looked = Instant::now();
            }
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Open(file) => {
                let known = known(&file);
                let holds = known.holds.clone();
                let kept = self.kept.of(&file);
                self.known.insert(file.clone(), known);
                (self.tell)(FileEvent::Opened { file, holds, kept });
            }
            Order::Save { file, text, believed } => self.save(file, text, believed),
            Order::Create { folder, name, text } => self.create(&folder, &name, &text),
            Order::Keep { file, text: Some(text) } => {
                let entry = self.to_keep.entry(file).or_insert(ToKeep { text: None, last: None });
                entry.text = Some(text);
            }
            Order::Keep { file, text: None } => {
                self.to_keep.remove(&file);
                self.kept.forget(&file);
            }
            Order::Finish(done) => {
                self.keep_all(true);
                let _ = done.send(());
            }
        }
    }

    fn save(&mut self, file: PathBuf, text: Bytes, believed: Option<OnDisk>) {
        let now = known(&file);
        // A second save may arrive before the editor has the event of the first save.
        let was_own = self.known.get(&file).is_some_and(|last| last.is_own && last.holds == now.holds);
        let is_own = was_own || matches!(&now.holds, OnDisk::Bytes(bytes) if **bytes == *text);
        if !is_own && believed.is_some_and(|believed| believed != now.holds) {
            let holds = now.holds.clone();
            self.known.insert(file.clone(), now);
            return (self.tell)(FileEvent::Refused { file, holds });
        }
        let written = AtomicFile::create(&file).and_then(|place| place.write(&text));
        match written {
            Ok(()) => {
                let now = known(&file);
                let is_own = matches!(&now.holds, OnDisk::Bytes(bytes) if **bytes == *text);
                self.known.insert(file.clone(), Known { is_own, ..now });
                self.to_keep.remove(&file);
                self.kept.forget(&file);
                (self.tell)(FileEvent::Saved { file, text });
            }
            Err(error) => {
                let reason = format!("{error}; a backup of the text is kept, so save it under another name");
                (self.tell)(FileEvent::Failed(reason));
            }
        }
    }

    fn create(&mut self, folder: &Path, name: &str, text: &[u8]) {
        let stem = stem_of(name);
        let names = (1..NAMES_MAX).map(|number| match number {
            1 => format!("{stem}.scene"),
            _ => format!("{stem}-{number}.scene"),
        });
        let failed = |reason| (self.tell)(FileEvent::Failed(reason));
        let Some(file) = names.map(|name| folder.join(name)).find(|file| fs::symlink_metadata(file).is_err())
        else {
            return failed(format!(
                "{} has {NAMES_MAX} scenes with that name: rename some of them",
                folder.display()
            ));
        };
        match AtomicFile::create_with_folder(&file).and_then(|place| place.write(text)) {
            Ok(()) => (self.tell)(FileEvent::Created(file)),
            Err(error) => failed(error.to_string()),
        }
    }

    /// Backs up the texts that are due, or `all` of them.
    fn keep_all(&mut self, all: bool) {
        let now = Instant::now();
        for (file, one) in &mut self.to_keep {
            if !all && one.due(now) > now {
                continue;
            }
            let Some(text) = one.text.take() else { continue };
            one.last = Some(now);
            if let Err(reason) = self.kept.keep(file, &text) {
                let reason =
                    format!("Mariana cannot back up the unsaved text of {}: {reason}", file.display());
                (self.tell)(FileEvent::Failed(reason));
            }
        }
    }

    /// Reports the files that other programs have changed.
    fn report_changed_files(&mut self) {
        for (file, before) in &mut self.known {
            if stamp(file) == before.stamp {
                continue;
            }
            let now = known(file);
            let is_another = now.holds != before.holds;
            *before = now;
            if is_another {
                (self.tell)(FileEvent::Changed { file: file.clone(), holds: before.holds.clone() });
            }
        }
    }
}

impl ToKeep {
    /// Returns the time of the next backup; `now` for the first backup.
    fn due(&self, now: Instant) -> Instant {
        self.last.map_or(now, |last| last + KEEP)
    }
}

fn stamp(file: &Path) -> Stamp {
    let metadata = fs::metadata(file).ok()?;
    Some((metadata.len(), metadata.modified().ok()))
}

fn known(file: &Path) -> Known {
    // Take the stamp first: if the file changes in between, the next check finds a different stamp.
    let stamp = stamp(file);
    Known { stamp, holds: read(file), is_own: false }
}

fn read(file: &Path) -> OnDisk {
    let max = limits::KEPT_TEXT_BYTES_MAX;
    match read_at_most(file, max) {
        Ok(Some(bytes)) => OnDisk::Bytes(Arc::from(bytes)),
        Ok(None) => OnDisk::Unreadable(format!("it is larger than {max} bytes")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => OnDisk::Missing,
        Err(error) => OnDisk::Unreadable(error.to_string()),
    }
}
