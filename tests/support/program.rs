//! The program as its users run it: arguments in, an exit code, text and files out.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::desktop::{PROGRAM, command_in};
use mariana_testing::process::{LOOK_PERIOD, Process, output_of, private_folder};
use mariana_testing::wave::write_wav;

/// How long the program may take for anything asked of it here.
pub(crate) const RUN_LIMIT: Duration = Duration::from_secs(60);

/// Words that tell the user what to do; every refusal has at least one.
const ADVICE: &[&str] = &[
    "split", "change", "check", "choose", "convert", "correct", "end", "export", "fetch", "give", "install",
    "name", "save", "send", "set", "start", "unset", "update", "write",
];

/// What must not stand in anything that users read: panics, and places in source code.
const INTERNALS: &[&str] =
    &["panicked", "RUST_BACKTRACE", "stack backtrace", ".rs:", ".cargo", "unwrap()", ".mariana-"];

/// A folder of its own in which the program runs: without a display, without sound.
pub(crate) struct Workplace {
    folder: TempDir,
    /// Apart, so that the folder holds the test's files and the program's output only.
    session: TempDir,
}

impl Workplace {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), session: private_folder() }
    }

    /// The path of a file in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file in the folder.
    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    /// The bytes of a file in the folder.
    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        let path = self.path(name);
        std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The names in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// A stereo wave file of `seconds` of sines of `hz` with the peaks `left` and `right`, at 48 kHz.
    pub(crate) fn write_tone(&self, name: &str, hz: f64, seconds: f64, [left, right]: [f64; 2]) {
        let frames = (seconds * 48_000.0) as usize;
        let samples = (0..frames).flat_map(|frame| {
            let sine = (std::f64::consts::TAU * hz * frame as f64 / 48_000.0).sin();
            [(left * sine) as f32, (right * sine) as f32]
        });
        write_wav(&self.path(name), 48_000, 2, samples);
    }

    /// Has ffmpeg write `output`, which must work.
    pub(crate) fn ffmpeg(&self, arguments: &[&str], output: &str) {
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-nostdin", "-y"]).args(arguments).arg(self.path(output));
        output_of(command.current_dir(self.folder.path()), "ffmpeg")
            .unwrap_or_else(|error| panic!("{error}"));
    }

    /// The program with `arguments`, to be started.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = command_in(PROGRAM, self.session.path(), None);
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        // The driver's own words are not the program's; its compiled shaders serve every test.
        command.env("EGL_LOG_LEVEL", "fatal").env("MESA_SHADER_CACHE_DIR", env!("CARGO_TARGET_TMPDIR"));
        command
    }

    /// Runs the program with `arguments`.
    pub(crate) fn run(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(&mut self.command(arguments), RUN_LIMIT)
    }
}

/// How the program ended.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// What was run.
    pub command: String,
    /// The exit code.
    pub code: i32,
    /// What it printed.
    pub stdout: String,
    /// What it complained of.
    pub stderr: String,
}

impl Outcome {
    /// Runs `command`, which must end by itself within `limit` and not by a signal.
    pub(crate) fn of(command: &mut Command, limit: Duration) -> Self {
        let (stdout, stderr) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
        command.stdout(stdout.try_clone().unwrap()).stderr(stderr.try_clone().unwrap());
        Self::with_files(command, limit, stdout, stderr)
    }

    /// The same for a command whose standard output goes elsewhere.
    pub(crate) fn printing_elsewhere(command: &mut Command, stdout: impl Into<Stdio>) -> Self {
        let stderr = tempfile::tempfile().unwrap();
        command.stdout(stdout).stderr(stderr.try_clone().unwrap());
        Self::with_files(command, RUN_LIMIT, tempfile::tempfile().unwrap(), stderr)
    }

    fn with_files(command: &mut Command, limit: Duration, stdout: File, stderr: File) -> Self {
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
                start.elapsed() < limit,
                "{shown}: it has not ended after {limit:?}: {}",
                text_of(stderr)
            );
            std::thread::sleep(LOOK_PERIOD);
        };
        let (stdout, stderr) = (text_of(stdout), text_of(stderr));
        let code = status.code().unwrap_or_else(|| panic!("{shown}: {status}: {stderr}"));
        for internal in INTERNALS {
            assert!(!stderr.contains(internal), "{shown}: users do not want to read '{internal}': {stderr}");
        }
        Self { command: shown, code, stdout, stderr }
    }

    /// What it printed, the job being done without a complaint.
    pub(crate) fn done(self) -> String {
        assert!(self.code == 0 && self.stderr.is_empty(), "{self:?}");
        self.stdout
    }

    /// The sentence with which it refuses the job, which holds all `parts`: code 1, one line, nothing printed.
    pub(crate) fn refused(self, parts: &[&str]) -> String {
        assert!(self.stderr.lines().count() == 1, "one sentence is wanted: {self:?}");
        self.refused_with_details(parts)
    }

    /// The same where a driver's log follows the sentence.
    pub(crate) fn refused_with_details(self, parts: &[&str]) -> String {
        assert!(self.code == 1 && self.stdout.is_empty(), "{self:?}");
        self.assert_advises();
        for part in parts {
            assert!(self.stderr.contains(part), "'{part}' is not told: {self:?}");
        }
        self.stderr
    }

    /// Fails unless what it complains of begins with its name and says what to do.
    pub(crate) fn assert_advises(&self) {
        assert!(self.stderr.starts_with("mariana: "), "{self:?}");
        assert!(ADVICE.iter().any(|word| self.stderr.contains(word)), "what is to be done? {self:?}");
    }

    /// Fails unless the arguments were refused, naming the option and holding all `parts`: code 2.
    pub(crate) fn refused_arguments(&self, option: &str, parts: &[&str]) {
        assert!(self.code == 2 && self.stdout.is_empty(), "{self:?}");
        let sentence = self.stderr.lines().next().unwrap_or_default();
        for part in [&["error: ", option], parts].concat() {
            assert!(sentence.contains(part), "'{part}' is not told: {self:?}");
        }
    }
}

fn text_of(mut file: File) -> String {
    let mut text = String::new();
    file.rewind().unwrap();
    file.read_to_string(&mut text).unwrap();
    text
}

/// A way to store sound.
pub(crate) struct Format {
    /// A file's name.
    pub file: &'static str,
    /// What makes ffmpeg write it.
    pub arguments: &'static [&'static str],
}

const fn format(file: &'static str, arguments: &'static [&'static str]) -> Format {
    Format { file, arguments }
}

/// Every format that users may bring.
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
