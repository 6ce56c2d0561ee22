//! A PulseAudio server of the test's own, whose null sink can be recorded.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mariana::dsp::StereoFrame;

use super::process::{Process, output_of, session_environment, wait_until};

/// Frames per second of the sink and of recordings.
pub const SINK_RATE: u32 = 48_000;

/// The server; it ends when dropped.
pub struct SoundServer(Process);

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
        let server = Self(Process::start(&mut command, "pulseaudio"));
        wait_until("the sound server's sink", || {
            let mut list = Command::new("pactl");
            list.args(["list", "short", "sinks"]).envs(session_environment(folder));
            output_of(&mut list, "pulseaudio-utils")
                .is_ok_and(|sinks| String::from_utf8_lossy(&sinks).contains("viz"))
        });
        server
    }

    /// Ends the server as a crash would.
    pub fn kill(mut self) {
        self.0.kill();
    }
}

/// Records what the sink plays.
pub struct Recorder {
    process: Process,
    frames: Arc<Mutex<Vec<StereoFrame>>>,
    reader: std::thread::JoinHandle<()>,
}

impl Recorder {
    /// Records from the server of the session in `folder`; returns when the first frames are there.
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

    /// What is played in the next so many seconds.
    pub fn next(&self, seconds: f64) -> Vec<StereoFrame> {
        let from = lock(&self.frames).len();
        let count = (seconds * f64::from(SINK_RATE)) as usize;
        wait_until("the recording", || lock(&self.frames).len() >= from + count);
        lock(&self.frames)[from..from + count].to_vec()
    }

    /// Ends the recording: all of it.
    pub fn finish(mut self) -> Vec<StereoFrame> {
        self.process.kill();
        self.reader.join().unwrap();
        std::mem::take(&mut lock(&self.frames))
    }
}

fn lock(frames: &Mutex<Vec<StereoFrame>>) -> MutexGuard<'_, Vec<StereoFrame>> {
    frames.lock().unwrap_or_else(PoisonError::into_inner)
}
