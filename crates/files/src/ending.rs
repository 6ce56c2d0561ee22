//! The end of the process: signals, clean-up and the final exit.
//!
//! Jobs that write files end at once, because drawing a frame may take a minute and a pipe may never be read. A
//! thread waits for SIGINT, SIGTERM and SIGHUP. It removes temporary files and ends ffmpeg ([`begin`] registers such
//! steps), prints a message and exits with `_exit` ([`end_now`]). A show ends in its event loop instead: the loop
//! calls [`asked_to_end`] when it is woken.
//!
//! ffmpeg runs in a separate process group, so that Ctrl-C reaches Mariana alone. The writer of a temporary file
//! holds a lock on the file, which the kernel releases if the process is killed: the next run that writes into the
//! folder removes the files that this run can lock.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::process::Command;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A signal that asks the program to end. Its number is the same on every Unix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Signal {
    /// The terminal was closed.
    HangUp = 1,
    /// Ctrl-C.
    Interrupt = 2,
    /// The default signal of `kill`.
    Terminate = 15,
}

impl Signal {
    const ALL: [Self; 3] = [Self::HangUp, Self::Interrupt, Self::Terminate];

    fn of(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| *signal as u8 == number)
    }

    /// Returns the exit code that shells report for a program that this signal ended: 128 plus the signal's number.
    pub fn exit_code(self) -> u8 {
        128 + self as u8
    }
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::HangUp => "SIGHUP",
            Self::Interrupt => "SIGINT",
            Self::Terminate => "SIGTERM",
        })
    }
}

/// Signals within this time after the first signal count as the same request, because `timeout` and service managers
/// send several signals.
const ONE_REQUEST: Duration = Duration::from_secs(1);

/// The number of the first received signal; 0 before that.
static ASKED: AtomicU8 = AtomicU8::new(0);

/// Returns the signal that asked the program to end, if any. Requires a call of [`watch`].
pub fn asked_to_end() -> Option<Signal> {
    Signal::of(ASKED.load(Ordering::Acquire))
}

/// Handles signals that ask the program to end. The first signal calls `answer` on a separate thread. A signal at
/// least a second later ends the process with [`end_now`]. A signal that is ignored at the start, as under `nohup`,
/// stays ignored. Call this once.
///
/// # Errors
/// Fails with the system's error if the thread or the handlers cannot be created. Signals then end the process as
/// usual.
#[cfg(unix)]
pub fn watch(answer: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    let ignored = ignored_signals();
    let wanted = Signal::ALL.into_iter().filter(|signal| ignored >> (*signal as u8 - 1) & 1 == 0);
    let mut signals = signal_hook::iterator::Signals::new(wanted.map(|signal| i32::from(signal as u8)))?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        let mut first = None;
        for number in signals.forever() {
            if let Some(signal) = u8::try_from(number).ok().and_then(Signal::of) {
                answer_signal(signal, &mut first, &answer);
            }
        }
    })?;
    Ok(())
}

/// As on Unix, for Ctrl-C and for the end of the console or of the user's session.
///
/// # Errors
/// Fails with the system's error if the handler cannot be set.
#[cfg(windows)]
pub fn watch(answer: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    let mut first = None;
    ctrlc::set_handler(move || answer_signal(Signal::Interrupt, &mut first, &answer))
        .map_err(io::Error::other)
}

/// Answers the first signal. A signal that is no part of the same request ends the process.
fn answer_signal(signal: Signal, first: &mut Option<Instant>, answer: &impl Fn(Signal)) {
    let now = Instant::now();
    match *first {
        None => {
            *first = Some(now);
            ASKED.store(signal as u8, Ordering::Release);
            answer(signal);
        }
        Some(first) if now.duration_since(first) < ONE_REQUEST => {}
        Some(_) => end_now(signal, || ()),
    }
}

/// Starts `command` apart from the terminal, so that Ctrl-C reaches only Mariana, which then ends the process. On
/// Windows the process gets no window either.
pub fn apart_from_terminal(command: &mut Command) -> &mut Command {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(windows)]
    {
        /// `CREATE_NO_WINDOW` of CreateProcess.
        const NO_WINDOW: u32 = 0x0800_0000;
        std::os::windows::process::CommandExt::creation_flags(command, NO_WINDOW);
    }
    command
}

/// Returns the ignored signals as bits, or 0 on systems without `/proc`.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok()).unwrap_or(0)
}

/// Turns a write beyond the user's file size limit into an error, as on a full disk. By default the signal SIGXFSZ
/// would end the process.
pub fn outlive_file_limits() {
    #[cfg(unix)]
    {
        use std::sync::atomic::AtomicBool;
        /// This flag is never read: handling the signal is enough to make the write fail.
        static TAKEN: AtomicBool = AtomicBool::new(false);
        // If the registration fails, the default action stays.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &TAKEN);
    }
}

