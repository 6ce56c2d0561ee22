//! Measures the song's clock during device faults, and the cost of faults, on a separate PulseAudio server. Needs
//! `pulseaudio` and `pactl`.
//!
//! ```text
//! cargo bench --bench device_faults                 all of these
//! cargo bench --bench device_faults -- faults 200   outputs unplugged, changed and suspended, the server killed
//! cargo bench --bench device_faults -- flaps 300    one output lost and found: threads, files and memory
//! cargo bench --bench device_faults -- only 300     the only output lost and found, with silence between
//! cargo bench --bench device_faults -- stop         the process stopped for 5 s
//! ```
//!
//! A thread reads the position 60 times a second, as the window does, and compares its change with the time passed.

#![allow(clippy::expect_used, clippy::unwrap_used, missing_docs)]
#![cfg(target_os = "linux")]

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use mariana_player::{Player, PlayerOptions, PlayerStatus};
use mariana_testing::process::wait_until;
use mariana_testing::sound_session::Session;

#[path = "../tests/devices/tone.rs"]
mod tone;

use tone::start_tone;

const FRAME: Duration = Duration::from_nanos(16_666_667);
/// If the change of the position and the passed time differ by more than this, in seconds, the clock made a step.
const STEP: f64 = 0.05;
/// In `flaps`, each output plays for this long after the change to it was noticed.
const HEARD: Duration = Duration::from_millis(250);

#[derive(Default)]
struct Seen {
    looks: u64,
    backward: Vec<f64>,
    steps: Vec<f64>,
    /// The longest time during which the clock moved less than 1 ms.
    stillest: f64,
    moved: f64,
    passed: f64,
    status: Option<PlayerStatus>,
}

fn watch(player: &mut Player, seen: &Mutex<Seen>, done: &AtomicBool) {
    let begin = Instant::now();
    let from = player.now(0.0).song_time;
    let (mut last, mut at) = (from, begin);
    let mut moved = (from, begin);
    while !done.load(Ordering::Relaxed) {
        std::thread::sleep(FRAME);
        let before = Instant::now();
        let position = player.now(0.0).song_time;
        let (status, after) = (player.status(), Instant::now());
        let mut seen = seen.lock().unwrap();
        seen.looks += 1;
        let (least, most) = ((before - at).as_secs_f64(), (after - at).as_secs_f64());
        let step = position - last;
        if step < 0.0 {
            seen.backward.push(step);
        }
        if least > 1.0 {
            println!("  no read for {least:.2} s; the position moved by {step:.3} s meanwhile");
        } else if step > most + STEP || step < least - STEP {
            seen.steps.push(step - least);
        }
        if position - moved.0 >= 0.001 {
            moved = (position, after);
        }
        seen.stillest = seen.stillest.max((after - moved.1).as_secs_f64());
        (seen.moved, seen.passed) = (position - from, (before - begin).as_secs_f64());
        seen.status = Some(status);
        (last, at) = (position, before);
    }
}

fn during(act: impl FnOnce(&dyn Fn() -> Option<PlayerStatus>)) -> Seen {
    let mut player = start_tone(PlayerOptions::default()).expect("a player");
    wait_until("the sound", || player.status().position > 1.0);
    let (seen, done) = (Mutex::new(Seen::default()), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| watch(&mut player, &seen, &done));
        act(&|| seen.lock().unwrap().status.clone());
        done.store(true, Ordering::Relaxed);
    });
    seen.into_inner().unwrap()
}

fn plays_on(status: Option<PlayerStatus>, name: &str) -> bool {
    status.is_some_and(|status| {
        status.silent.is_none() && status.device.is_some_and(|device| device.id.ends_with(name))
    })
}

fn report(what: &str, seen: &Seen) {
    let worst = |steps: &[f64]| steps.iter().fold(0.0_f64, |worst, step| worst.max(step.abs()));
    println!(
        "{what}: {} looks, {} backward (at most {:.3} s), {} steps of more than 50 ms (at most {:.3} s), stopped for {:.3} s at \
         most; the song moved by {:.2} s in {:.2} s",
        seen.looks,
        seen.backward.len(),
        worst(&seen.backward),
        seen.steps.len(),
        worst(&seen.steps),
        seen.stillest,
        seen.moved,
        seen.passed
    );
    if let Some(status) = &seen.status {
        println!("  {:?}; underruns {}", status.missed_audio, status.underruns);
    }
}

