//! A child process that writes to a pipe. All waits for the process are limited, and it never outlives its [`Process`].

use std::io::{self, Read};
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mariana_files::child::{ChildLimits, ChildProcess};
use mariana_work::{Background, lock};

use super::{CommandLine, file_address};
use crate::limits;

const PIECE: usize = 1 << 15;

const PIECES_WAITING: usize = 4;

/// Maximum number of bytes that are kept from the end of the program's error messages.
const WORDS_MAX: usize = 1 << 12;

/// A film of 8K by many threads takes about 2 GB. The programs write only into pipes.
const LIMITS: ChildLimits = ChildLimits { memory: Some(4 << 30), cpu_seconds: None, file: Some(0) };

/// Maximum wait for the end of a program that has closed its pipe.
const END_LIMIT: Duration = Duration::from_millis(500);

#[derive(Debug)]
pub(crate) enum Failure {
    Missing,
    Start(io::Error),
    /// The program's last error message.
    Refused(String),
    /// The reason why the program's output is useless.
    Useless(String),
}

impl Failure {
    fn stalled() -> Self {
        Self::Useless(format!("ffmpeg returned no data for {} s", limits::FFMPEG_WAIT_SECONDS))
    }
}

/// A running program. Dropping this value kills the program. If Mariana ends, the pipe closes and ends the program.
pub(crate) struct Process {
    child: ChildProcess,
    pieces: Receiver<Vec<u8>>,
    words: Arc<Mutex<Vec<u8>>>,
    patience: Duration,
}

impl Process {
    pub(crate) fn start(line: CommandLine, patience: Duration) -> Result<Self, Failure> {
        let mut command = line.command();
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = ChildProcess::start(&mut command, LIMITS).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => Failure::Missing,
            _ => Failure::Start(error),
        })?;
        let (to_reader, pieces) = sync_channel(PIECES_WAITING);
        let words = Arc::new(Mutex::new(Vec::new()));
        let (stdout, stderr) = (child.child().stdout.take(), child.child().stderr.take());
        // From here on, dropping `process` ends the program on every return.
        let process = Self { child, pieces, words: words.clone(), patience };
        if let Some(stdout) = stdout {
            read_on(stdout, move |piece| to_reader.send(piece).is_ok())?;
        }
        if let Some(stderr) = stderr {
            let keep = move |piece| {
                let mut words = lock(&words);
                words.extend(piece);
                let surplus = words.len().saturating_sub(WORDS_MAX);
                words.drain(..surplus);
                true
            };
            read_on(stderr, keep)?;
        }
        Ok(process)
    }

    pub(crate) fn next(&mut self) -> Result<Option<Vec<u8>>, Failure> {
        match self.pieces.recv_timeout(self.patience) {
            Ok(piece) => Ok(Some(piece)),
            Err(RecvTimeoutError::Disconnected) => Ok(None),
            Err(RecvTimeoutError::Timeout) => Err(Failure::stalled()),
        }
    }

    pub(crate) fn all(&mut self, limit: usize) -> Result<Vec<u8>, Failure> {
        let start = Instant::now();
        let mut all = Vec::new();
        while let Some(piece) = self.next()? {
            all.extend(piece);
            if all.len() > limit || start.elapsed() > self.patience {
                return Err(Failure::stalled());
            }
        }
        Ok(all)
    }

    /// True if the program succeeded. Call this method after the program has closed its pipe.
    pub(super) fn succeeded(&mut self) -> bool {
        matches!(self.child.ended_within(END_LIMIT), Ok(Some(status)) if status.success())
    }

    /// The program's last error message about the file at `path`.
    pub(crate) fn refusal(&mut self, path: &Path) -> Failure {
        Failure::Refused(self.complaint(&file_address(path).to_string_lossy()))
    }

    /// The last error message, on one line and without `path`. Call this method after the program has closed its pipe.
    pub(crate) fn complaint(&mut self, path: &str) -> String {
        // Wait until the program has ended, so that its error messages are complete.
        self.succeeded();
        let words = lock(&self.words);
        let words = String::from_utf8_lossy(&words);
        let last = words.lines().rev().map(str::trim).find(|line| !line.is_empty());
        let last = last.unwrap_or("no error message").replace(path, "");
        crate::one_line::one_line(last.trim_start_matches([':', ' ']))
    }

    #[cfg(test)]
    pub(crate) fn id(&mut self) -> u32 {
        self.child.child().id()
    }
}

/// Reads pieces on a thread until the end, or until `take` wants no more.
fn read_on(
    mut from: impl Read + Send + 'static,
    mut take: impl FnMut(Vec<u8>) -> bool + Send + 'static,
) -> Result<(), Failure> {
    let read = move || while read_piece(&mut from).is_some_and(&mut take) {};
    Background::start("ffmpeg", read).map(drop).map_err(Failure::Start)
}

fn read_piece(from: &mut impl Read) -> Option<Vec<u8>> {
    let mut piece = vec![0; PIECE];
    let count = loop {
        match from.read(&mut piece) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            read => break read.ok()?,
        }
    };
    piece.truncate(count);
    (count > 0).then_some(piece)
}
