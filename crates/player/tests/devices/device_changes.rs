//! Tests of devices that appear, disappear and change during playback or recording, on a separate PulseAudio server.
//! They need `pulseaudio`, `pactl` and `pacat`.
//!
//! `MARIANA_STRESS_ROUNDS=1000 cargo test -p mariana-player --test devices storm -- --nocapture` runs the long test
//! with many changes, and prints the times until sound was back.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::time::{Duration, Instant};

use mariana_music::Gain;
use mariana_player::device_list::{DeviceList, DeviceWatch};
use mariana_player::input::{Live, LiveStatus};
use mariana_player::{Player, PlayerOptions, PlayerStatus, Target};
use mariana_testing::process::{LOOK_PERIOD, WAIT_LIMIT};
use mariana_testing::sound_session::Session;

use crate::tone::start_tone;

fn play(device: Option<&str>) -> Player {
    let options =
        PlayerOptions { output: Some(device.map_or(Target::Default, named)), ..PlayerOptions::default() };
    start_tone(options).expect("a player")
}

fn listen(target: Target) -> Live {
    Live::start(target, Gain::Auto).expect("a live input")
}

fn named(name: &str) -> Target {
    Target::Named(name.into())
}

fn device_list() -> std::sync::Arc<DeviceList> {
    DeviceWatch::shared().expect("a device watch").latest().1
}

fn wait_for(player: &mut Player, what: &str, done: impl Fn(&PlayerStatus) -> bool) -> Duration {
    let start = Instant::now();
    loop {
        let status = player.status();
        if done(&status) {
            return start.elapsed();
        }
        assert!(start.elapsed() < WAIT_LIMIT, "no {what}: {status:?}; devices: {:?}", device_list());
        std::thread::sleep(LOOK_PERIOD);
    }
}

fn wait_for_live(live: &mut Live, what: &str, done: impl Fn(&LiveStatus, f32) -> bool) -> Duration {
    let start = Instant::now();
    loop {
        let (status, volume) = (live.status(), live.now(0.0).features.volume[0]);
        if done(&status, volume) {
            return start.elapsed();
        }
        assert!(
            start.elapsed() < WAIT_LIMIT,
            "no {what}: {status:?}, volume {volume}; devices: {:?}",
            device_list()
        );
        std::thread::sleep(LOOK_PERIOD);
    }
}

fn plays_on(name: &str) -> impl Fn(&PlayerStatus) -> bool {
    let name = name.to_owned();
    move |status| {
        status.silent.is_none() && status.device.as_ref().is_some_and(|device| device.id.ends_with(&name))
    }
}

fn hears(name: &str) -> impl Fn(&LiveStatus, f32) -> bool {
    let name = name.to_owned();
    move |status, volume| {
        volume > 0.2
            && status.silent.is_none()
            && status.device.as_ref().is_some_and(|d| d.id.ends_with(&name))
    }
}

#[test]
fn a_song_is_heard_again_when_the_server_is_back() {
    let mut session = Session::with_server();
    let mut player = play(None);
    let mut live = listen(Target::Monitor);
    wait_for(&mut player, "the sound", plays_on("viz"));
    wait_for_live(&mut live, "the sound", hears("viz.monitor"));
    for _ in 0..2 {
        session.kill_server();
        wait_for(&mut player, "the silent clock", |status| status.silent.is_some());
        wait_for_live(&mut live, "silence", |status, volume| status.silent.is_some() && volume < 0.01);
        let before = player.status().position;
        std::thread::sleep(Duration::from_millis(300));
        assert!(player.status().position > before + 0.2, "the song does not move");
        session.start_server();
        let took = wait_for(&mut player, "sound again", plays_on("viz"));
        assert!(took < Duration::from_secs(2), "{took:?}");
        assert!(player.status().position > before);
        wait_for_live(&mut live, "sound again", hears("viz.monitor"));
    }
}

