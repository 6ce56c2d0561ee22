//! What writes files on a thread of its own: a disk may be slow, and the show waits for none.

use std::cell::Cell;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// Does jobs one after the other, and tells what became of each. All that were given are done before it is gone.
pub(super) struct WriterThread<Job, Done> {
    jobs: Option<Sender<Job>>,
    done: Receiver<Done>,
    thread: Option<JoinHandle<()>>,
    /// Jobs whose result was not taken yet.
    open: Cell<usize>,
}

impl<Job: Send + 'static, Done: Send + 'static> WriterThread<Job, Done> {
    /// Does jobs by `work` from now on, on a thread of this name. Without a thread it does none.
    pub(super) fn start(name: &str, mut work: impl FnMut(Job) -> Done + Send + 'static) -> Self {
        let (jobs, inbox) = channel::<Job>();
        let (reported, done) = channel();
        let go_on = move || {
            for job in inbox {
                let _ = reported.send(work(job));
            }
        };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(go_on).ok();
        Self { jobs: thread.is_some().then_some(jobs), done, thread, open: Cell::new(0) }
    }

    /// Gives it a job. Returns whether it will be done.
    pub(super) fn give(&self, job: Job) -> bool {
        let is_given = self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        self.open.update(|open| open + usize::from(is_given));
        is_given
    }

    /// The result of the next job that is done.
    pub(super) fn poll(&self) -> Option<Done> {
        let done = self.done.try_recv().ok();
        self.open.update(|open| open - usize::from(done.is_some()));
        done
    }

    /// Returns `true` once the results of all jobs were taken.
    pub(super) fn is_idle(&self) -> bool {
        self.open.get() == 0
    }

    /// Does the remaining jobs, takes no more, and returns the results that were not taken.
    pub(super) fn finish(&mut self) -> Vec<Done> {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        self.open.set(0);
        self.done.try_iter().collect()
    }

    /// Waits for what becomes of a job.
    #[cfg(test)]
    pub(super) fn wait(&self) -> Option<Done> {
        let done = self.done.recv().ok();
        self.open.update(|open| open - usize::from(done.is_some()));
        done
    }
}

impl<Job, Done> Drop for WriterThread<Job, Done> {
    /// Nothing is lost that was to be written.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_are_done_in_their_order_and_before_it_is_gone() {
        let (reported, hears) = channel();
        let writer_thread = WriterThread::start("test", move |job: u32| {
            let _ = reported.send(job);
            2 * job
        });
        assert!((1..=3).all(|job| writer_thread.give(job)));
        assert_eq!(writer_thread.wait(), Some(2));
        drop(writer_thread);
        assert_eq!(hears.iter().collect::<Vec<_>>(), [1, 2, 3]);
    }
}
