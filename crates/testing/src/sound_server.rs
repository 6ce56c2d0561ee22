//! A private PulseAudio server for a test, with a null sink that can be recorded.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::process::{Process, output_of, session_environment, wait_until};

/// Sample rate of the sink and of recordings, in Hz.
pub const SINK_RATE: u32 = 48_000;

/// A sound server. Dropping it ends the server.
pub struct SoundServer {
    process: Process,
    folder: PathBuf,
}

impl SoundServer {
    /// Starts the server of the session in `folder`, with a null sink named viz.
    pub fn start(folder: &Path) -> Self {
        let mut command = Command::new("pulseaudio");
        command
            .args(["-n", "--daemonize=no", "--exit-idle-time=-1", "--use-pid-file=no", "--disable-shm=yes"])
            .args(["-L", "module-native-protocol-unix"])
            .args([
                "-L",
                &format!("module-null-sink sink_name=viz rate={SINK_RATE} format=float32le norewinds=1"),
            ])
            .envs(session_environment(folder))
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let server = Self { process: Process::start(&mut command, "pulseaudio"), folder: folder.to_owned() };
        wait_until("the sound server's sink", || {
            let mut list = Command::new("pactl");
            list.args(["list", "short", "sinks"]).envs(session_environment(folder));
            output_of(&mut list, "pulseaudio-utils")
                .is_ok_and(|sinks| String::from_utf8_lossy(&sinks).contains("viz"))
        });
        server
    }

    /// Kills the server, as a crash would.
    pub fn kill(mut self) {
        self.process.kill();
    }

    /// The process id.
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// Runs a `pactl` command and returns its output.
    pub fn ask(&self, arguments: &[&str]) -> String {
        let mut command = Command::new("pactl");
        command.args(arguments).envs(session_environment(&self.folder));
        let said = output_of(&mut command, "pulseaudio-utils").unwrap_or_else(|error| panic!("{error}"));
        String::from_utf8_lossy(&said).trim().to_owned()
    }

    /// Adds a null sink with this name. Returns the id for [`Self::unplug`].
    pub fn plug(&self, name: &str, options: &[&str]) -> String {
        let name = format!("sink_name={name}");
        self.ask(&[&["load-module", "module-null-sink", &name, "norewinds=1"], options].concat())
    }

    /// Removes a sink added by [`Self::plug`].
    pub fn unplug(&self, plugged: &str) {
        self.ask(&["unload-module", plugged]);
    }

    /// Makes a sink the default.
    pub fn set_default(&self, name: &str) {
        self.ask(&["set-default-sink", name]);
    }

    /// Plays a tone of `hz` on a sink until the returned process is dropped, for at most one minute.
    pub fn play_tone(&self, output: &str, hz: f64) -> Process {
        let path = self.folder.join(format!("tone-{hz}.raw"));
        let samples = (0..60 * SINK_RATE).flat_map(|n| {
            let sample = (std::f64::consts::TAU * hz * f64::from(n) / f64::from(SINK_RATE)).sin() as f32;
            (0.5 * sample).to_le_bytes()
        });
        std::fs::write(&path, samples.collect::<Vec<u8>>()).unwrap();
        let mut command = Command::new("pacat");
        command
            .args(["--playback", "--raw", "--format=float32le", "--channels=1", "--latency-msec=20"])
            .arg(format!("--rate={SINK_RATE}"))
            .arg(format!("--device={output}"))
            .arg(&path)
            .envs(session_environment(&self.folder))
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        Process::start(&mut command, "pulseaudio-utils")
    }
}

/// A recording of the sink viz.
pub struct Recorder {
    process: Process,
    frames: Arc<Mutex<Vec<[f32; 2]>>>,
    reader: std::thread::JoinHandle<()>,
}

impl Recorder {
    /// Starts to record from the server of the session in `folder`. Returns when the first sample frames have
    /// arrived.
    pub fn start(folder: &Path) -> Self {
        let mut command = Command::new("parec");
        command
            .args(["--device=viz.monitor", "--format=float32le", "--channels=2", "--latency-msec=20"])
            .arg(format!("--rate={SINK_RATE}"))
            .envs(session_environment(folder))
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = Process::start(&mut command, "pulseaudio-utils");
        let mut output = process.stdout();
        let frames = Arc::new(Mutex::new(Vec::new()));
        let recorded = frames.clone();
        let reader = std::thread::spawn(move || {
            let mut bytes = Vec::new();
            let mut block = [0_u8; 4096];
            while let Ok(count @ 1..) = output.read(&mut block) {
                bytes.extend_from_slice(&block[..count]);
                let whole = bytes.len() / 8 * 8;
                let sample = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                let heard = bytes
                    .drain(..whole)
                    .as_slice()
                    .chunks_exact(8)
                    .map(|frame| [sample(&frame[..4]), sample(&frame[4..])])
                    .collect::<Vec<_>>();
                lock(&recorded).extend(heard);
            }
        });
        let recorder = Self { process, frames, reader };
        wait_until("the recording", || !lock(&recorder.frames).is_empty());
        recorder
    }

    /// Waits for the next `seconds` of sound and returns them.
    pub fn next(&self, seconds: f64) -> Vec<[f32; 2]> {
        let from = lock(&self.frames).len();
        let count = (seconds * f64::from(SINK_RATE)) as usize;
        wait_until("the recording", || lock(&self.frames).len() >= from + count);
        lock(&self.frames)[from..from + count].to_vec()
    }

    /// Ends the recording and returns all of it.
    pub fn finish(mut self) -> Vec<[f32; 2]> {
        self.process.kill();
        self.reader.join().unwrap();
        std::mem::take(&mut lock(&self.frames))
    }
}

fn lock(frames: &Mutex<Vec<[f32; 2]>>) -> MutexGuard<'_, Vec<[f32; 2]>> {
    frames.lock().unwrap_or_else(PoisonError::into_inner)
}
