//! `--controlled`: a video or a thumbnail that a window draws in a separate process.

use std::io::BufRead;
use std::time::Duration;

use anyhow::Context;

use crate::ending::{self, Signal};
use crate::export::print::{print_line, print_message};
use crate::export::video::{CONTINUE, PAUSE, VideoReport, Written};
use mariana_player::lower_priority;
use mariana_work::{Latest, Shared, looping};

/// The priority of a video. With [`LOWEST`], a window with a software renderer would leave the video no time.
const VIDEO_NICENESS: i32 = 10;
/// The lowest priority.
const LOWEST: i32 = 19;

/// The connection to the window.
pub(super) struct Controlled {
    is_paused: Latest<bool>,
}

impl Controlled {
    /// Lowers the priority of this process, and starts to obey standard input. The end of standard input ends the
    /// process, because the window has cancelled the video or is gone.
    ///
    /// # Errors
    /// Fails if no thread can be started.
    pub(super) fn begin() -> anyhow::Result<Self> {
        let is_paused = end_with_input(VIDEO_NICENESS, |line, paused| {
            *paused = if line == PAUSE { true } else { *paused && line != CONTINUE };
        })?;
        Ok(Self { is_paused })
    }

    /// Reports that `done` of `of` frames are drawn. Waits while the window has paused the video.
    pub(super) fn reach(&self, done: u64, of: Option<u64>) {
        // A window that no longer reads has ended the standard input too.
        let _ = report(&VideoReport::Drawn { done, of });
        drop(self.is_paused.wait_while(Duration::MAX, |paused| *paused));
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
    end_with_input(LOWEST, |_, _| ()).map(drop)
}

/// Sets the priority, which later threads and ffmpeg inherit. A new thread calls `obey` with each line of standard input
/// and the returned state, and ends the process after the last line.
fn end_with_input(niceness: i32, obey: fn(String, &mut bool)) -> anyhow::Result<Latest<bool>> {
    lower_priority(niceness);
    let watch = move |shared: &Shared<bool>| {
        let lines = std::io::stdin().lock().lines().map_while(Result::ok);
        lines.for_each(|line| shared.change(|state| obey(line, state)));
        ending::end_now(Signal::HangUp, || {
            print_message("the window has ended this work; unfinished files are removed")
        });
    };
    looping("window", false, watch).context("no thread can be started: close other programs")
}

fn report(report: &VideoReport) -> anyhow::Result<()> {
    Ok(print_line(&serde_json::to_string(report)?)?)
}
