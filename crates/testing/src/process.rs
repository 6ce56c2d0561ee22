//! Child processes of tests, and waiting for conditions.

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, ExitStatus};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process_group};
use tempfile::TempDir;

/// Maximum time that a test waits for a condition. Only a program that hangs reaches it, also on a machine with other
/// work.
pub const WAIT_LIMIT: Duration = Duration::from_secs(240);
/// Polling interval while waiting.
pub const LOOK_PERIOD: Duration = Duration::from_millis(10);

/// A child process that is killed when the test ends, even if the test panics.
pub struct Process {
    child: Child,
    /// True if the processes that the child starts are killed too.
    has_group: bool,
}

impl Process {
    /// Starts `command`. `package` is the Debian package that contains the program.
    pub fn start(command: &mut Command, package: &str) -> Self {
        let child = command.spawn().unwrap_or_else(|error| missing(command, package, &error));
        Self { child, has_group: false }
    }

    /// Like [`Self::start`], for a program that starts others, which would outlive it.
    pub fn start_group(command: &mut Command, package: &str) -> Self {
        let mut process = Self::start(command.process_group(0), package);
        process.has_group = true;
        process
    }

    /// The process id.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Takes the standard output, which must be piped. Call this only once.
    pub fn stdout(&mut self) -> ChildStdout {
        self.child.stdout.take().expect("the standard output is piped and not taken yet")
    }

    /// The child process.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Returns the exit status if the process has ended.
    pub fn ended(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().expect("the process is a child")
    }

    /// Kills the process.
    pub fn kill(&mut self) {
        // Killing fails if the process has ended.
        if self.has_group
            && let Some(group) = Pid::from_raw(self.child.id().cast_signed())
        {
            let _ = kill_process_group(group, Signal::KILL);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Runs `command` and returns its standard output, or an error message.
pub fn output_of(command: &mut Command, package: &str) -> Result<Vec<u8>, String> {
    let output = command.output().unwrap_or_else(|error| missing(command, package, &error));
    if output.status.success() {
        return Ok(output.stdout);
    }
    Err(format!("{command:?}: {} {}", output.status, String::from_utf8_lossy(&output.stderr).trim()))
}

fn missing(command: &Command, package: &str, error: &std::io::Error) -> ! {
    let name = command.get_program().to_string_lossy();
    panic!("{name} cannot be run ({error}): these tests need it; install the Debian package '{package}'");
}

/// Waits until `done` returns true. Panics after [`WAIT_LIMIT`] with a message about `what`.
pub fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < WAIT_LIMIT, "timed out waiting for {what}");
        std::thread::sleep(LOOK_PERIOD);
    }
}

/// A folder that only this user can access, as sound servers require.
pub fn private_folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::set_permissions(folder.path(), Permissions::from_mode(0o700)).unwrap();
    folder
}

/// Returns environment variables for a program whose session is in `folder`. The program finds the sound server in
/// `folder`, but no sound devices of the machine.
pub fn session_environment(folder: &Path) -> [(&'static str, String); 4] {
    let path = folder.display().to_string();
    // Set the address explicitly, because an address in the environment would take precedence over the folder.
    let server = format!("unix:{path}/pulse/native");
    [
        ("XDG_RUNTIME_DIR", path.clone()),
        ("HOME", path),
        ("PULSE_SERVER", server),
        ("ALSA_CONFIG_PATH", "/dev/null".to_owned()),
    ]
}