fn faults(count: usize) {
    let mut session = Session::with_server();
    let mut plugged = ["a", "b"].map(|name| session.server().plug(name, &[]));
    let mut state = 7_u32;
    let mut random = |limit: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % limit
    };
    let seen = during(|status| {
        for fault in 0..count {
            let which = random(2);
            let name = ["a", "b"][which];
            match if fault % 10 == 9 { 5 } else { random(5) } {
                0 | 1 => {
                    session.server().unplug(&plugged[which]);
                    std::thread::sleep(Duration::from_millis(random(300) as u64));
                    plugged[which] =
                        session.server().plug(name, &[["rate=48000"], ["rate=44100"]][random(2)]);
                }
                2 => session.server().set_default(name),
                3 => session.server().set_default("viz"),
                4 => {
                    let default = session.server().ask(&["get-default-sink"]);
                    session.server().ask(&["suspend-sink", &default, "1"]);
                    std::thread::sleep(Duration::from_millis(random(1500) as u64));
                    session.server().ask(&["suspend-sink", &default, "0"]);
                }
                _ => {
                    session.kill_server();
                    std::thread::sleep(Duration::from_millis(random(600) as u64));
                    session.start_server();
                    plugged = ["a", "b"].map(|name| session.server().plug(name, &[]));
                }
            }
            std::thread::sleep(Duration::from_millis(random(1000) as u64));
        }
        let default = session.server().ask(&["get-default-sink"]);
        wait_until("the sound", || plays_on(status(), &default));
    });
    report(&format!("{count} faults"), &seen);
}

/// Threads, open files and resident memory in KiB of this process.
fn held() -> (usize, usize, u64) {
    let count = |folder| std::fs::read_dir(folder).unwrap().count();
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("VmRSS");
    let resident = resident.trim().trim_end_matches(" kB").parse().expect("a number");
    (count("/proc/self/task"), count("/proc/self/fd"), resident)
}

fn flaps(count: usize) {
    let session = Session::with_server();
    let seen = during(|status| {
        for flap in 0..count {
            let usb = session.server().plug("usb", &[]);
            session.server().set_default("usb");
            wait_until("the sound on usb", || plays_on(status(), "usb"));
            std::thread::sleep(HEARD);
            session.server().unplug(&usb);
            wait_until("the sound on viz", || plays_on(status(), "viz"));
            std::thread::sleep(HEARD);
            if flap % (count / 10).max(1) == 0 || flap + 1 == count {
                let (threads, files, resident) = held();
                println!("  after {:4} flaps: {threads} threads, {files} files, {resident} KiB", flap + 1);
            }
        }
    });
    report(&format!("{count} flaps"), &seen);
}

fn only(count: usize) {
    let session = Session::with_server();
    // Unloading the module by its name unplugs all null sinks at once.
    session.server().unplug("module-null-sink");
    let seen = during(|status| {
        for flap in 0..count {
            wait_until("silence", || status().is_some_and(|status| status.silent.is_some()));
            let usb = session.server().plug("usb", &[]);
            wait_until("the sound on usb", || plays_on(status(), "usb"));
            std::thread::sleep(HEARD);
            session.server().unplug(&usb);
            if flap % (count / 10).max(1) == 0 || flap + 1 == count {
                wait_until("silence", || status().is_some_and(|status| status.silent.is_some()));
                let (threads, files, resident) = held();
                println!("  after {:4} flaps: {threads} threads, {files} files, {resident} KiB", flap + 1);
            }
        }
    });
    report(&format!("{count} times the only output lost"), &seen);
}

fn stop() {
    let _session = Session::with_server();
    let seen = during(|_| {
        let script = format!("sleep 1; kill -STOP {0}; sleep 5; kill -CONT {0}", std::process::id());
        let mut child = std::process::Command::new("sh").args(["-c", &script]).spawn().expect("a shell");
        child.wait().expect("an exit status");
        std::thread::sleep(Duration::from_secs(4));
    });
    report("stopped for 5 s", &seen);
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|argument| argument == name);
    let number = |default| arguments.iter().find_map(|argument| argument.parse().ok()).unwrap_or(default);
    if wanted("faults") {
        faults(number(200));
    }
    if wanted("flaps") {
        flaps(number(300));
    }
    if wanted("only") {
        only(number(300));
    }
    if wanted("stop") {
        stop();
    }
}