#[test]
fn a_song_continues_on_another_output() {
    let session = Session::with_server();
    let mut player = play(None);
    wait_for(&mut player, "the sound", plays_on("viz"));
    session.server().plug("usb", &[]);
    let before = player.status().position;
    player.choose_output(named("usb"));
    wait_for(&mut player, "the other output", plays_on("usb"));
    assert!(player.status().position >= before, "the song went back");
    // If the chosen device is missing, the song stays on the current device, and a reason is reported.
    player.choose_output(named("no such box"));
    wait_for(&mut player, "the refusal", |status| status.refused.is_some());
    assert!(plays_on("usb")(&player.status()), "{:?}", player.status());
    player.choose_output(Target::Default);
    wait_for(&mut player, "the default", plays_on("viz"));
    assert_eq!(player.status().refused, None);
}

#[test]
fn a_preferred_output_is_used_while_it_is_connected() {
    let session = Session::with_server();
    let id = |name: &str| {
        let start = Instant::now();
        loop {
            if let Some(entry) = device_list().outputs.iter().find(|entry| entry.id.ends_with(name)) {
                return entry.id.clone();
            }
            assert!(start.elapsed() < WAIT_LIMIT, "there is no {name} in {:?}", device_list());
            std::thread::sleep(LOOK_PERIOD);
        }
    };
    let _watch = DeviceWatch::shared().expect("a device watch");
    let plugged = session.server().plug("usb", &[]);
    let output = Some(Target::Preferred(id("usb")));
    session.server().unplug(&plugged);
    // The device is missing at the start, so the default plays, without an error.
    let options = PlayerOptions { output, ..PlayerOptions::default() };
    let mut player = start_tone(options).expect("a player");
    wait_for(&mut player, "the default", plays_on("viz"));
    let plugged = session.server().plug("usb", &[]);
    wait_for(&mut player, "the preferred output", plays_on("usb"));
    session.server().unplug(&plugged);
    wait_for(&mut player, "the default again", plays_on("viz"));
}

#[test]
fn the_default_output_is_followed() {
    let session = Session::with_server();
    let mut player = play(None);
    let mut live = listen(Target::Monitor);
    wait_for(&mut player, "the sound", plays_on("viz"));
    wait_for_live(&mut live, "the sound", hears("viz.monitor"));
    let other = session.server().plug("other", &["rate=44100"]);
    session.server().set_default("other");
    let before = player.status().position;
    wait_for(&mut player, "the other output", plays_on("other"));
    wait_for_live(&mut live, "the other monitor", hears("other.monitor"));
    let after = player.status();
    assert!(after.position >= before && after.position < before + 5.0, "{before} to {}", after.position);
    session.server().unplug(&other);
    wait_for(&mut player, "the first output", plays_on("viz"));
    wait_for_live(&mut live, "the first monitor", hears("viz.monitor"));
}

#[test]
fn a_named_device_is_used_when_it_returns() {
    let session = Session::with_server();
    let usb = session.server().plug("usb", &[]);
    let mut player = play(Some("usb"));
    let mut live = listen(Target::MonitorOf("usb".into()));
    wait_for(&mut player, "the sound", plays_on("usb"));
    wait_for_live(&mut live, "the sound", hears("usb.monitor"));
    // When the device is unplugged, the server moves the streams to viz, which was not requested.
    session.server().unplug(&usb);
    let gone = |silent: &Option<String>| silent.as_deref().is_some_and(|why| why.contains("gone"));
    wait_for(&mut player, "the silent clock", |status| gone(&status.silent));
    wait_for_live(&mut live, "silence", |status, volume| gone(&status.silent) && volume < 0.01);
    let before = player.status().position;
    session.server().plug("usb", &[]);
    let took = wait_for(&mut player, "sound again", plays_on("usb"));
    assert!(took < Duration::from_secs(2), "{took:?}");
    assert!(player.status().position >= before);
    wait_for_live(&mut live, "sound again", hears("usb.monitor"));
}

