//! Two decks with a crossfader.

#![cfg(target_os = "linux")]

use std::path::PathBuf;
use std::time::Duration;

use crate::support::apart::apart;
use crate::support::osc::Sender;
use crate::support::session::{self, App};
use image::RgbaImage;
use mariana::commands::Command;

const SIZE: &str = "64x36";
/// Length of the song in seconds. A key seeks by 5 s.
const SECONDS: usize = 60;

/// A wall whose colour depends on the direction of view and on the time. Stills take more samples at edges, so there
/// are no edges.
fn wall(colour: &str, distance: f32) -> String {
    format!(
        "param level = 0.8 in 0 .. 1\n\
         material paint {{ color = 0  roughness = 1  emission = level * ({colour} + 0.1 * sin(0.2 * p.x + t)) }}\n\
         object wall {{ shape = {distance} - p.z  material = paint }}\nsky {{ color = 0  ambient = 0 }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n"
    )
}

struct Place {
    inner: session::Place,
    song: PathBuf,
    sender: Sender,
}

impl Place {
    fn new() -> Self {
        let inner = session::Place::new();
        let song = inner.quiet_song("song.wav", SECONDS);
        for (name, colour, distance) in [
            ("amber", "vec3(0.7, 0.2, 0.1)", 5.0),
            ("basil", "vec3(0.1, 0.6, 0.2)", 6.0),
            ("coral", "vec3(0.2, 0.1, 0.7)", 4.0),
        ] {
            inner.save(&format!("{name}.scene"), &wall(colour, distance));
        }
        Self { inner, song, sender: Sender::new() }
    }

    fn open(&self, options: &[&str]) -> App {
        let (scene, port) = (self.inner.path("amber.scene"), self.sender.port.to_string());
        let own = [self.song.to_str().unwrap(), "--silent", "--new", "--clean", "--size", SIZE];
        let more = ["--quality", "best", "--fade", "0", "--scene", scene.to_str().unwrap(), "--osc", &port];
        let app = self.inner.begin(&[&own[..], &more, options].concat());
        app.wait_until_reported("first picture");
        app.wait_until_reported("receiving OSC");
        app.pause_at_start();
        app
    }

    fn decks(&self, app: &App) {
        app.press(&["F3"]);
        app.wait_until("two decks", |app| app.state().decks);
    }

    fn crossfade(&self, app: &App, position: f32, before: &RgbaImage) -> RgbaImage {
        self.sender.send("/crossfade", &[position]);
        app.wait_until("the crossfader", |app| app.state().crossfade == Some(position));
        app.settled(before, &format!("the crossfader at {position}"))
    }
}

/// Records the crossfader in each way to mix, with new scenes on the decks, and renders the recording again.
#[test]
fn a_mix_of_two_decks_is_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let app = place.open(&[]);
    app.press(&["F9"]);
    place.decks(&app);
    let mut pictures: Vec<(f64, RgbaImage)> = Vec::new();
    let mut last = app.picture();
    let first = last.clone();
    let see = |pictures: &mut Vec<(f64, RgbaImage)>, last: &mut RgbaImage, time: f64, position: f32| {
        app.press(&["Right"]);
        *last = app.settled(last, &format!("{time} s"));
        *last = place.crossfade(&app, position, last);
        pictures.push((time, last.clone()));
    };
    see(&mut pictures, &mut last, 5.0, 0.25);
    see(&mut pictures, &mut last, 10.0, 0.75);
    // Pictures at this time are not compared, because a parameter changes at it.
    app.press(&["Right"]);
    last = app.settled(&last, "15 s");
    place.sender.send("/deck", &[2.0]);
    app.wait_until_reported("basil on deck B in hand");
    place.sender.send("/param/level", &[0.3]);
    last = app.settled(&last, "a parameter of deck B");
    see(&mut pictures, &mut last, 20.0, 0.5);
    see(&mut pictures, &mut last, 25.0, 1.0);
    // The next scene of deck A is coral, because basil is on deck B.
    app.press(&["n"]);
    app.wait_until_reported("coral on deck A");
    place.sender.send("/mix", &[2.0]);
    see(&mut pictures, &mut last, 30.0, 0.5);
    see(&mut pictures, &mut last, 35.0, 0.0);
    place.sender.send("/mix", &[3.0]);
    see(&mut pictures, &mut last, 40.0, 0.6);
    assert_ne!(last, first);
    // The rim of the portal is an edge.
    pictures.pop();
    app.press(&["F9"]);
    app.wait_until_reported("recorded: ");
    let reported = app.reported();
    let path = reported.lines().find_map(|line| line.split_once("recorded: ")?.1.split_once(';')).unwrap().0;
    app.quit_by_key();
    let show = std::fs::read_to_string(path).unwrap();
    for part in ["melt by fader", "fade by fader", "portal by fader", "set deck fader = ", "set level = "] {
        assert!(show.contains(part), "no `{part}` in\n{show}");
    }
    place.inner.compare_with_stills((&place.song, path), SIZE, &pictures);
}

/// Resident memory of this process in MiB.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches("kB").trim().parse::<f64>().unwrap() / 1024.0
}

#[test]
fn sweeps_of_the_crossfader_need_no_more_memory_and_prepare_nothing_again() {
    apart!();
    let place = Place::new();
    let app = place.open(&[]);
    place.decks(&app);
    app.wait_until_reported_times("is ready ahead", 2);
    let mut last = app.picture();
    let mut sweep = |count: usize| {
        for position in [0.25, 0.75, 1.0, 0.5, 0.0].into_iter().cycle().take(5 * count) {
            app.command(Command::Crossfade(position));
            app.wait_until("a frame of the mix", |app| app.picture() != last);
            last = app.picture();
        }
    };
    sweep(20);
    let loaded = app.reported().matches("is ready ahead").count();
    // A heap may grow once on a busy machine; what sweeps need, they need each time.
    let grown = [(); 3].map(|()| {
        let before = memory();
        sweep(40);
        memory() - before
    });
    assert!(grown.iter().any(|grown| *grown < 1.5), "{grown:.1?} MiB more after 40 sweeps each");
    assert_eq!(app.reported().matches("is ready ahead").count(), loaded, "a scene was prepared again");
}

#[test]
fn the_decks_end_with_the_visible_scene_and_the_show_goes_on_later() {
    apart!();
    let place = Place::new();
    let show = place
        .inner
        .save("led.show", "at start amber.scene\nat 20 s coral.scene cut\nat 40 s amber.scene cut\n");
    let app = place.open(&["--show", show.to_str().unwrap()]);
    app.wait_until_reported("the scenes follow the song");
    app.wait_for_title("the show's first scene", |title| title.contains("amber"));
    place.decks(&app);
    // The show would change the scene at 20 s.
    app.press(&["Right"; 5]);
    app.run_for(Duration::from_millis(300));
    assert!(app.title().contains("amber"), "{}", app.title());
    place.sender.send("/crossfade", &[1.0]);
    app.wait_for_title("basil", |title| title.contains("basil"));
    app.press(&["F3"]);
    app.wait_until("one scene", |app| !app.state().decks);
    app.run_for(Duration::from_millis(300));
    assert!(app.title().contains("basil"), "{}", app.title());
    app.press(&["Right"; 4]);
    app.wait_for_title("the show's scene", |title| title.contains("amber"));
}
