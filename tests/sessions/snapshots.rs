//! Snapshots of the sliders: taken, recalled at once or over some beats, kept for the next run, and written as cues.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs;
use std::time::Duration;

use crate::controllers::{wait_for_colour, write_wall};
use crate::support::osc::Sender;
use crate::support::session::{self, App};
use mariana::clock;
use mariana::commands::{Bind, Command};
use mariana_control::{Curve, SoundBinding};

const GREEN: [bool; 3] = [false, true, false];
const YELLOW: [bool; 3] = [true, true, false];

fn open(place: &session::Place, osc: &Sender) -> App {
    let scene = write_wall(place);
    let options = ["--scene", scene.to_str().unwrap(), "--size", "160x90", "--osc", &osc.port.to_string()];
    let app = place.open(&place.song(), &options);
    app.wait_until_reported("receiving OSC");
    app.wait_until_reported("first picture");
    app
}

#[test]
fn snapshots_are_taken_once_recalled_and_kept() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let app = open(&place, &osc);
    wait_for_colour(&app, "the scene's own values", GREEN);
    app.command(Command::Snapshot(1));
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "a turned slider", YELLOW);
    // OSC takes and recalls too.
    osc.send("/take_next", &[1.0]);
    osc.send("/snapshot", &[2.0]);
    app.wait_until_reported("snapshot 2 is taken");
    osc.send("/snapshot", &[1.0]);
    wait_for_colour(&app, "the first snapshot", GREEN);
    app.command(Command::Snapshot(2));
    wait_for_colour(&app, "the second snapshot", YELLOW);
    // F2 takes a snapshot again.
    app.press(&["F2"]);
    assert!(app.state().snapshots.takes);
    app.command(Command::Snapshot(1));
    assert!(!app.state().snapshots.takes);
    app.command(Command::Snapshot(9));
    app.wait_until_reported("there is no snapshot 9");
    app.command(Command::WriteSnapshots);
    app.wait_until_reported("written: ");
    let shows = place.path("data/performances/wall snapshots.show");
    let text = fs::read_to_string(&shows).unwrap();
    let cues = text.lines().filter(|line| line.starts_with("at cue")).count();
    assert_eq!((cues, text.matches("set red = 2\n").count()), (2, 2), "{text}");
    app.quit();
    let app = open(&place, &osc);
    wait_for_colour(&app, "the scene's own values again", GREEN);
    app.command(Command::Snapshot(2));
    wait_for_colour(&app, "the snapshot of the last run", YELLOW);
    app.quit();
}

#[test]
fn a_snapshot_has_bindings_and_can_take_a_bar() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let app = open(&place, &osc);
    wait_for_colour(&app, "the scene's own values", GREEN);
    app.command(Command::Snapshot(1));
    // In silence, the binding gives its low value.
    let (input, curve) = ("bass".to_owned(), Curve::Linear);
    let binding = Some(SoundBinding { input, low: 2.0, high: 0.0, curve, smoothing: 0.0, release: None });
    app.command(Command::Bind(Bind { name: "red".to_owned(), binding }));
    wait_for_colour(&app, "the bound slider", YELLOW);
    let red = |app: &App| app.picture().get_pixel(20, 80).0[0];
    let full = red(&app);
    app.command(Command::Snapshot(2));
    app.command(Command::Snapshot(1));
    wait_for_colour(&app, "the slider without its binding", GREEN);
    app.press(&["F4"]);
    assert!(app.state().snapshots.morphs);
    app.command(Command::Snapshot(2));
    app.wait_until("the whole way", |app| red(app) == full);
    app.command(Command::Snapshot(1));
    wait_for_colour(&app, "the slider without its binding again", GREEN);
    app.wait_until_still();
    clock::by_hand(|| {
        app.command(Command::Snapshot(2));
        // Without a tempo, a bar takes two seconds.
        clock::advance(Duration::from_millis(600));
        app.take_steps(4);
        let between = red(&app);
        clock::advance(Duration::from_millis(1_500));
        app.take_steps(4);
        let last = red(&app);
        // Frames in motion may have fewer pixels, so that dithering differs.
        assert!(between > 5 && between + 9 < last, "{between}, then {last}");
        assert!(last.abs_diff(full) < 4, "{last}, not {full}");
    });
    app.quit();
}
