//! The thread that owns the queue of videos and the process that renders.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use mariana_work::Shared;
use tempfile::TempDir;

use super::estimate::{Estimate, Measure, Measuring};
use super::process::{End, Process, show_in_folder};
use super::queue::{JobState, Queue, QueueFile};
use super::{Published, Shown};
use crate::commands::JobAction;
use crate::config::{Folders, PerformanceFiles};
use crate::export::video::VideoReport;

/// A process that was asked to end is killed after this time.
const PATIENCE: Duration = Duration::from_secs(5);
/// Progress is published at most this often.
const PUBLISH_EVERY: Duration = Duration::from_millis(250);
/// The longest wait for an event.
const LONG: Duration = Duration::from_secs(3600);

/// A call of the worker from another thread.
pub(super) type Event = Box<dyn FnOnce(&mut Worker) + Send>;

pub(super) struct Worker {
    folders: Folders,
    queue: Queue,
    /// `None` if another window keeps its queue, or there is no folder.
    file: Option<QueueFile>,
    run: Option<VideoRun>,
    runs: u64,
    /// The measurement to make when no video is rendered.
    wanted: Option<Measure>,
    shown: Shown,
    published: Option<Instant>,
    /// Messages for the user, which are published with the state to which they belong.
    told: Vec<String>,
    events: (Sender<Event>, Receiver<Event>),
    wake: Box<dyn Fn() + Send>,
    pub(super) is_over: bool,
}

/// A running process.
struct VideoRun {
    number: u64,
    process: Process,
    task: Task,
    /// The time at which a measurement ends, and at which a process that was asked to end is killed.
    due: Option<Instant>,
    /// True once the process was asked to end.
    is_ending: bool,
}

enum Task {
    Render {
        job: u64,
        /// The time and frame at which the drawing began or continued.
        since: Option<(Instant, u64)>,
        name: Option<String>,
    },
    Measure {
        measuring: Measuring,
        folder: TempDir,
    },
}

impl Worker {
    pub(super) fn new(
        folders: Folders,
        events: (Sender<Event>, Receiver<Event>),
        wake: Box<dyn Fn() + Send>,
    ) -> Self {
        Self {
            folders,
            queue: Queue::default(),
            file: None,
            run: None,
            runs: 0,
            wanted: None,
            shown: Shown::default(),
            published: None,
            told: Vec::new(),
            events,
            wake,
            is_over: false,
        }
    }

