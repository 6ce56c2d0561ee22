//! The time of a session. It is the system's, unless a test lets it pass by hand.
//!
//! A session and its panels live on one thread, so the simulated time is that thread's. Other threads keep the system's.

use std::cell::Cell;
use std::time::{Duration, Instant};

thread_local! {
    static SIMULATED: Cell<Option<Instant>> = const { Cell::new(None) };
    /// How far this thread's time is ahead of the system's.
    static AHEAD: Cell<Duration> = const { Cell::new(Duration::ZERO) };
}

/// Returns the time of this thread.
pub fn now() -> Instant {
    SIMULATED.get().unwrap_or_else(|| Instant::now() + AHEAD.get())
}

/// Returns how much time has passed since a moment; nothing before it.
pub fn since(moment: Instant) -> Duration {
    now().saturating_duration_since(moment)
}

/// Lets the time of this thread pass by hand from now on, first by this much.
pub fn advance(by: Duration) {
    SIMULATED.set(Some(now() + by));
}

/// Lets the time of this thread pass by hand alone while something is done. It never steps back afterwards.
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
            assert_eq!(now(), start, "it stands still");
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
            assert_eq!(now(), start, "it stands still");
            advance(Duration::from_secs(3_600));
        });
        assert!(since(start) >= Duration::from_secs(3_600), "it steps back");
        let start = now();
        std::thread::sleep(Duration::from_millis(2));
        assert!(now() > start, "it goes on");
    }
}
