//! The process that renders a video.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use super::worker::{Event, Worker};
use crate::ending::apart_from_terminal;
use crate::export::video::{CONTINUE, PAUSE, last_messages};

/// Longest wait for the end of a process that has closed its output.
const END_LIMIT: Duration = Duration::from_secs(5);
const LOOK_PERIOD: Duration = Duration::from_millis(5);
/// The exit code of a process that has reported an error.
const REFUSED: i32 = 1;

pub(super) struct Process {
    child: Child,
    /// The end of the input ends the process.
    input: Option<ChildStdin>,
    messages: File,
}

/// The end of a process.
#[derive(Debug, PartialEq)]
pub(super) enum End {
    Done,
    /// It reported this error.
    Refused(String),
    /// It ended without an error of its own.
    Crashed(String),
}

impl Process {
    /// Starts a process with these arguments of `mariana video`, which writes `file`. Its reports and its end become
    /// events with the number `run`. `program` is the executable; `None` for the running one.
    ///
    /// # Errors
    /// Fails if the process or the thread that reads its reports cannot be started.
    pub(super) fn start(
        program: Option<&Path>,
        arguments: &[String],
        file: &Path,
        run: u64,
        events: Sender<Event>,
    ) -> io::Result<Self> {
        let mut command = command(program)?;
        let messages = tempfile::tempfile()?;
        command.args(["video", "--controlled", "-o"]).arg(file).args(arguments);
        // A software renderer with fewer threads leaves a core to the window.
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        command.env("LP_NUM_THREADS", (cores / 2).max(1).to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(messages.try_clone()?);
        let mut child = apart_from_terminal(&mut command).spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let process = Self { child, input, messages };
        std::thread::Builder::new().name("video reports".into()).spawn(move || {
            for line in output.into_iter().flat_map(|output| BufReader::new(output).lines()) {
                let report = line.ok().and_then(|line| serde_json::from_str(&line).ok());
                if let Some(report) = report
                    && events.send(Box::new(move |worker: &mut Worker| worker.record(run, report))).is_err()
                {
                    return;
                }
            }
            let _ = events.send(Box::new(move |worker: &mut Worker| worker.record_end(run)));
        })?;
        Ok(process)
    }

    pub(super) fn set_paused(&mut self, paused: bool) {
        let line = if paused { PAUSE } else { CONTINUE };
        if let Some(input) = &mut self.input {
            // A process that has ended is noticed by the end of its output.
            let _ = writeln!(input, "{line}").and_then(|()| input.flush());
        }
    }

    /// Asks the process to end and to remove its unfinished files.
    pub(super) fn end(&mut self) {
        self.input = None;
    }

    pub(super) fn kill(&mut self) {
        let _ = self.child.kill();
    }

    /// Waits for the end of a process that has closed its output.
    pub(super) fn finish(mut self) -> End {
        let begun = Instant::now();
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break status,
                Ok(None) if begun.elapsed() < END_LIMIT => std::thread::sleep(LOOK_PERIOD),
                Ok(None) => {
                    self.kill();
                    let _ = self.child.wait();
                    return End::Crashed("it did not end".to_owned());
                }
                Err(error) => return End::Crashed(error.to_string()),
            }
        };
        if status.success() {
            return End::Done;
        }
        match (status.code(), last_sentence(&mut self.messages)) {
            (Some(REFUSED), Some(sentence)) => End::Refused(for_window(&sentence)),
            (_, Some(sentence)) => End::Crashed(sentence),
            (_, None) => End::Crashed(status.to_string()),
        }
    }
}

/// The program that renders. An update may have replaced the running executable.
fn command(program: Option<&Path>) -> io::Result<Command> {
    if let Some(program) = program {
        return Ok(Command::new(program));
    }
    let running = std::env::current_exe()?;
    let loaded = Path::new("/proc/self/exe");
    let is_replaced = !running.exists() && loaded.exists();
    Ok(Command::new(if is_replaced { loaded } else { &running }))
}

/// Opens the folder of `file` in the desktop's file manager.
pub(super) fn show_in_folder(file: &Path) -> Result<(), String> {
    let opener = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let folder = file.parent().unwrap_or(file);
    let mut command = Command::new(opener);
    command.arg(folder).stdin(Stdio::null()).stdout(Stdio::null());
    let child = command.stderr(Stdio::null()).spawn();
    let mut child = child.map_err(|error| {
        format!(
            "the folder {} cannot be shown ({opener}: {error}): open it in a file manager",
            folder.display()
        )
    })?;
    // The program may run as long as the file manager; another thread waits for its end.
    let _ = std::thread::Builder::new().name("folder".into()).spawn(move || child.wait());
    Ok(())
}

/// The last sentence that the program reported to its user.
fn last_sentence(messages: &mut File) -> Option<String> {
    let tail = last_messages(messages);
    let last = tail.lines().rev().find(|line| !line.trim().is_empty())?;
    let own = tail.lines().rev().find_map(|line| line.strip_prefix("mariana: "));
    Some(own.unwrap_or(last).to_owned())
}

/// Replaces advice about flags, which a window does not have.
fn for_window(sentence: &str) -> String {
    let Some(flag) = ["-o ", "-o;", " --"].into_iter().filter_map(|flag| sentence.find(flag)).min() else {
        return sentence.to_owned();
    };
    let before = &sentence[..flag];
    if let Some((rest, _)) = before.rsplit_once(", or ") {
        return rest.to_owned();
    }
    let rest = before.rsplit_once(": ").map_or(before, |(rest, _)| rest);
    let advice = if sentence.contains("--start") { "an earlier part" } else { "another folder" };
    format!("{rest}: choose {advice}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_file::Unwritable;
    use crate::export::ExportError;
    use crate::export::video::{failed, loop_too_long, no_encoder};

    #[test]
    fn advice_about_flags_becomes_advice_about_the_panel() {
        let path = std::path::PathBuf::from("/v/a - o.mp4");
        let missing = no_encoder(io::ErrorKind::NotFound.into()).to_string();
        assert!(for_window(&missing).ends_with("install ffmpeg"), "{missing}");
        let full = failed(&path, "No space left on device");
        assert_eq!(
            for_window(&full.to_string()),
            "ffmpeg could not write /v/a - o.mp4 (No space left on device): choose another folder"
        );
        let refused = ExportError::from(Unwritable::new(&path, &io::ErrorKind::PermissionDenied.into()));
        assert_eq!(
            for_window(&refused.to_string()),
            "/v/a - o.mp4 cannot be written (permission denied): choose another folder"
        );
        let long = loop_too_long(8.0, 9.0, 4.0);
        assert!(for_window(&long.to_string()).ends_with("are left: choose an earlier part"));
        assert_eq!(
            for_window("a.flac cannot be opened: check the path"),
            "a.flac cannot be opened: check the path"
        );
    }
}
