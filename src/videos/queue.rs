//! The queue of videos, and the file that keeps it.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::atomic_file::AtomicFile;
use crate::config::Folders;
use crate::file_names::numbered;
use crate::limits;

const FILE: &str = "videos.json";

/// A video of the queue.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// A number that no other video of this run has.
    pub id: u64,
    /// The title of the song.
    pub title: String,
    /// The path of the video.
    pub file: PathBuf,
    /// The progress.
    pub state: JobState,
    /// The arguments of `mariana video`, without the output.
    pub(super) arguments: Vec<String>,
    /// How often the process has crashed.
    pub(super) crashes: u32,
}

/// The progress of a video.
#[derive(Debug, Clone, PartialEq)]
pub enum JobState {
    /// It is rendered after the videos before it.
    Waiting,
    /// An earlier run of the program has not finished it. It waits for the user.
    Unfinished,
    /// It is being rendered.
    Rendering {
        /// Number of frames so far.
        done: u64,
        /// Total number of frames, once known.
        of: Option<u64>,
        /// Expected remaining time in seconds, once known.
        left: Option<f64>,
    },
    /// The user has paused it.
    Paused {
        /// Number of frames so far.
        done: u64,
        /// Total number of frames, once known.
        of: Option<u64>,
    },
    /// It failed, for this reason.
    Failed(String),
    /// The file is complete.
    Done,
}

/// A video in the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct KeptJob {
    title: String,
    file: PathBuf,
    arguments: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    failed: Option<String>,
}

/// The videos in their order.
#[derive(Default)]
pub(super) struct Queue {
    pub(super) jobs: Vec<Job>,
    last_id: u64,
}

impl Queue {
    /// Appends a video. If `file` or its name in the queue is taken, it gets another name. Returns a message if the
    /// queue is full.
    pub(super) fn add(&mut self, title: String, file: &Path, arguments: Vec<String>) -> Result<(), String> {
        let unfinished = self.jobs.iter().filter(|job| job.state != JobState::Done).count();
        if unfinished >= limits::VIDEOS_MAX {
            return Err(format!(
                "there are already {} videos in the queue: remove some of them",
                limits::VIDEOS_MAX
            ));
        }
        let is_free = |path: &PathBuf| {
            path.symlink_metadata().is_err() && self.jobs.iter().all(|job| job.file != *path)
        };
        let file = numbered(file).find(is_free).unwrap_or_else(|| file.to_owned());
        self.push(title, file, arguments, JobState::Waiting);
        Ok(())
    }

    fn push(&mut self, title: String, file: PathBuf, arguments: Vec<String>, state: JobState) {
        self.last_id += 1;
        self.jobs.push(Job { id: self.last_id, title, file, state, arguments, crashes: 0 });
    }

    pub(super) fn job(&mut self, id: u64) -> Option<&mut Job> {
        self.jobs.iter_mut().find(|job| job.id == id)
    }

    pub(super) fn remove(&mut self, id: u64) {
        self.jobs.retain(|job| job.id != id);
    }

    fn text(&self) -> String {
        let kept = self.jobs.iter().filter(|job| job.state != JobState::Done).map(|job| KeptJob {
            title: job.title.clone(),
            file: job.file.clone(),
            arguments: job.arguments.clone(),
            failed: match &job.state {
                JobState::Failed(reason) => Some(reason.clone()),
                _ => None,
            },
        });
        serde_json::to_string_pretty(&kept.collect::<Vec<_>>()).unwrap_or_else(|_| "[]".to_owned())
    }

    fn read(&mut self, text: &str) -> Result<(), serde_json::Error> {
        for kept in serde_json::from_str::<Vec<KeptJob>>(text)?.into_iter().take(limits::VIDEOS_MAX) {
            let state = kept.failed.map_or(JobState::Unfinished, JobState::Failed);
            self.push(kept.title, kept.file, kept.arguments, state);
        }
        Ok(())
    }
}

/// The file of the queue. Only one window of the user keeps its queue.
pub(super) struct QueueFile {
    path: PathBuf,
    /// The text in the file.
    written: String,
    _lock: File,
}

