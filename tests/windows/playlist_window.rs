//! Control of the player over D-Bus, as media keys and other programs do it.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use crate::support::desktop::{App, Desktop, PROGRAM, command_in};
use mariana::shell::identity::APP_ID;
use mariana_testing::process::wait_until;
use mariana_testing::session_bus::SessionBus;
use mariana_testing::wave::write_wav;

const SMALL: &[&str] = &["--silent", "--size", "320x180"];

fn write_song(path: &Path, seconds: f64) {
    let samples = (0..(seconds * 16_000.0) as usize).map(|n| (f64::from(n as u32) * 0.02).sin() as f32 * 0.4);
    write_wav(path, 8_000, 2, samples);
}

fn folder_of(desktop: &Desktop, songs: &[&str], seconds: f64) -> PathBuf {
    let folder = desktop.folder().join("music");
    std::fs::create_dir(&folder).unwrap();
    songs.iter().for_each(|song| write_song(&folder.join(song), seconds));
    folder
}

fn wait_for_track(app: &mut App, name: &str, place: &str) {
    app.wait_for_title(name, |title| title.starts_with(name) && title.contains(place));
}

#[test]
fn the_player_is_controlled_over_d_bus() {
    let desktop = Desktop::start();
    let bus = SessionBus::start(desktop.folder());
    let folder = folder_of(&desktop, &["1.wav", "2.wav"], 60.0);
    // The fault delays the first frame. The song must not start before the first frame is shown.
    let slow = [("MARIANA_FAULT", "slow-compiler@0")];
    let mut app = desktop.open_with(&slow, &folder, &[SMALL, &["-v"]].concat());
    wait_until("the player on the bus", || bus.players().len() == 1);
    let waits = |app: &App<'_>| !app.reported().contains("first picture after");
    let status = bus.property("Player.PlaybackStatus");
    assert!(!waits(&app) || !status.contains("Playing"), "{status}");
    let position = || -> i64 {
        let reply = bus.property("Player.Position");
        reply.split_whitespace().last().and_then(|number| number.parse().ok()).unwrap_or(-1)
    };
    let mut last = 0;
    wait_until("half a second of the song", || {
        let now = position();
        assert!(now >= last, "the position went back from {last} to {now} us");
        last = now;
        !waits(&app) && now > 500_000
    });
    let wait_for = |property: &str, value: &str| {
        wait_until(&format!("{property} of {value}"), || bus.property(property).contains(value));
    };
    assert!(bus.property("Identity").contains("Mariana"));
    assert!(bus.property("DesktopEntry").contains(APP_ID));
    wait_for("Player.PlaybackStatus", "Playing");
    wait_for("Player.Metadata", "1.wav");
    wait_for("Player.Metadata", "60000000");
    bus.call("Player.PlayPause", &[]);
    wait_for("Player.PlaybackStatus", "Paused");
    app.wait_for_title("paused", |title| title.contains("paused"));
    let before = position();
    bus.call("Player.Seek", &["int64:20000000"]);
    wait_until("the seek", || (position() - before - 20_000_000).abs() < 1_000_000);
    // The player ignores a position that belongs to another track or is beyond the end.
    bus.call("Player.SetPosition", &["objpath:/org/mariana/track/1", "int64:50000000"]);
    bus.call("Player.SetPosition", &["objpath:/org/mariana/track/0", "int64:61000000"]);
    bus.call("Player.SetPosition", &["objpath:/org/mariana/track/0", "int64:40000000"]);
    wait_until("the position", || position() == 40_000_000);
    bus.call("Player.Play", &[]);
    wait_for("Player.PlaybackStatus", "Playing");
    bus.call("Player.Next", &[]);
    wait_for_track(&mut app, "2.wav", "2/2");
    wait_for("Player.Metadata", "2.wav");
    bus.call("Player.Previous", &[]);
    wait_for_track(&mut app, "1.wav", "1/2");
    bus.set_property("Player.LoopStatus", "string:Track");
    wait_for("Player.LoopStatus", "Track");
    bus.set_property("Player.Shuffle", "boolean:true");
    wait_for("Player.Shuffle", "true");
    bus.set_property("Player.Volume", "double:0.5");
    app.wait_for_title("volume", |title| title.contains("volume 50 %"));
    for volume in ["double:nan", "double:-7", "double:1e300"] {
        bus.set_property("Player.Volume", volume);
    }
    wait_for("Player.Volume", "double 1");
    // A start without options hands its file to the running program.
    let mut later = command_in(PROGRAM, desktop.folder(), Some(desktop.display()));
    let later = later.arg(folder.join("2.wav")).output().unwrap();
    let said = String::from_utf8_lossy(&later.stderr);
    assert!(later.status.success() && said.contains("the running Mariana opens this"), "{said}");
    wait_for_track(&mut app, "2.wav", " - Mariana (");
    // A second program registers a second name, and removes that name when it ends.
    let second = desktop.open(&folder, SMALL);
    wait_until("the second player", || bus.players().len() == 2);
    drop(second);
    wait_until("the end of the second player", || bus.players().len() == 1);
    bus.call("Quit", &[]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && !reported.contains("mariana: "), "{status}: {reported}");
    end_with_the_bus(&desktop, bus, &folder);
}

/// Fails if the program ends or prints a message when the bus ends, or when it starts without a bus.
fn end_with_the_bus(desktop: &Desktop, bus: SessionBus, folder: &Path) {
    let mut app = desktop.open(folder, SMALL);
    wait_until("the player on the bus", || bus.players().len() == 1);
    drop(bus);
    app.press(&["Next", "space"]);
    wait_for_track(&mut app, "2.wav", "paused");
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && reported.is_empty(), "{status}: {reported}");
    // The socket of the bus still exists, but no process answers.
    let app = desktop.open(folder, SMALL);
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && reported.is_empty(), "{status}: {reported}");
}
