//! The program as a command-line user runs it. Tests set arguments, and check exit code, text and files.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

use tempfile::TempDir;

use super::desktop::{PROGRAM, command_in};
use mariana_testing::process::{LOOK_PERIOD, Process, WAIT_LIMIT, output_of, private_folder};
use mariana_testing::wave::write_wav;

/// Words of advice to the user. Each refusal contains at least one of them.
const ADVICE: &[&str] = &[
    "split", "change", "check", "choose", "convert", "correct", "end", "export", "fetch", "give", "install",
    "leave", "name", "remove", "save", "send", "set", "start", "unset", "update", "write",
];

/// Internal details that messages to users must not contain: panics, paths of source code, temporary files.
const INTERNALS: &[&str] =
    &["panicked", "RUST_BACKTRACE", "stack backtrace", ".rs:", ".cargo", "unwrap()", ".mariana-"];

/// A working folder for the program. The program has neither a display nor sound.
pub(crate) struct Workplace {
    folder: TempDir,
    /// The folder of the user session. It is separate, so that `folder` contains only files of the test and output of
    /// the program.
    session: TempDir,
}

impl Workplace {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), session: private_folder() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        let path = self.path(name);
        std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Writes a stereo wave file at 48 kHz: `seconds` of a sine of `hz`, with the peaks `left` and `right`.
    pub(crate) fn write_tone(&self, name: &str, hz: f64, seconds: f64, [left, right]: [f64; 2]) {
        let frames = (seconds * 48_000.0) as usize;
        let samples = (0..frames).flat_map(|frame| {
            let sine = (std::f64::consts::TAU * hz * frame as f64 / 48_000.0).sin();
            [(left * sine) as f32, (right * sine) as f32]
        });
        write_wav(&self.path(name), 48_000, 2, samples);
    }

    pub(crate) fn ffmpeg(&self, arguments: &[&str], output: &str) {
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-nostdin", "-y"]).args(arguments).arg(self.path(output));
        output_of(command.current_dir(self.folder.path()), "ffmpeg")
            .unwrap_or_else(|error| panic!("{error}"));
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = command_in(PROGRAM, self.session.path(), None);
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        // EGL_LOG_LEVEL hides the driver's messages. All tests share a shader cache.
        command.env("EGL_LOG_LEVEL", "fatal").env("MESA_SHADER_CACHE_DIR", env!("CARGO_TARGET_TMPDIR"));
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(&mut self.command(arguments))
    }
}

#[derive(Debug)]
pub(crate) struct Outcome {
    pub command: String,
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Leaves out the lines about progress: how many there are depends on the machine.
fn without_progress(messages: &str) -> String {
    let is_progress = |line: &&str| {
        ["mariana: frame ", "mariana: path "].iter().any(|begin| line.starts_with(begin))
            && line.contains(" a second")
    };
    messages.split_inclusive('\n').filter(|line| !is_progress(line)).collect()
}

impl Outcome {
    /// Runs `command`. Fails if the command hangs or is ended by a signal.
    pub(crate) fn of(command: &mut Command) -> Self {
        let (stdout, stderr) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
        command.stdout(stdout.try_clone().unwrap()).stderr(stderr.try_clone().unwrap());
        Self::with_files(command, stdout, stderr)
    }

    pub(crate) fn printing_elsewhere(command: &mut Command, stdout: impl Into<Stdio>) -> Self {
        let stderr = tempfile::tempfile().unwrap();
        command.stdout(stdout).stderr(stderr.try_clone().unwrap());
        Self::with_files(command, tempfile::tempfile().unwrap(), stderr)
    }

    fn with_files(command: &mut Command, stdout: File, stderr: File) -> Self {
        let shown =
            command.get_args().map(|argument| argument.to_string_lossy()).collect::<Vec<_>>().join(" ");
        let shown = format!("mariana {shown}");
        let start = Instant::now();
        let mut process = Process::start(command, "mariana");
        let status = loop {
            if let Some(status) = process.ended() {
                break status;
            }
            assert!(
                start.elapsed() < WAIT_LIMIT,
                "{shown}: still running after {WAIT_LIMIT:?}: {}",
                text_of(stderr)
            );
            std::thread::sleep(LOOK_PERIOD);
        };
        let (stdout, stderr) = (text_of(stdout), without_progress(&text_of(stderr)));
        let code = status.code().unwrap_or_else(|| panic!("{shown}: {status}: {stderr}"));
        for internal in INTERNALS {
            assert!(!stderr.contains(internal), "{shown}: '{internal}' in a message to users: {stderr}");
        }
        Self { command: shown, code, stdout, stderr }
    }

    /// Returns standard output. Fails unless the run succeeded without a message.
    pub(crate) fn done(self) -> String {
        assert!(self.code == 0 && self.stderr.is_empty(), "{self:?}");
        self.stdout
    }

    /// Returns the message of a refusal. Fails unless the exit code is 1 and the message is one line that contains all
    /// `parts`.
    pub(crate) fn refused(self, parts: &[&str]) -> String {
        assert!(self.stderr.lines().count() == 1, "expected a message of one line: {self:?}");
        self.refused_with_details(parts)
    }

    /// Like [`Self::refused`], for a message that is followed by a driver's log.
    pub(crate) fn refused_with_details(self, parts: &[&str]) -> String {
        assert!(self.code == 1 && self.stdout.is_empty(), "{self:?}");
        self.assert_advises();
        for part in parts {
            assert!(self.stderr.contains(part), "'{part}' is missing in the message: {self:?}");
        }
        self.stderr
    }

    /// Fails unless the message begins with the program's name and contains advice for the user.
    pub(crate) fn assert_advises(&self) {
        assert!(self.stderr.starts_with("mariana: "), "{self:?}");
        assert!(
            ADVICE.iter().any(|word| self.stderr.contains(word)),
            "the message does not advise the user: \
            {self:?}"
        );
    }

    /// Fails unless the arguments were refused: exit code 2 and a message that contains `option` and all `parts`.
    pub(crate) fn refused_arguments(&self, option: &str, parts: &[&str]) {
        assert!(self.code == 2 && self.stdout.is_empty(), "{self:?}");
        let sentence = self.stderr.lines().next().unwrap_or_default();
        for part in [&["error: ", option], parts].concat() {
            assert!(sentence.contains(part), "'{part}' is missing in the message: {self:?}");
        }
    }
}

fn text_of(mut file: File) -> String {
    let mut text = String::new();
    file.rewind().unwrap();
    file.read_to_string(&mut text).unwrap();
    text
}

pub(crate) struct Format {
    pub file: &'static str,
    /// The arguments with which ffmpeg writes this format.
    pub arguments: &'static [&'static str],
}

const fn format(file: &'static str, arguments: &'static [&'static str]) -> Format {
    Format { file, arguments }
}

pub(crate) const FORMATS: &[Format] = &[
    format("song.wav", &["-c:a", "pcm_s16le"]),
    format("song.aiff", &["-c:a", "pcm_s24be"]),
    format("song.flac", &["-c:a", "flac"]),
    format("song.mp3", &["-c:a", "libmp3lame", "-b:a", "128k"]),
    format("vorbis.ogg", &["-c:a", "libvorbis"]),
    format("song.opus", &["-c:a", "libopus"]),
    format("aac.m4a", &["-c:a", "aac"]),
    format("alac.m4a", &["-c:a", "alac"]),
    format("song.caf", &["-c:a", "pcm_s16le"]),
    format("song.mkv", &["-c:a", "flac"]),
    format("song.webm", &["-c:a", "libopus"]),
];
