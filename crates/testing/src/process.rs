//! Programs that a test starts, and waiting for what they do.

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, ExitStatus};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// How long a test waits for anything.
pub const WAIT_LIMIT: Duration = Duration::from_secs(60);
/// How often it looks meanwhile.
pub const LOOK_PERIOD: Duration = Duration::from_millis(10);

/// A program that ends with the test, even if that panics.
pub struct Process(Child);

impl Process {
    /// Starts `command`, which the Debian package `package` brings.
    pub fn start(command: &mut Command, package: &str) -> Self {
        Self(command.spawn().unwrap_or_else(|error| missing(command, package, &error)))
    }

    /// The number under which the system knows it.
    pub fn id(&self) -> u32 {
        self.0.id()
    }

    /// Its standard output, which must be piped; once.
    pub fn stdout(&mut self) -> ChildStdout {
        self.0.stdout.take().expect("it is piped")
    }

    /// The process itself.
    pub fn child(&mut self) -> &mut Child {
        &mut self.0
    }

    /// How it ended, if it has.
    pub fn ended(&mut self) -> Option<ExitStatus> {
        self.0.try_wait().expect("it is a child of this program")
    }

    /// Ends it without asking.
    pub fn kill(&mut self) {
        // An error means that it has ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Runs `command` to its end: what it printed, or what went wrong.
pub fn output_of(command: &mut Command, package: &str) -> Result<Vec<u8>, String> {
    let output = command.output().unwrap_or_else(|error| missing(command, package, &error));
    if output.status.success() {
        return Ok(output.stdout);
    }
    Err(format!("{command:?}: {} {}", output.status, String::from_utf8_lossy(&output.stderr).trim()))
}

fn missing(command: &Command, package: &str, error: &std::io::Error) -> ! {
    let name = command.get_program().to_string_lossy();
    panic!(
        "{name} cannot be run ({error}): these tests need it, install the package that is '{package}' in Debian"
    );
}

/// Waits until `done`, and fails if that takes too long.
pub fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < WAIT_LIMIT, "{what} did not come");
        std::thread::sleep(LOOK_PERIOD);
    }
}

/// A folder that only this user may enter, as sound servers want theirs.
pub fn private_folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), Permissions::from_mode(0o700)).unwrap();
    folder
}

/// The environment of a program whose user's session is `folder`: it finds the sound server there and no other
/// sound, whatever the machine has.
pub fn session_environment(folder: &Path) -> [(&'static str, String); 4] {
    let path = folder.display().to_string();
    // An address that is set would win over the folder.
    let server = format!("unix:{path}/pulse/native");
    [
        ("XDG_RUNTIME_DIR", path.clone()),
        ("HOME", path),
        ("PULSE_SERVER", server),
        ("ALSA_CONFIG_PATH", "/dev/null".to_owned()),
    ]
}