#[test]
fn an_input_is_chosen_while_another_is_heard() {
    let session = Session::with_server();
    session.server().plug("other", &[]);
    session.server().set_default("viz");
    let _tone = session.server().play_tone("other", 440.0);
    let mut live = listen(Target::Monitor);
    wait_for_live(&mut live, "the monitor", |status, _| status.device.is_some());
    let first = live.now(0.0);
    live.choose(named("pulseaudio:other.monitor"));
    wait_for_live(&mut live, "the other", hears("other.monitor"));
    let second = live.now(0.0);
    assert!(second.segment > first.segment && second.song_time > first.song_time);
    live.choose(named("no_such_box"));
    let reported = |status: &LiveStatus| status.silent.clone().unwrap_or_default();
    // The previous input continues until the chosen input opens, and the reason is reported.
    wait_for_live(&mut live, "the reason", |status, _| {
        status.refused.as_ref().is_some_and(|reason| reason.contains("no_such_box"))
    });
    wait_for_live(&mut live, "the other", hears("other.monitor"));
    session.server().plug("such", &["sink_properties=device.description=no_such_box"]);
    wait_for_live(&mut live, "the box", |status, _| {
        status.device.as_ref().is_some_and(|device| device.id.ends_with("such.monitor"))
            && reported(status).is_empty()
            && status.refused.is_none()
    });
}

#[test]
fn a_flat_input_is_reported_with_a_suggestion() {
    let session = Session::with_server();
    session.server().plug("other", &[]);
    session.server().set_default("viz");
    let mut live = listen(Target::Monitor);
    wait_for_live(&mut live, "the diagnosis", |status, _| {
        status
            .flat
            .as_deref()
            .is_some_and(|why| why.contains("no sound from Monitor of") && why.contains("press D"))
    });
    assert_eq!(live.status().suggestion, None);
    let tone = session.server().play_tone("other", 440.0);
    wait_for_live(&mut live, "the suggestion", |status, _| {
        status.suggestion.as_ref().is_some_and(|entry| entry.id.ends_with("other.monitor"))
    });
    let reported = live.status().flat.unwrap();
    assert!(reported.contains("the monitor of") && reported.contains("has a signal: press D"), "{reported}");
    let suggestion = live.status().suggestion.unwrap();
    live.choose(Target::Named(suggestion.id));
    wait_for_live(&mut live, "the sound", hears("other.monitor"));
    assert_eq!(live.status().flat, None);
    drop(tone);
}

#[test]
fn devices_with_unusual_formats_are_used() {
    let session = Session::with_server();
    for (name, options) in [
        ("mono", ["channels=1", "rate=48000", "format=s16le"]),
        ("cinema", ["channels=6", "rate=44100", "format=s24le"]),
        ("many", ["channels=32", "rate=96000", "format=float32le"]),
        ("coarse", ["channels=2", "rate=8000", "format=u8"]),
        ("slow", ["channels=2", "rate=1000", "format=s16le"]),
        ("odd", ["channels=3", "rate=37123", "format=s32le"]),
        ("fast", ["channels=2", "rate=384000", "format=float32le"]),
    ] {
        let plugged = session.server().plug(name, &options);
        let mut player = play(Some(name));
        let mut live = listen(named(&format!("{name}.monitor")));
        wait_for(&mut player, name, plays_on(name));
        wait_for_live(&mut live, name, hears(&format!("{name}.monitor")));
        let volume = live.now(0.0).features.volume;
        assert!(volume[0] < 0.6 && volume[1] > 0.05, "{name}: {volume:?}");
        drop((player, live));
        session.server().unplug(&plugged);
    }
}

#[test]
fn a_suspended_output_is_used_when_it_resumes() {
    let session = Session::with_server();
    let mut player = play(None);
    let mut live = listen(Target::Monitor);
    wait_for(&mut player, "the sound", plays_on("viz"));
    wait_for_live(&mut live, "the sound", hears("viz.monitor"));
    session.server().ask(&["suspend-sink", "viz", "1"]);
    wait_for(&mut player, "the silent clock", |status| status.silent.is_some());
    wait_for_live(&mut live, "silence", |status, volume| status.silent.is_some() && volume < 0.01);
    session.server().ask(&["suspend-sink", "viz", "0"]);
    wait_for(&mut player, "sound again", plays_on("viz"));
    wait_for_live(&mut live, "sound again", hears("viz.monitor"));
}