    pub(super) fn work(mut self, shared: &Shared<Published>) {
        let (file, told) = QueueFile::open(&self.folders, &mut self.queue);
        self.file = file;
        let unfinished = self.queue.jobs.iter().filter(|job| job.state == JobState::Unfinished).count();
        let words = match unfinished {
            0 => None,
            1 => Some("a video is unfinished: press F10 to continue it".to_owned()),
            count => Some(format!("{count} videos are unfinished: press F10 to continue them")),
        };
        self.told.extend(told.into_iter().chain(words));
        self.publish(shared);
        loop {
            let due = self.run.as_ref().and_then(|run| run.due);
            let wait = due.map_or(LONG, |at| at.saturating_duration_since(Instant::now()));
            match self.events.1.recv_timeout(wait) {
                Ok(event) => event(&mut self),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if self.is_over {
                // The process ends with its input. Its video stays in the queue.
                return;
            }
            self.end_overdue(Instant::now());
            self.begin_next();
            self.publish(shared);
        }
    }

    pub(super) fn add(&mut self, title: String, file: &Path, arguments: Vec<String>) {
        if let Err(words) = self.queue.add(title, file, arguments) {
            self.told.push(words);
        }
        self.stop_measuring();
    }

    pub(super) fn measure(&mut self, wanted: Option<Measure>) {
        self.stop_measuring();
        self.wanted = wanted;
    }

    pub(super) fn find_performance(&mut self, title: String) {
        let found = PerformanceFiles::newest(&self.folders, &title);
        self.shown.performance = found.map(|file| (title, file));
    }

    pub(super) fn act(&mut self, job: u64, action: JobAction) {
        let now = Instant::now();
        let rendered = self.run.as_mut().filter(|run| run.renders(job));
        let Some(found) = self.queue.job(job) else { return };
        match (action, rendered) {
            (JobAction::Pause, Some(run)) => {
                if let JobState::Rendering { done, of, .. } = found.state {
                    run.process.set_paused(true);
                    found.state = JobState::Paused { done, of };
                }
            }
            (JobAction::Continue, Some(run)) => {
                if let JobState::Paused { done, of } = found.state {
                    run.process.set_paused(false);
                    if let Task::Render { since, .. } = &mut run.task {
                        *since = Some((now, done));
                    }
                    found.state = JobState::Rendering { done, of, left: None };
                }
            }
            (JobAction::Continue, None) if found.state != JobState::Done => {
                (found.state, found.crashes) = (JobState::Waiting, 0);
                self.stop_measuring();
            }
            (JobAction::Show, _) => {
                let file = found.file.clone();
                if let Err(words) = show_in_folder(&file) {
                    self.told.push(words);
                }
            }
            (JobAction::Remove, Some(run)) => {
                run.end(now);
                self.queue.remove(job);
            }
            (JobAction::Remove, None) => self.queue.remove(job),
            (JobAction::Pause | JobAction::Continue, None) => {}
        }
    }

    fn stop_measuring(&mut self) {
        self.wanted = None;
        self.shown.estimate = Estimate::Unknown;
        if let Some(run) = self.run.as_mut().filter(|run| matches!(run.task, Task::Measure { .. })) {
            run.end(Instant::now());
        }
    }

    /// Ends a measurement that takes too long, and kills a process that does not end.
    fn end_overdue(&mut self, now: Instant) {
        let Some(run) = self.run.as_mut().filter(|run| run.due.is_some_and(|due| due <= now)) else { return };
        match &run.task {
            Task::Measure { measuring, folder } if !run.is_ending => {
                self.shown.estimate = measuring.estimate_early(&probe_file(folder));
                run.end(now);
            }
            _ => {
                run.process.kill();
                run.due = Some(now + PATIENCE);
            }
        }
    }

    /// Records a report of the process with this number.
    pub(super) fn record(&mut self, number: u64, report: VideoReport) {
        let Some(run) = self.run.as_mut().filter(|run| run.number == number) else { return };
        let now = Instant::now();
        match (&mut run.task, report) {
            (Task::Measure { measuring, .. }, VideoReport::Drawn { done, .. }) => measuring.record(done, now),
            (Task::Measure { .. }, VideoReport::Written { .. }) => {}
            (Task::Render { name, .. }, VideoReport::Written { name: written }) => *name = Some(written),
            (Task::Render { job, since, .. }, VideoReport::Drawn { done, of }) => {
                let (begun, before) = *since.get_or_insert((now, done));
                let each =
                    now.saturating_duration_since(begun).as_secs_f64() / (done - before.min(done)) as f64;
                let left = of.map(|of| of.saturating_sub(done) as f64 * each).filter(|left| left.is_finite());
                match self.queue.job(*job).map(|job| &mut job.state) {
                    Some(JobState::Paused { done: shown, of: total }) => (*shown, *total) = (done, of),
                    Some(state) => *state = JobState::Rendering { done, of, left },
                    None => {}
                }
            }
        }
    }

    /// Records that the process with this number has closed its output.
    pub(super) fn record_end(&mut self, number: u64) {
        let Some(VideoRun { process, task, is_ending, .. }) = self.run.take_if(|run| run.number == number)
        else {
            return;
        };
        let end = process.finish();
        match task {
            Task::Measure { measuring, folder } if !is_ending => {
                self.shown.estimate = match end {
                    End::Done => measuring.estimate(&probe_file(&folder)),
                    End::Refused(reason) => Estimate::Failed(reason),
                    End::Crashed(_) => Estimate::Unknown,
                };
            }
            Task::Measure { .. } => {}
            Task::Render { job, name, .. } => self.record_rendered(job, name, end),
        }
    }

    fn record_rendered(&mut self, job: u64, name: Option<String>, end: End) {
        // A removed video is no longer in the queue.
        let Some(job) = self.queue.job(job) else { return };
        let words = match end {
            End::Done => {
                if let Some(name) = name {
                    job.file.set_file_name(name);
                }
                job.state = JobState::Done;
                format!("the video is ready: {}", job.file.display())
            }
            End::Crashed(reason) if job.crashes == 0 => {
                job.crashes += 1;
                job.state = JobState::Waiting;
                tracing::warn!("rendering {} is tried again: {reason}", job.file.display());
                return;
            }
            End::Refused(reason) => {
                job.state = JobState::Failed(reason.clone());
                format!("the video {} was not made: {reason}", job.title)
            }
            End::Crashed(reason) => {
                let reason = format!("the renderer crashed twice, the last time with: {reason}");
                job.state = JobState::Failed(reason.clone());
                format!("the video {} was not made: {reason}", job.title)
            }
        };
        self.told.push(words);
    }

    /// Starts the next video, or else a measurement, unless a process is running.
    fn begin_next(&mut self) {
        while self.run.is_none() {
            if let Some(job) = self.queue.jobs.iter().find(|job| job.state == JobState::Waiting) {
                let (id, arguments, file) = (job.id, job.arguments.clone(), job.file.clone());
                let folder = file.parent().map_or(Ok(()), std::fs::create_dir_all);
                let folder = folder.map_err(|error| {
                    let folder = file.parent().unwrap_or(&file).display();
                    format!("the folder {folder} cannot be made ({error}): choose another folder")
                });
                let task = Task::Render { job: id, since: None, name: None };
                let begun = folder.and_then(|()| self.begin(task, &arguments, &file));
                let state = match begun {
                    Ok(()) => JobState::Rendering { done: 0, of: None, left: None },
                    Err(reason) => {
                        self.told.push(format!("the video was not made: {reason}"));
                        JobState::Failed(reason)
                    }
                };
                if let Some(job) = self.queue.job(id) {
                    job.state = state;
                }
            } else if let Some(measure) = self.wanted.take() {
                let folder = tempfile::tempdir().map_err(|error| error.to_string());
                let begun = folder.and_then(|folder| {
                    let (arguments, file) = (measure.arguments.clone(), probe_file(&folder));
                    let measuring = Measuring::begin(measure, Instant::now());
                    self.begin(Task::Measure { measuring, folder }, &arguments, &file)
                });
                self.shown.estimate = begun.map_or_else(Estimate::Failed, |()| Estimate::Measuring);
            } else {
                return;
            }
        }
    }

    fn begin(&mut self, task: Task, arguments: &[String], file: &Path) -> Result<(), String> {
        self.runs += 1;
        let (number, program) = (self.runs, self.folders.program.as_deref());
        let process = Process::start(program, arguments, file, number, self.events.0.clone())
            .map_err(|error| format!("Mariana cannot start itself ({error}): close other programs"))?;
        let due = match &task {
            Task::Measure { measuring, .. } => Some(measuring.ends_at()),
            Task::Render { .. } => None,
        };
        self.run = Some(VideoRun { number, process, task, due, is_ending: false });
        Ok(())
    }

    /// Keeps the queue and publishes it. Progress without other changes is published less often.
    fn publish(&mut self, shared: &Shared<Published>) {
        if let Some(Err(words)) = self.file.as_mut().map(|file| file.keep(&self.queue)) {
            self.told.push(words);
        }
        let now = Instant::now();
        let is_progress = self.shown.jobs.len() == self.queue.jobs.len()
            && self.shown.jobs.iter().zip(&self.queue.jobs).all(|(shown, job)| {
                std::mem::discriminant(&shown.state) == std::mem::discriminant(&job.state)
            });
        let is_recent = self.published.is_some_and(|at| now.saturating_duration_since(at) < PUBLISH_EVERY);
        if !(is_progress && is_recent) {
            self.shown.jobs.clone_from(&self.queue.jobs);
            self.published = Some(now);
        }
        self.told.iter().for_each(|words| tracing::info!("{words}"));
        let mut published = shared.lock();
        let is_new = published.shown != self.shown || !self.told.is_empty();
        published.shown.clone_from(&self.shown);
        published.news.extend(self.told.drain(..));
        drop(published);
        if is_new {
            (self.wake)();
        }
    }
}

impl VideoRun {
    fn renders(&self, id: u64) -> bool {
        matches!(self.task, Task::Render { job, .. } if job == id)
    }

    fn end(&mut self, now: Instant) {
        self.process.end();
        if !std::mem::replace(&mut self.is_ending, true) {
            self.due = Some(now + PATIENCE);
        }
    }
}

fn probe_file(folder: &TempDir) -> PathBuf {
    folder.path().join("probe.mp4")
}
