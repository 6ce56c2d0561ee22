//! `mariana video --controlled`: a video that a window renders in a process of its own.

use std::io::BufRead;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use anyhow::Context;

use crate::ending::{self, Signal};
use crate::export::print::{print_line, tell};
use crate::export::video::{CONTINUE, PAUSE, VideoReport, Written};

/// The priority of the process. With the lowest priority, 19, a window with a software renderer would leave the video
/// no time.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// The connection to the window.
pub(super) struct Controlled {
    is_paused: Arc<(Mutex<bool>, Condvar)>,
}

impl Controlled {
    /// Lowers the priority of this process, and starts to obey standard input. The end of standard input ends the
    /// process, because the window has cancelled the video or is gone.
    ///
    /// # Errors
    /// Fails if no thread can be started.
    pub(super) fn begin() -> anyhow::Result<Self> {
        // Later threads, and ffmpeg, inherit the priority.
        #[cfg(target_os = "linux")]
        let _ = rustix::process::setpriority_process(None, NICENESS);
        let is_paused = Arc::new((Mutex::new(false), Condvar::new()));
        let obeying = is_paused.clone();
        let obey = move || {
            for line in std::io::stdin().lock().lines() {
                let Ok(line) = line else { break };
                let (paused, changed) = &*obeying;
                let mut paused = paused.lock().unwrap_or_else(PoisonError::into_inner);
                *paused = if line == PAUSE { true } else { *paused && line != CONTINUE };
                changed.notify_all();
            }
            ending::end_now(Signal::HangUp, || {
                tell("the window has ended the video; unfinished files are removed");
            });
        };
        std::thread::Builder::new()
            .name("window".into())
            .spawn(obey)
            .context("no thread can be started: close other programs")?;
        Ok(Self { is_paused })
    }

    /// Reports that `done` of `of` frames are drawn. Waits while the window has paused the video.
    pub(super) fn reach(&self, done: u64, of: Option<u64>) {
        // A window that no longer reads has ended the standard input too.
        let _ = report(&VideoReport::Drawn { done, of });
        let (paused, changed) = &*self.is_paused;
        let paused = paused.lock().unwrap_or_else(PoisonError::into_inner);
        drop(changed.wait_while(paused, |paused| *paused));
    }

    /// Reports the finished video.
    ///
    /// # Errors
    /// Fails if standard output cannot be written.
    pub(super) fn finish(self, written: &Written) -> anyhow::Result<()> {
        let name = written.file.as_deref().and_then(|file| file.file_name()).unwrap_or_default();
        report(&VideoReport::Written { name: name.to_string_lossy().into_owned() })
    }
}

fn report(report: &VideoReport) -> anyhow::Result<()> {
    Ok(print_line(&serde_json::to_string(report)?)?)
}
