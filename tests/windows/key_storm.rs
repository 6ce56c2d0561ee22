//! Random keys in a window, pressed quickly for a long time. The program must keep running and responding.
//!
//! The tests include a few runs. `scripts/storm` starts more runs and sets these variables: `STORM_RUNS`, `STORM_KEYS`
//! (per run), `STORM_LETTERS` (keys by their X11 names), `STORM_PAUSE_MS` (maximum pause between two keys),
//! `STORM_CACHE` (`fresh` or `warm`), `STORM_SEED`, `STORM_SIZE`.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::time::{Duration, Instant};

use crate::support::desktop::Desktop;
use crate::support::pings::{Answers, Pings};
use mariana_testing::wave::write_wav;

/// Keys that change the frame and the shader program, because these changes stress drivers most.
const LETTERS: &str = "n p c v n v r Tab i h space Left Right";

/// Returns the value of an environment variable, or `otherwise` if the variable is not set.
fn change<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(otherwise)
}

/// Pseudo-random numbers, the same in each run (xorshift; Marsaglia 2003, DOI 10.18637/jss.v008.i14).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % limit.max(1)
    }
}

#[test]
fn the_program_survives_random_keys() {
    let (runs, keys) = (change("STORM_RUNS", 2_u64), change("STORM_KEYS", 40_u64));
    let (pause, seed) = (change("STORM_PAUSE_MS", 600_u64), change("STORM_SEED", 1_u64));
    let (letters, size) =
        (change("STORM_LETTERS", LETTERS.to_owned()), change("STORM_SIZE", "160x90".to_owned()));
    let letters: Vec<&str> = letters.split_whitespace().collect();
    let warm = change("STORM_CACHE", "fresh".to_owned()) == "warm";
    let mut worst = Answers::default();
    let mut cache = tempfile::tempdir().unwrap();
    for run in 0..runs {
        if !warm {
            cache = tempfile::tempdir().unwrap();
        }
        let desktop = Desktop::start();
        let song = desktop.folder().join("quiet.wav");
        write_wav(&song, 8_000, 2, (0..8_000 * 40).map(|_| 0.0));
        let variables = [("MESA_SHADER_CACHE_DIR", cache.path().to_str().unwrap())];
        let mut app = desktop.open_with(&variables, &song, &["--silent", "--size", &size]);
        let pings = Pings::start(desktop.display(), app.window().parse().unwrap());
        let mut dice = Dice(0x9e37_79b9_7f4a_7c15 ^ (seed + run).wrapping_mul(0x2545_f491_4f6c_dd1d));
        let mut pressed = Vec::new();
        for _ in 0..keys {
            let key = letters[dice.below(letters.len() as u64) as usize];
            pressed.push(key);
            assert!(app.runs(), "run {run}: the program ended after {pressed:?}: {}", app.reported());
            app.press(&[key]);
            std::thread::sleep(Duration::from_millis(50 + dice.below(pause.max(51) - 50)));
        }
        assert!(app.runs(), "run {run}: the program ended after {pressed:?}: {}", app.reported());
        let answers = pings.stop();
        let memory = app.memory_mib();
        let begun = Instant::now();
        // With an open list or the table of keys, letters would search.
        app.press(&["Escape", "Escape", "Escape", "q"]);
        let (status, reported) = app.wait_for_end();
        assert!(status.success(), "run {run}: exit with {status} after {pressed:?}: {reported}");
        println!(
            "run {run}: {keys} keys, {memory:.0} MiB, {} pings: median {:?}, 99.9 % {:?}, worst {:?} at \
             {:.1?}; ended after {:?}",
            answers.count,
            answers.median,
            answers.permille,
            answers.worst,
            answers.worst_at,
            begun.elapsed()
        );
        if answers.worst > worst.worst {
            worst = answers;
        }
    }
    // The event thread must never block, even while a driver compiles.
    assert!(
        worst.count > 0 && worst.worst < Duration::from_secs(10),
        "the window did not answer in time: \
        {worst:?}"
    );
}
