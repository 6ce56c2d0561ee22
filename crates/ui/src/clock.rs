//! The time of a session: the system's time, or simulated time in tests. Simulated time applies only to the thread that
//! sets it; a session and its panels share one thread.

use std::cell::Cell;
use std::time::{Duration, Instant};

thread_local! {
    static SIMULATED: Cell<Option<Instant>> = const { Cell::new(None) };
    /// How far this thread's clock is ahead of the system's clock.
    static AHEAD: Cell<Duration> = const { Cell::new(Duration::ZERO) };
}

/// Returns this thread's time.
pub fn now() -> Instant {
    SIMULATED.get().unwrap_or_else(|| Instant::now() + AHEAD.get())
}

/// Returns the time since `moment`; zero if `moment` is in the future.
pub fn since(moment: Instant) -> Duration {
    now().saturating_duration_since(moment)
}

/// Advances this thread's clock and stops it: from now on only this function moves the clock.
pub fn advance(by: Duration) {
    SIMULATED.set(Some(now() + by));
}

/// Runs `act` with the clock stopped, so that only [`advance`] moves the clock. Time never steps back afterwards.
pub fn by_hand<T>(act: impl FnOnce() -> T) -> T {
    let is_simulated = SIMULATED.get().is_some();
    SIMULATED.set(Some(now()));
    let done = act();
    if !is_simulated && let Some(reached) = SIMULATED.take() {
        AHEAD.set(AHEAD.get().max(reached.saturating_duration_since(Instant::now())));
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_time_passes_by_hand_and_on_one_thread() {
        let handle = std::thread::spawn(|| {
            advance(Duration::ZERO);
            let start = now();
            assert_eq!(now(), start, "the clock is stopped");
            advance(Duration::from_secs(3_600));
            assert_eq!(since(start), Duration::from_secs(3_600));
            assert_eq!(since(now() + Duration::from_secs(1)), Duration::ZERO);
        });
        handle.join().unwrap();
        let start = now();
        std::thread::sleep(Duration::from_millis(2));
        assert!(now() > start, "this thread keeps the system's time");
        let start = now();
        by_hand(|| {
            let start = now();
            std::thread::sleep(Duration::from_millis(2));
            assert_eq!(now(), start, "the clock is stopped");
            advance(Duration::from_secs(3_600));
        });
        assert!(since(start) >= Duration::from_secs(3_600), "the clock stepped back");
        let start = now();
        std::thread::sleep(Duration::from_millis(2));
        assert!(now() > start, "the clock runs again");
    }
}
