//! A user's session with a sound server of its own, for tests that use sound within their own process.

use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempDir;

use super::process::{private_folder, session_environment};
use super::sound_server::{Recorder, SoundServer};

/// The server is found by an environment variable, which belongs to the whole process: one test at a time.
static ENVIRONMENT: Mutex<()> = Mutex::new(());

/// A folder that stands for the user's session, maybe with a PulseAudio server.
pub struct Session {
    server: Option<SoundServer>,
    folder: TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Session {
    /// Without a sound server.
    pub fn without_server() -> Self {
        let alone = ENVIRONMENT.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = private_folder();
        for (name, value) in session_environment(folder.path()) {
            set_environment(name, &value);
        }
        Self { server: None, folder, _alone: alone }
    }

    /// With a server whose one output, viz, is there already.
    pub fn with_server() -> Self {
        let mut session = Self::without_server();
        session.start_server();
        session
    }

    /// Starts the server.
    pub fn start_server(&mut self) {
        self.server = Some(SoundServer::start(self.folder.path()));
    }

    /// Ends the server as a crash would.
    pub fn kill_server(&mut self) {
        self.server.take().expect("a server").kill();
    }

    /// The server, which must run.
    pub fn server(&self) -> &SoundServer {
        self.server.as_ref().expect("a server")
    }

    /// Records what viz plays.
    pub fn record(&self) -> Recorder {
        Recorder::start(self.folder.path())
    }
}

#[allow(unsafe_code)]
fn set_environment(name: &str, value: &str) {
    // SAFETY: every test holds `ENVIRONMENT` while its threads run, and nothing else in such a program writes the
    // environment.
    unsafe { std::env::set_var(name, value) }
}
