//! A user session with a private sound server, for tests that play sound in the test process.

use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempDir;

use super::process::{private_folder, session_environment};
use super::sound_server::{Recorder, SoundServer};

/// Each [`Session`] holds this lock: the server's address is in the environment of the process, so only one session
/// may exist.
static ENVIRONMENT: Mutex<()> = Mutex::new(());

/// A private session folder, optionally with a PulseAudio server.
pub struct Session {
    server: Option<SoundServer>,
    folder: TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Session {
    /// Creates a session without a sound server.
    pub fn without_server() -> Self {
        let alone = ENVIRONMENT.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = private_folder();
        for (name, value) in session_environment(folder.path()) {
            set_environment(name, &value);
        }
        Self { server: None, folder, _alone: alone }
    }

    /// Creates a session with a running server and its sink viz.
    pub fn with_server() -> Self {
        let mut session = Self::without_server();
        session.start_server();
        session
    }

    /// Starts the sound server.
    pub fn start_server(&mut self) {
        self.server = Some(SoundServer::start(self.folder.path()));
    }

    /// Kills the server, as a crash would.
    pub fn kill_server(&mut self) {
        self.server.take().expect("the server runs").kill();
    }

    /// The server, which must be running.
    pub fn server(&self) -> &SoundServer {
        self.server.as_ref().expect("the server runs")
    }

    /// Starts to record the sink viz.
    pub fn record(&self) -> Recorder {
        Recorder::start(self.folder.path())
    }
}

#[allow(unsafe_code)]
fn set_environment(name: &str, value: &str) {
    // SAFETY: each `Session` holds the lock `ENVIRONMENT`, so only one thread calls this at a time. No other code in
    // such a test program writes the environment, and a test creates its session before its threads start.
    unsafe { std::env::set_var(name, value) }
}
