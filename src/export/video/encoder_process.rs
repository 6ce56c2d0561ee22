//! The encoder's process. It reads frames from a pipe, and is killed when it makes no progress for too long.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{ChildStdin, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime};

use crate::child::{ChildLimits, ChildProcess};
use crate::ending::{self, Undo};
use mariana_work::{Latest, lock, looping};

/// Only this many bytes at the end of the process's messages are read.
const MESSAGE_BYTES: u64 = 4096;
/// Time between two checks if the process has ended.
const LOOK_PERIOD: Duration = Duration::from_millis(5);
/// Longest time between two checks if the process makes progress.
const WATCH_PERIOD: Duration = Duration::from_secs(1);
/// Bytes written to the pipe at once. Each piece counts as progress.
const PIECE_BYTES: usize = 1 << 16;

/// A running encoder. The encoder is killed when Mariana ends, or when this value is dropped.
pub(super) struct EncoderProcess {
    child: Arc<Mutex<ChildProcess>>,
    /// `None` once the process has got all input.
    input: Option<ChildStdin>,
    /// The process writes its messages into this file. A pipe could become full and block the process.
    reported_problems: File,
    watch: Latest<Wait>,
    _end: Undo,
}

#[derive(Default)]
struct Wait {
    /// Time of the last progress, at first the start of the wait; `None` outside of waits.
    since: Option<Instant>,
    has_stalled: bool,
}

impl EncoderProcess {
    /// Starts a process that writes `output`. During a wait, the process is killed after `patience` without progress.
    ///
    /// # Errors
    /// Fails if the system cannot start the program or the watching thread, or cannot share the file for messages.
    pub(super) fn start(
        mut command: Command,
        output: &Path,
        reported_problems: File,
        patience: Duration,
    ) -> io::Result<Self> {
        let heard = reported_problems.try_clone()?;
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(heard);
        let (child, end) = ending::begin(|| {
            let child = Arc::new(Mutex::new(ChildProcess::start(&mut command, ChildLimits::default())?));
            let its = child.clone();
            io::Result::Ok((child, move || lock(&its).kill()))
        })?;
        let input = lock(&child).child().stdin.take();
        let (output, its) = (output.to_owned(), child.clone());
        let watch = looping("encoder watch", Wait::default(), move |shared| {
            let mut last = stamp(&output);
            loop {
                shared.rest(WATCH_PERIOD.min(patience / 4));
                if shared.is_over() {
                    return;
                }
                let now = stamp(&output);
                let writes = std::mem::replace(&mut last, now) != now;
                let mut wait = shared.lock();
                if wait.is_too_long(Instant::now(), writes, patience) {
                    wait.has_stalled = true;
                    return lock(&its).kill();
                }
            }
        })?;
        Ok(Self { child, input, reported_problems, watch, _end: end })
    }

    /// Writes input.
    ///
    /// # Errors
    /// Fails if the process has ended.
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Some(input) = &mut self.input else { return Ok(()) };
        self.watch.lock().since = Some(Instant::now());
        let written = bytes.chunks(PIECE_BYTES).try_for_each(|piece| {
            input.write_all(piece)?;
            self.watch.lock().since = Some(Instant::now());
            Ok(())
        });
        self.watch.lock().since = None;
        written
    }

    /// Closes the input and waits for the process. Meanwhile, signal handlers can lock the mutex and kill the process.
    ///
    /// # Errors
    /// Fails if the system reports an error, or if the process made no progress and was killed.
    pub(super) fn wait(&mut self) -> io::Result<ExitStatus> {
        self.input = None;
        self.watch.lock().since = Some(Instant::now());
        let status = loop {
            if let Some(status) = lock(&self.child).ended().transpose() {
                break status;
            }
            if self.has_stalled() {
                // The killed process is stuck in a system call.
                break Err(io::ErrorKind::TimedOut.into());
            }
            std::thread::sleep(LOOK_PERIOD);
        };
        self.watch.lock().since = None;
        status
    }

    pub(super) fn has_stalled(&self) -> bool {
        self.watch.lock().has_stalled
    }

    pub(super) fn complaint(&mut self) -> String {
        last_messages(&mut self.reported_problems)
    }
}

/// Returns the end of the messages that a process has written into a file.
pub(crate) fn last_messages(file: &mut File) -> String {
    let mut tail = Vec::new();
    // If reading fails, an incomplete message is better than none.
    let length = file.seek(SeekFrom::End(0)).unwrap_or(0);
    let _ = file.seek(SeekFrom::Start(length.saturating_sub(MESSAGE_BYTES)));
    let _ = file.read_to_end(&mut tail);
    String::from_utf8_lossy(&tail).into_owned()
}

impl Drop for EncoderProcess {
    fn drop(&mut self) {
        // If the encoder still runs, an error has occurred, and its output is useless.
        lock(&self.child).kill();
    }
}

impl Wait {
    /// Returns true if the process has made no progress for `patience` at `now`. `writes` is true if output was
    /// written since the last call.
    fn is_too_long(&mut self, now: Instant, writes: bool, patience: Duration) -> bool {
        let Some(since) = &mut self.since else { return false };
        if writes {
            *since = now;
        }
        now.saturating_duration_since(*since) >= patience
    }
}

/// Returns the size and modification time of a file, to detect writes.
fn stamp(file: &Path) -> Option<(u64, SystemTime)> {
    let file = std::fs::metadata(file).ok()?;
    Some((file.len(), file.modified().ok()?))
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    fn start(cue_list: &str) -> EncoderProcess {
        let mut command = Command::new("sh");
        command.args(["-c", cue_list]);
        let reported_problems = tempfile::tempfile().unwrap();
        EncoderProcess::start(command, Path::new("none"), reported_problems, Duration::from_millis(200))
            .unwrap()
    }

    #[test]
    fn a_hung_encoder_was_waited_for_without_limit() {
        // More bytes than a pipe holds.
        let much = vec![0; 1 << 20];
        let mut encoder = start("exec sleep 1000");
        assert!(
            encoder.write(&much).is_err() && encoder.has_stalled(),
            "the process does not read its input"
        );
        let mut encoder = start("exec 3<&0; sleep 1000 & wait");
        assert!(
            encoder.write(&much).is_err() && encoder.has_stalled(),
            "a child of the process holds the pipe"
        );
        let mut encoder = start("cat > /dev/null; exec sleep 1000");
        encoder.write(&[0; 1000]).unwrap();
        assert!(!encoder.wait().is_ok_and(|status| status.success()), "the process did not fail");
        assert!(encoder.has_stalled());
    }

    #[test]
    fn only_a_wait_without_progress_is_too_long() {
        let start = Instant::now();
        let after = |seconds: u64| start + Duration::from_secs(seconds);
        let patience = Duration::from_secs(10);
        let mut wait = Wait { since: Some(start), has_stalled: false };
        assert!(!wait.is_too_long(after(9), true, patience));
        assert!(!wait.is_too_long(after(18), false, patience));
        assert!(wait.is_too_long(after(19), false, patience));
        // Slow drawing of a frame does not count as a wait.
        wait.since = None;
        assert!(!wait.is_too_long(after(1000), false, patience));
    }
}
