//! `--controlled`: a video or a thumbnail that a window draws in a separate process.

use std::io::BufRead;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use anyhow::Context;

use crate::ending::{self, Signal};
use crate::export::print::{print_line, print_message};
use crate::export::video::{CONTINUE, PAUSE, VideoReport, Written};

/// The priority of a video. With [`LOWEST`], a window with a software renderer would leave the video no time.
const VIDEO_NICENESS: i32 = 10;
/// The lowest priority.
const LOWEST: i32 = 19;

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
        let is_paused = Arc::new((Mutex::new(false), Condvar::new()));
        let obeying = is_paused.clone();
        end_with_input(VIDEO_NICENESS, move |line| {
            let (paused, changed) = &*obeying;
            let mut paused = paused.lock().unwrap_or_else(PoisonError::into_inner);
            *paused = if line == PAUSE { true } else { *paused && line != CONTINUE };
            changed.notify_all();
        })?;
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

/// Lowers the priority of this process to the lowest, and ends the process when standard input ends, because the window
/// that started it is gone.
///
/// # Errors
/// Fails if no thread can be started.
pub(super) fn draw_for_window() -> anyhow::Result<()> {
    end_with_input(LOWEST, |_| ())
}

/// Sets the priority, which later threads and ffmpeg inherit. A new thread calls `obey` with each line of standard input,
/// and ends the process after the last.
fn end_with_input(niceness: i32, mut obey: impl FnMut(String) + Send + 'static) -> anyhow::Result<()> {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, niceness);
    #[cfg(not(target_os = "linux"))]
    let _ = niceness;
    let watch = move || {
        std::io::stdin().lock().lines().map_while(Result::ok).for_each(&mut obey);
        ending::end_now(Signal::HangUp, || {
            print_message("the window has ended this work; unfinished files are removed")
        });
    };
    let thread = std::thread::Builder::new().name("window".into()).spawn(watch);
    thread.context("no thread can be started: close other programs")?;
    Ok(())
}

fn report(report: &VideoReport) -> anyhow::Result<()> {
    Ok(print_line(&serde_json::to_string(report)?)?)
}
