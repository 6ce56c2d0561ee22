//! Processes that Mariana starts: each is killed when its [`ChildProcess`] is dropped, and has limits.
//!
//! If Mariana itself is killed, no code of it runs. A child therefore also ends when its pipe to Mariana closes: ffmpeg
//! cannot write any more, and `mariana still --controlled` and `mariana video --controlled` watch their standard input.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

use crate::ending::apart_from_terminal;

/// Longest wait for the end of a killed process, which may be stuck in a system call.
const KILL_LIMIT: Duration = Duration::from_secs(1);
const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// Limits that the kernel enforces, on Linux. Other systems know no such limits for a running process.
#[derive(Debug, Clone, Copy, Default)]
pub struct ChildLimits {
    /// Bytes of memory that the process may ask for; more is refused.
    pub memory: Option<u64>,
    /// Seconds of CPU time, after which the process is killed.
    pub cpu_seconds: Option<u64>,
    /// Bytes of a file that the process writes.
    pub file: Option<u64>,
}

/// A process that is killed on drop, together with the processes of its group.
#[derive(Debug)]
pub struct ChildProcess(Child);

impl ChildProcess {
    /// Starts `command` apart from the terminal (see [`apart_from_terminal`]).
    ///
    /// # Errors
    /// Fails with the system's error if the process cannot be started.
    pub fn start(command: &mut Command, limits: ChildLimits) -> io::Result<Self> {
        let process = Self(apart_from_terminal(command).spawn()?);
        process.set_limits(limits);
        Ok(process)
    }

    /// The process with its pipes.
    pub fn child(&mut self) -> &mut Child {
        &mut self.0
    }

    /// Returns the exit status if the process has ended.
    ///
    /// # Errors
    /// Fails with the system's error.
    pub fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        self.0.try_wait()
    }

    /// Returns the exit status if the process ends within `limit`.
    ///
    /// # Errors
    /// Fails with the system's error.
    pub fn ended_within(&mut self, limit: Duration) -> io::Result<Option<ExitStatus>> {
        let start = Instant::now();
        loop {
            let ended = self.ended()?;
            if ended.is_some() || start.elapsed() >= limit {
                return Ok(ended);
            }
            std::thread::sleep(LOOK_PERIOD);
        }
    }

    /// Kills the process and its children, because the children may hold a pipe open. Returns when it has ended, at the
    /// latest after a second.
    pub fn kill(&mut self) {
        if !matches!(self.ended(), Ok(None)) {
            return;
        }
        // An error means that the process has already ended.
        #[cfg(target_os = "linux")]
        let _ = rustix::process::kill_process_group(
            rustix::process::Pid::from_child(&self.0),
            rustix::process::Signal::KILL,
        );
        let _ = self.0.kill();
        if !matches!(self.ended_within(KILL_LIMIT), Ok(Some(_))) {
            tracing::debug!("a killed process did not end");
        }
    }

    #[cfg(target_os = "linux")]
    fn set_limits(&self, limits: ChildLimits) {
        use rustix::process::{Pid, Resource, Rlimit, prlimit};
        let process = Some(Pid::from_child(&self.0));
        // `Data` counts memory that the process can write. `As` would count what drivers only reserve.
        let limits = [
            (Resource::Data, limits.memory),
            (Resource::Cpu, limits.cpu_seconds),
            (Resource::Fsize, limits.file),
        ];
        for (resource, limit) in limits {
            if limit.is_some()
                && let Err(error) = prlimit(process, resource, Rlimit { current: limit, maximum: limit })
            {
                tracing::debug!("a process has no limit: {error}");
            }
        }
    }

    #[cfg(not(target_os = "linux"))]
    fn set_limits(&self, _: ChildLimits) {}
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        self.kill();
    }
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use std::process::Stdio;

    use super::*;

    fn shell(script: &str, limits: ChildLimits) -> ChildProcess {
        let mut command = Command::new("sh");
        command.args(["-c", script]).stdin(Stdio::piped()).stderr(Stdio::null()).env("LC_ALL", "C");
        ChildProcess::start(&mut command, limits).unwrap()
    }

    #[test]
    fn a_child_ends_at_its_limits() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        let ends = |script: &str, limits| {
            // The limits are set while the script waits for a line.
            let mut process = shell(&format!("read line; {script}"), limits);
            io::Write::write_all(&mut process.child().stdin.take().unwrap(), b"begin\n").unwrap();
            process.ended_within(Duration::from_secs(30)).unwrap().expect("no end in 30 s")
        };
        let writes = format!("head -c 100000 /dev/zero > {}", file.display());
        let asks = "exec dd if=/dev/zero of=/dev/null bs=50000000 count=1";
        let turns = "while :; do :; done";
        assert!(ends(&writes, ChildLimits::default()).success());
        assert!(!ends(&writes, ChildLimits { file: Some(9000), ..ChildLimits::default() }).success());
        assert!(!ends(turns, ChildLimits { cpu_seconds: Some(1), ..ChildLimits::default() }).success());
        assert!(!ends(asks, ChildLimits { memory: Some(20_000_000), ..ChildLimits::default() }).success());
        assert_eq!(std::fs::metadata(&file).unwrap().len(), 9000);
    }

    #[test]
    fn a_dropped_child_ends_with_its_own_children() {
        let mut process = shell("sleep 1000 & wait", ChildLimits::default());
        let child = i32::try_from(process.child().id()).unwrap();
        drop(process);
        let group = rustix::process::Pid::from_raw(child);
        let alive = || rustix::process::test_kill_process_group(group.unwrap()).is_ok();
        let start = Instant::now();
        while alive() && start.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(LOOK_PERIOD);
        }
        assert!(!alive());
    }
}
