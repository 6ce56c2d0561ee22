//! How the process ends: what happens at a signal that asks for the end, what is undone before it, and the last step.
//!
//! A job that writes files ends wherever it is, be it in a draw that takes a minute or in a write to a program that
//! does not read: the thread that waits for signals removes unfinished files ([`begin`]) and ends the process.
//! A show ends by itself: it asks [`asked_to_end`] when it is woken.
//!
//! **A job ends where it is.** A thread waits for SIGINT, SIGTERM and SIGHUP. It removes the unfinished files, ends
//! ffmpeg, says so and leaves with `_exit`, because a draw may take a minute and a pipe may never be read. ffmpeg has
//! a process group of its own, so that Ctrl-C reaches Mariana alone. The writer of an unfinished file holds a lock on
//! it, which the kernel releases when the process is killed: the next run that writes into the folder removes the
//! files that it can lock.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A signal that asks the program to end, with its number, which is the same on every Unix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Signal {
    /// The terminal is gone.
    HangUp = 1,
    /// Ctrl-C.
    Interrupt = 2,
    /// A polite kill.
    Terminate = 15,
}

impl Signal {
    const ALL: [Self; 3] = [Self::HangUp, Self::Interrupt, Self::Terminate];

    fn of(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| *signal as u8 == number)
    }

    /// The exit code that shells report for a program ended by a signal: 128 plus the signal's number.
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

/// How long after the first signal others count as the same request: `timeout` and service managers send several.
const ONE_REQUEST: Duration = Duration::from_secs(1);

/// The number of the first signal that asked for the end; 0 if none did.
static ASKED: AtomicU8 = AtomicU8::new(0);

/// The signal that asked for the end, if one did. [`watch`] must have been called.
pub fn asked_to_end() -> Option<Signal> {
    Signal::of(ASKED.load(Ordering::Acquire))
}

/// From now on the first signal that asks for the end calls `answer`, on a thread of its own, instead of ending the
/// process as signals do. A signal that comes a second later or more ends the process by [`end_now`]. If whoever
/// started the program had it ignore a signal, as `nohup` does, it stays ignored. To be called once.
///
/// # Errors
/// What the system says about threads and signals; then signals end the process as usual.
#[cfg(unix)]
pub fn watch(answer: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    let ignored = ignored_signals();
    let wanted = Signal::ALL.into_iter().filter(|signal| ignored >> (*signal as u8 - 1) & 1 == 0);
    let mut signals = signal_hook::iterator::Signals::new(wanted.map(|signal| i32::from(signal as u8)))?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        let mut first = None;
        for number in signals.forever() {
            let Some(signal) = u8::try_from(number).ok().and_then(Signal::of) else { continue };
            let now = std::time::Instant::now();
            match first {
                None => {
                    first = Some(now);
                    ASKED.store(signal as u8, Ordering::Release);
                    answer(signal);
                }
                Some(first) if now.duration_since(first) < ONE_REQUEST => {}
                Some(_) => end_now(signal, || ()),
            }
        }
    })?;
    Ok(())
}

/// On these systems there are no such signals.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn watch(_answer: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    Ok(())
}

/// The ignored signals, as bits, on systems that report them without a call to C.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok()).unwrap_or(0)
}

/// Makes a file that would grow beyond the user's limit an error, as on a full disk, instead of a sudden death.
pub fn outlive_file_limits() {
    #[cfg(unix)]
    {
        /// Read by nobody: because the signal is handled, the write fails instead.
        static TAKEN: AtomicBool = AtomicBool::new(false);
        // If that is not possible, the system does as usual.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &TAKEN);
    }
}

type Step = Box<dyn FnOnce() + Send>;

/// What has to be undone if the process ended now, by number. Whoever ends the process keeps the lock for ever, so
/// that nothing is begun or finished after that.
static UNDO: Mutex<BTreeMap<u64, Step>> = Mutex::new(BTreeMap::new());

fn undo_list() -> MutexGuard<'static, BTreeMap<u64, Step>> {
    UNDO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Something that is undone if the process is ended in the middle of it. Dropping it forgets it.
#[must_use]
#[derive(Debug)]
pub struct Undo(u64);

/// Begins something that has to be undone if the process is ended before the returned [`Undo`] is dropped or settled:
/// `start` begins it and says how it is undone. The process is ended before `start` or after it, never in between,
/// where something would have begun that nobody undoes. Neither `start` nor the step may wait for long, nor begin or
/// forget such things themselves.
///
/// # Errors
/// What `start` says.
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
    /// Runs `last`, after which there is nothing to undo. The process is ended before it or after it, never in
    /// between.
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
        // After the lock is released.
        drop(step);
    }
}

/// Undoes everything that is unfinished, the latest first, lets `say` report it, and ends the process with the
/// signal's code.
pub fn end_now(signal: Signal, say: impl FnOnce()) -> ! {
    let mut list = undo_list();
    undo_all(&mut list);
    say();
    leave_at_once(signal.exit_code())
}

/// The latest first.
fn undo_all(list: &mut BTreeMap<u64, Step>) {
    while let Some((_, step)) = list.pop_last() {
        step();
    }
}

/// The end of `main`. From here on no signal interferes.
pub struct Leaving {
    list: MutexGuard<'static, BTreeMap<u64, Step>>,
}

/// Begins to leave. Does not return if a signal is already ending the process.
pub fn begin_to_leave() -> Leaving {
    Leaving { list: undo_list() }
}

impl Leaving {
    /// Undoes what threads have not finished and ends the process with `code`, without the exit handlers of drivers and libraries: they would take away what
    /// their threads, which may still be at work, need. Mesa 22.3 compiles for AMD on such threads, and crashes.
    pub fn leave(mut self, code: u8) -> ! {
        undo_all(&mut self.list);
        // If nobody reads standard output, there is nobody to tell.
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
    fn only_what_is_neither_settled_nor_forgotten_is_to_be_undone() {
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
    fn what_had_just_begun_when_a_signal_came_was_left_behind() {
        let start = || Ok::<_, ()>((UNDO.try_lock().is_err(), || ()));
        assert!(begin(start).unwrap().0, "the process could be ended before the step is known");
        let failed = begin(|| Err::<((), fn()), _>(7)).unwrap_err();
        assert_eq!(failed, 7);
    }
}