impl QueueFile {
    /// Opens the file and reads its videos into `queue`. Returns `None` without a folder, and while another window
    /// keeps its queue. Also returns a message if the file was damaged; it then has another name.
    pub(super) fn open(folders: &Folders, queue: &mut Queue) -> (Option<Self>, Option<String>) {
        let Some(folder) = folders.state.as_deref() else { return (None, None) };
        let lock = fs::create_dir_all(folder).and_then(|()| {
            File::options().create(true).truncate(false).write(true).open(folder.join("videos.lock"))
        });
        let lock = match lock {
            Ok(lock) => lock,
            Err(error) => {
                tracing::warn!("the queue of videos is not kept: {} ({error})", folder.display());
                return (None, None);
            }
        };
        if lock.try_lock().is_err() {
            tracing::info!("another window keeps the queue of videos");
            return (None, None);
        }
        let path = folder.join(FILE);
        let mut text = String::new();
        let read = File::open(&path)
            .and_then(|file| file.take(limits::VIDEO_QUEUE_BYTES_MAX).read_to_string(&mut text));
        let reason = match read {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => Some(error.to_string()),
            Ok(_) => queue.read(&text).err().map(|error| error.to_string()),
        };
        let told = reason.map(|reason| {
            let aside = numbered(&folder.join("videos damaged.json")).find(|path| !path.exists());
            let moved = aside.filter(|aside| fs::rename(&path, aside).is_ok());
            let place = moved.as_ref().unwrap_or(&path).display();
            format!("the list of unfinished videos cannot be read ({reason}): make them again; it is kept in {place}")
        });
        (Some(Self { path, written: queue.text(), _lock: lock }), told)
    }

    /// Writes the queue if it has changed.
    ///
    /// # Errors
    /// Fails with a message if the file cannot be written.
    pub(super) fn keep(&mut self, queue: &Queue) -> Result<(), String> {
        let text = queue.text();
        if text == self.written {
            return Ok(());
        }
        let written = AtomicFile::create(&self.path).and_then(|file| file.write(text.as_bytes()));
        self.written = text;
        written.map_err(|error| {
            let remedy = error.remedy();
            format!("{error}: if Mariana ends now, it forgets the unfinished videos; {remedy}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn add(queue: &mut Queue, file: &Path) {
        queue.add("one".to_owned(), file, vec!["--start".to_owned(), "1".to_owned()]).unwrap();
    }

    #[test]
    fn unfinished_videos_are_offered_again_and_names_stay_free() {
        let folder = tempfile::tempdir().unwrap();
        let folders = Folders::within(folder.path());
        let path = folder.path().join("song.mp4");
        fs::write(&path, "another video").unwrap();
        let mut queue = Queue::default();
        let (file, told) = QueueFile::open(&folders, &mut queue);
        assert!(told.is_none());
        (0..4).for_each(|_| add(&mut queue, &path));
        let names: Vec<_> = queue.jobs.iter().map(|job| job.file.clone()).collect();
        assert_eq!(names, [2, 3, 4, 5].map(|number| folder.path().join(format!("song {number}.mp4"))));
        queue.jobs[0].state = JobState::Rendering { done: 5, of: None, left: None };
        queue.jobs[1].state = JobState::Done;
        queue.jobs[2].state = JobState::Failed("no room".to_owned());
        let mut file = file.unwrap();
        file.keep(&queue).unwrap();
        let other_window = QueueFile::open(&folders, &mut Queue::default());
        assert!(other_window.0.is_none(), "two windows keep one queue");
        drop(file);
        let mut again = Queue::default();
        assert!(QueueFile::open(&folders, &mut again).0.is_some());
        let states: Vec<_> = again.jobs.iter().map(|job| job.state.clone()).collect();
        let failed = JobState::Failed("no room".to_owned());
        assert_eq!(states, [JobState::Unfinished, failed, JobState::Unfinished]);
        assert_eq!(again.jobs[0].arguments, queue.jobs[0].arguments);
        assert!(
            again.jobs.iter().find(|job| job.state == JobState::Waiting).is_none(),
            "nothing is rendered before the user wants it"
        );
    }

    #[test]
    fn a_damaged_list_is_kept_aside() {
        for junk in [&b"rubbish"[..], b"", b"[{}]", b"{\"a\":1}", b"\xff\xfe", b"[{\"title\":1}]"] {
            let folder = tempfile::tempdir().unwrap();
            let folders = Folders::within(folder.path());
            let state = folders.state.clone().unwrap();
            fs::create_dir_all(&state).unwrap();
            fs::write(state.join(FILE), junk).unwrap();
            let mut queue = Queue::default();
            let (file, told) = QueueFile::open(&folders, &mut queue);
            assert!(told.unwrap().contains("videos damaged.json") && queue.jobs.is_empty());
            assert_eq!(fs::read(state.join("videos damaged.json")).unwrap(), junk);
            add(&mut queue, &folder.path().join("song.mp4"));
            file.unwrap().keep(&queue).unwrap();
            assert!(fs::read_to_string(state.join(FILE)).unwrap().contains("song.mp4"));
        }
    }

    #[test]
    fn a_full_queue_refuses_videos() {
        let mut queue = Queue::default();
        (0..limits::VIDEOS_MAX).for_each(|_| add(&mut queue, Path::new("/none/song.mp4")));
        let refused = queue.add(String::new(), Path::new("/none/song.mp4"), Vec::new());
        assert!(refused.unwrap_err().contains("remove"));
    }
}
