//! Videos that the window makes: a queue of orders, which other processes render one after the other.
//!
//! A thread owns the queue and the process (`worker`). The session sends it orders and reads what it publishes, so that
//! the show never waits for a disk or a process. The queue is kept in the user's folder (`queue`): after the end of the
//! program, or a crash, the next start offers the unfinished videos. The process is `mariana video --controlled`. It
//! ends when its standard input ends, so it never outlives the window.

mod estimate;
mod order;
mod process;
mod queue;
mod worker;

use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Sender, channel};

use mariana_work::{Latest, Shared, looping};

use crate::commands::JobAction;
use crate::config::Folders;
pub use estimate::Estimate;
use estimate::Measure;
pub use order::{Order, OrderedShow};
pub use queue::{Job, JobState};
use worker::{Event, Worker};

/// The queue of videos. Dropping it ends the video that is being rendered, which stays in the queue.
pub struct Videos {
    events: Sender<Event>,
    published: Latest<Published>,
}

#[derive(Default)]
struct Published {
    shown: Shown,
    /// Messages for the user.
    news: VecDeque<String>,
}

/// The state of the queue.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shown {
    /// The videos in their order.
    pub jobs: Vec<Job>,
    /// The expected time and size of the order that [`Videos::measure`] was asked for.
    pub estimate: Estimate,
    /// A song's title, and the newest recorded performance of the song.
    pub performance: Option<(String, PathBuf)>,
}

impl Shown {
    /// Returns a note for the window's title while a video is rendered.
    pub fn title_note(&self) -> Option<String> {
        self.jobs.iter().find_map(|job| match job.state {
            JobState::Rendering { done, of: Some(of), .. } => {
                Some(format!("video {} %", 100 * done / of.max(1)))
            }
            JobState::Rendering { .. } => Some("video".to_owned()),
            JobState::Paused { .. } => Some("video paused".to_owned()),
            _ => None,
        })
    }
}

impl Videos {
    /// Starts the thread, which calls `wake` after each change.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(folders: &Folders, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let (events, incoming) = channel();
        let (folders, sends) = (folders.clone(), events.clone());
        let work = move |shared: &Shared<Published>| {
            Worker::new(folders, (sends, incoming), Box::new(wake)).work(shared);
        };
        Ok(Self { events, published: looping("videos", Published::default(), work)? })
    }

    /// Appends a video to the queue. `file` is its path; if the path is taken, the video gets another name.
    pub fn add(&self, title: String, file: PathBuf, order: &Order) {
        let arguments = order.arguments();
        self.send(move |worker| worker.add(title, &file, arguments));
    }

    /// Pauses, continues, removes or shows a video.
    pub fn act(&self, id: u64, action: JobAction) {
        self.send(move |worker| worker.act(id, action));
    }

    /// Measures how long a video of `seconds` in the folder of `file` would take; [`Shown::estimate`] gets the result.
    /// `None` stops measuring.
    pub fn measure(&self, order: Option<(&Order, f64, PathBuf)>) {
        let measure = order.map(|(order, seconds, file)| Measure::of(order, seconds, file));
        self.send(move |worker| worker.measure(measure));
    }

    /// Looks for the newest performance of a song with this title; [`Shown::performance`] gets the result.
    pub fn find_performance(&self, title: String) {
        self.send(move |worker| worker.find_performance(title));
    }

    /// Reads the state of the queue.
    pub fn with_shown<T>(&self, read: impl FnOnce(&Shown) -> T) -> T {
        read(&self.published.lock().shown)
    }

    /// Returns the next message for the user, if any.
    pub fn news(&self) -> Option<String> {
        self.published.lock().news.pop_front()
    }

    fn send(&self, call: impl FnOnce(&mut Worker) + Send + 'static) {
        // Without the thread, nothing is rendered; its panic was reported.
        let _ = self.events.send(Box::new(call));
    }
}

impl Drop for Videos {
    fn drop(&mut self) {
        self.send(|worker| worker.is_over = true);
    }
}
