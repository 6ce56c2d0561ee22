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

/// Interval of the backups, and of the checks for changes that other programs make to the files.
const TICK: Duration = Duration::from_millis(300);
const NAMES_MAX: usize = 1_000;

/// A thread for file access. The thread ends when this is dropped and all requests are done.
#[derive(Debug)]
pub struct FileThread {
    orders: Sender<Order>,
    file_events: Receiver<FileEvent>,
    own_scenes: Option<PathBuf>,
}

type Order = Box<dyn FnOnce(&mut FileThreadState) + Send>;

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
            let tell = Box::new(move |file_event| {
                // The receiver may be gone at exit.
                let _ = tell.send(file_event);
                wake();
            });
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
        let file = file.to_owned();
        self.order(move |state| state.open(file));
    }

    /// Saves a text if the file still has the content `believed`. `None` overwrites any content.
    pub fn save(&self, file: &Path, text: Bytes, believed: Option<OnDisk>) {
        let file = file.to_owned();
        self.order(move |state| state.save(file, text, believed));
    }

    /// Creates a new scene file in `folder` with a name like `name`.
    pub fn create(&self, folder: &Path, name: &str, text: Bytes) {
        let (folder, name) = (folder.to_owned(), name.to_owned());
        self.order(move |state| state.create(&folder, &name, &text));
    }

    /// Backs up an unsaved text; `None` removes the backup.
    pub fn keep(&self, file: &Path, text: Option<Bytes>) {
        let file = file.to_owned();
        self.order(move |state| match text {
            Some(text) => drop(state.to_keep.insert(file, text)),
            None => state.forget(&file),
        });
    }

    /// Returns the next event. Never blocks.
    pub fn file_events(&self) -> Option<FileEvent> {
        self.file_events.try_recv().ok()
    }

    /// Waits until all requests are done, for at most `limit`.
    pub fn finish(&self, limit: Duration) {
        let (done, finished) = channel();
        self.order(move |state| {
            state.keep_all();
            let _ = done.send(());
        });
        if finished.recv_timeout(limit).is_err() {
            tracing::warn!("the disk is slow: unsaved text may not be backed up");
        }
    }

    fn order(&self, order: impl FnOnce(&mut FileThreadState) + Send + 'static) {
        if self.orders.send(Box::new(order)).is_err() {
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

struct FileThreadState {
    tell: Box<dyn Fn(FileEvent)>,
    kept: KeptTexts,
    known: BTreeMap<PathBuf, Known>,
    /// The texts that are not backed up yet.
    to_keep: BTreeMap<PathBuf, Bytes>,
}

impl FileThreadState {
    fn run(&mut self, inbox: &Receiver<Order>) {
        let mut ticked = Instant::now();
        loop {
            let is_idle = self.known.is_empty() && self.to_keep.is_empty();
            let wait = if is_idle { Duration::MAX } else { TICK.saturating_sub(ticked.elapsed()) };
            match inbox.recv_timeout(wait) {
                Ok(order) => order(self),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.keep_all(),
            }
            if ticked.elapsed() >= TICK {
                self.keep_all();
                self.report_changed_files();
                ticked = Instant::now();
            }
        }
    }

    fn open(&mut self, file: PathBuf) {
        self.keep_all();
        let known = known(&file);
        let holds = known.holds.clone();
        let kept = self.kept.of(&file);
        self.known.insert(file.clone(), known);
        (self.tell)(FileEvent::Opened { file, holds, kept });
    }

    /// Removes the backup of a text.
    fn forget(&mut self, file: &Path) {
        self.to_keep.remove(file);
        self.kept.forget(file);
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
                self.forget(&file);
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

    fn keep_all(&mut self) {
        for (file, text) in std::mem::take(&mut self.to_keep) {
            if let Err(reason) = self.kept.keep(&file, &text) {
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
