//! A thread that writes files, because disks may be slow and the show must not wait.

use std::cell::Cell;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// Runs jobs in order and returns their results. Dropping it waits until all jobs are finished.
pub(super) struct WriterThread<Job, Done> {
    jobs: Option<Sender<Job>>,
    done: Receiver<Done>,
    thread: Option<JoinHandle<()>>,
    /// The number of jobs whose result has not been polled.
    open: Cell<usize>,
}

impl<Job: Send + 'static, Done: Send + 'static> WriterThread<Job, Done> {
    /// Starts a thread of this name that runs each job with `work`. If the thread cannot start, no job is accepted.
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

    /// Queues a job. Returns false if it will not run.
    pub(super) fn give(&self, job: Job) -> bool {
        let is_given = self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        self.open.update(|open| open + usize::from(is_given));
        is_given
    }

    pub(super) fn poll(&self) -> Option<Done> {
        let done = self.done.try_recv().ok();
        self.open.update(|open| open - usize::from(done.is_some()));
        done
    }

    pub(super) fn is_idle(&self) -> bool {
        self.open.get() == 0
    }

    /// Finishes the remaining jobs, accepts no more, and returns the results that have not been polled.
    pub(super) fn finish(&mut self) -> Vec<Done> {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        self.open.set(0);
        self.done.try_iter().collect()
    }

    #[cfg(test)]
    pub(super) fn wait(&self) -> Option<Done> {
        let done = self.done.recv().ok();
        self.open.update(|open| open - usize::from(done.is_some()));
        done
    }
}

impl<Job, Done> Drop for WriterThread<Job, Done> {
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
    fn jobs_run_in_order_and_finish_before_drop_returns() {
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