fn held() -> (usize, usize) {
    let count = |folder| std::fs::read_dir(folder).unwrap().count();
    (count("/proc/self/task"), count("/proc/self/fd"))
}

#[test]
fn unplugging_the_only_output_leaks_no_threads_or_files() {
    let session = Session::with_server();
    let mut player = play(None);
    wait_for(&mut player, "the sound", plays_on("viz"));
    // Unloading the module by its name unplugs all null sinks at once.
    session.server().unplug("module-null-sink");
    let mut after = Vec::new();
    for _ in 0..6 {
        wait_for(&mut player, "silence", |status| status.silent.is_some());
        let usb = session.server().plug("usb", &[]);
        wait_for(&mut player, "the sound", plays_on("usb"));
        session.server().unplug(&usb);
        wait_for(&mut player, "silence", |status| status.silent.is_some());
        // Wait until the remains of the previous device are released.
        std::thread::sleep(Duration::from_secs(1));
        after.push(held());
    }
    assert!(after[5].0 <= after[1].0 + 1 && after[5].1 <= after[1].1 + 1, "threads and files: {after:?}");
}

#[test]
fn a_storm_of_changes_ends_with_sound() {
    let rounds: usize =
        std::env::var("MARIANA_STRESS_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(30);
    let mut session = Session::with_server();
    let mut plugged = vec![session.server().plug("a", &[]), session.server().plug("b", &["rate=44100"])];
    let mut player = play(None);
    let mut live = listen(Target::Monitor);
    wait_for(&mut player, "the sound", |status| status.silent.is_none() && status.device.is_some());
    let mut state = 7_u32;
    let mut random = |limit: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % limit
    };
    let (mut times, mut held_before) = (Vec::new(), (0, 0));
    for round in 0..rounds {
        let names = ["a", "b"];
        let which = random(2);
        match random(if round % 25 == 24 { 5 } else { 4 }) {
            0 | 1 => {
                session.server().unplug(&plugged[which]);
                std::thread::sleep(Duration::from_millis(random(300) as u64));
                plugged[which] =
                    session.server().plug(names[which], &[["rate=48000"], ["rate=44100"]][random(2)]);
            }
            2 => session.server().set_default(names[which]),
            3 => session.server().set_default("viz"),
            _ => {
                session.kill_server();
                std::thread::sleep(Duration::from_millis(random(600) as u64));
                session.start_server();
                plugged = names.map(|name| session.server().plug(name, &[])).to_vec();
            }
        }
        // Half of the changes follow before the previous change was handled.
        if random(2) == 0 {
            std::thread::sleep(Duration::from_millis(random(200) as u64));
            continue;
        }
        let default = session.server().ask(&["get-default-sink"]);
        let changed = !plays_on(&default)(&player.status());
        let start = Instant::now();
        wait_for(&mut player, "the sound", |status| {
            status.silent.is_none() && status.device.as_ref().is_some_and(|d| d.id.ends_with(&default))
        });
        wait_for_live(&mut live, "the sound", |status, volume| {
            let wanted = format!("{default}.monitor");
            status.silent.is_none()
                && status.device.as_ref().is_some_and(|d| d.id.ends_with(&wanted))
                && volume > 0.2
        });
        if changed {
            times.push(start.elapsed().as_secs_f64());
        }
        let position = player.status().position;
        wait_for(&mut player, "progress", |status| status.position != position);
        if round < rounds / 3 {
            held_before = held();
        }
    }
    times.sort_by(f64::total_cmp);
    assert!(!times.is_empty(), "nothing changed");
    let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize];
    println!(
        "{rounds} changes, {} of them awaited; sound on the new default output and its monitor after a median of {:.2} s, p95 {:.2} s, at most {:.2} s; \
         threads and files {held_before:?} before and {:?} after",
        times.len(),
        at(0.5),
        at(0.95),
        at(1.0),
        held()
    );
    // The number of threads varies, because some threads wait for an answer.
    let (threads, files) = held();
    assert!(threads <= held_before.0 + 6 && files <= held_before.1 + 8, "{held_before:?} to {:?}", held());
    drop((player, live));
}