type Step = Box<dyn FnOnce() + Send>;

/// The steps to run if the process ends now. The keys are the numbers of the [`Undo`]s. Code that ends the process
/// never releases the lock, so that no job starts or finishes during the end.
static UNDO: Mutex<BTreeMap<u64, Step>> = Mutex::new(BTreeMap::new());

fn undo_list() -> MutexGuard<'static, BTreeMap<u64, Step>> {
    UNDO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A registered step that runs if the process ends early. Dropping it unregisters the step.
#[must_use]
#[derive(Debug)]
pub struct Undo(u64);

/// Starts a job that must be undone if the process ends before the returned [`Undo`] is dropped or settled. `start`
/// starts the job and returns the step that undoes it. The process can end before `start` or after it, but not during
/// it, so no job lacks its step. `start` and the step must not block for long, call `begin`, or drop an [`Undo`].
///
/// # Errors
/// Fails with the error of `start`.
pub fn begin<T, S, E>(start: impl FnOnce() -> Result<(T, S), E>) -> Result<(T, Undo), E>
where
    S: FnOnce() + Send + 'static,
{
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let mut list = undo_list();
    let (begun, step) = start()?;
    list.insert(number, Box::new(step));
    Ok((begun, Undo(number)))
}

impl Undo {
    /// Runs `last` and unregisters the step. The process can end before or after both, but not in between.
    pub fn settle<T>(self, last: impl FnOnce() -> T) -> T {
        let mut list = undo_list();
        let done = last();
        list.remove(&self.0);
        std::mem::forget(self);
        done
    }
}

impl Drop for Undo {
    fn drop(&mut self) {
        let step = undo_list().remove(&self.0);
        // The lock is released here.
        drop(step);
    }
}

/// Runs all registered steps, the latest first, then `say`, and ends the process with the signal's exit code.
pub fn end_now(signal: Signal, say: impl FnOnce()) -> ! {
    let mut list = undo_list();
    undo_all(&mut list);
    say();
    leave_at_once(signal.exit_code())
}

fn undo_all(list: &mut BTreeMap<u64, Step>) {
    while let Some((_, step)) = list.pop_last() {
        step();
    }
}

/// Marks the end of `main`. Signals have no effect while this exists.
pub struct Leaving {
    list: MutexGuard<'static, BTreeMap<u64, Step>>,
}

/// Starts to leave. Does not return if a signal is already ending the process.
pub fn begin_to_leave() -> Leaving {
    Leaving { list: undo_list() }
}

impl Leaving {
    /// Runs all registered steps and ends the process with `code`, without the exit handlers of drivers and
    /// libraries. Exit handlers would free data that driver threads may still use: Mesa 22.3 compiles for AMD on such
    /// threads and crashes.
    pub fn leave(mut self, code: u8) -> ! {
        undo_all(&mut self.list);
        // Ignore a closed standard output.
        let _ = io::stdout().flush();
        let _ = io::stderr().flush();
        leave_at_once(code)
    }
}

fn leave_at_once(code: u8) -> ! {
    #[cfg(unix)]
    signal_hook::low_level::exit(code.into());
    #[cfg(not(unix))]
    std::process::exit(code.into());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_have_the_codes_that_shells_give_them() {
        assert_eq!(Signal::ALL.map(Signal::exit_code), [129, 130, 143]);
        assert_eq!(Signal::ALL.map(|signal| Signal::of(signal as u8)), Signal::ALL.map(Some));
        assert_eq!((Signal::of(0), Signal::of(9)), (None, None));
    }

    #[test]
    fn settled_and_dropped_steps_are_unregistered() {
        let listed = |undo: &Undo| undo_list().contains_key(&undo.0);
        let begun = || begin(|| Ok::<_, ()>(((), || ()))).unwrap().1;
        let (kept, settled, forgotten) = (begun(), begun(), begun());
        let numbers = [settled.0, forgotten.0];
        assert_eq!(settled.settle(|| 7), 7);
        drop(forgotten);
        assert!(listed(&kept));
        assert!(numbers.iter().all(|number| !undo_list().contains_key(number)));
    }

    #[test]
    fn the_process_cannot_end_before_the_step_is_registered() {
        let start = || Ok::<_, ()>((UNDO.try_lock().is_err(), || ()));
        assert!(begin(start).unwrap().0, "the process could end before the step is registered");
        let failed = begin(|| Err::<((), fn()), _>(7)).unwrap_err();
        assert_eq!(failed, 7);
    }
}
