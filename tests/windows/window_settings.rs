//! The panel of settings as a user meets it, by keys alone and by pointer alone, and what is there in the next run.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use crate::support::desktop::{App, Desktop, PROGRAM, SCREEN};
use crate::walls::quit;
use mariana_testing::process::wait_until;
use mariana_testing::sound_server::SoundServer;

/// A scene that costs little.
const SCENE: &str = "length(p - vec3(0, 1, 0)) - 1";

fn settings_file(desktop: &Desktop) -> PathBuf {
    desktop.folder().join(".config/mariana/settings.toml")
}

fn settings(desktop: &Desktop) -> String {
    std::fs::read_to_string(settings_file(desktop)).unwrap_or_default()
}

fn wait_for_setting(desktop: &Desktop, line: &str) {
    wait_until(line, || settings(desktop).lines().any(|found| found == line));
}

/// Waits until no line of the settings begins with `key`: it is as it is by default.
fn wait_for_default(desktop: &Desktop, key: &str) {
    wait_until(key, || !settings(desktop).lines().any(|line| line.starts_with(key)));
}

fn open<'d>(desktop: &'d Desktop, options: &[&str]) -> App<'d> {
    let mut command = desktop.command(PROGRAM);
    command.args(["--prepare-ahead", "off", "--scene", SCENE, "-v"]).args(options);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut app = desktop.show(command, Path::new(""));
    app.wait_until_told("first picture after");
    app
}

/// Waits until a song plays on an output of the server.
fn wait_for_output(server: &SoundServer, name: &str) {
    wait_until(name, || {
        let sinks = server.ask(&["list", "short", "sinks"]);
        let number = sinks.lines().find(|line| line.contains(name)).and_then(|line| line.split('\t').next());
        let playing = server.ask(&["list", "short", "sink-inputs"]);
        playing.lines().any(|line| line.split('\t').nth(1) == number)
    });
}

fn click(app: &App, x: u32, y: u32) {
    app.xdotool(&["mousemove", "--window", app.window(), &x.to_string(), &y.to_string()]);
    std::thread::sleep(Duration::from_millis(300));
    app.xdotool(&["click", "1"]);
}

/// Waits until the dark ground of a panel is at this place of the window.
fn wait_for_ground(app: &App, what: &str, x: u32, y: u32) {
    wait_until(what, || {
        let picture = app.picture();
        let pixel = picture.get_pixel(x, y).0;
        u32::from(pixel[0]) + u32::from(pixel[1]) + u32::from(pixel[2]) < 120
    });
}

/// Time for the list of devices, and for a panel to show.
fn wait_for_panel() {
    std::thread::sleep(Duration::from_millis(1_500));
}

#[test]
fn settings_change_by_keys_and_by_pointer_and_are_there_in_the_next_run() {
    let desktop = Desktop::start();
    let server = SoundServer::start(desktop.folder());
    server.plug("usb", &[]);
    server.set_default("viz");
    // By keys alone: the default output, viz and usb, then latency, quality, the limiter.
    let app = open(&desktop, &["--size", "640x360"]);
    wait_for_output(&server, "viz");
    app.press(&["g"]);
    wait_for_panel();
    app.press(&["Down", "Down", "Return"]);
    wait_for_output(&server, "usb");
    wait_until("the output", || {
        settings(&desktop).contains("output = \"") && settings(&desktop).contains("usb")
    });
    // The server knows of the other output before the show does.
    wait_for_panel();
    app.press(&["Down", "Right", "Right", "Down", "Right", "Down", "Return"]);
    wait_for_setting(&desktop, "quality = \"low\"");
    wait_for_setting(&desktop, "flash_limiter = \"off\"");
    assert!(settings(&desktop).contains("usb\" = 10.0"), "{}", settings(&desktop));
    // A panel that is closed takes no keys.
    app.press(&["Escape", "Down", "Return", "Right"]);
    quit(app);
    assert!(settings(&desktop).contains("volume = 0.9"), "{}", settings(&desktop));

    // A flag holds for its run, and is not remembered.
    let app = open(&desktop, &["--size", "760x540", "--quality", "best", "--device", "default"]);
    wait_for_output(&server, "viz");
    assert!(app.told().contains("quality: Best, flash_limiter: false"), "{}", app.told());
    quit(app);
    wait_for_setting(&desktop, "quality = \"low\"");

    // What was chosen is there again; by pointer alone it goes.
    let app = open(&desktop, &["--size", "760x540"]);
    wait_for_output(&server, "usb");
    assert!(app.told().contains("quality: Low, flash_limiter: false"), "{}", app.told());
    for at in ["200", "230"] {
        app.xdotool(&["mousemove", "--window", app.window(), at, "100"]);
        std::thread::sleep(Duration::from_millis(200));
    }
    wait_for_ground(&app, "the bar", 24, 518);
    // The button of the bar, which is 14 from the window's edges, is the third from the right.
    click(&app, 760 - 14 - 14 - 15 - 2 * 32, 540 - 14 - 11 - 15);
    wait_for_ground(&app, "the panel", 66, 30);
    wait_for_panel();
    // Rows are 26 high, below a heading; names begin 170 to the right of the rows.
    let row = |place: u32| 14 + 11 + 26 + 26 * place + 13;
    let (left, names) = (60 + 14, 60 + 14 + 170);
    click(&app, left + 60, row(0));
    wait_for_output(&server, "viz");
    wait_for_default(&desktop, "output");
    click(&app, names + 18, row(4));
    wait_for_default(&desktop, "quality");
    click(&app, names + 14, row(5));
    wait_for_default(&desktop, "flash_limiter");
    // The cross closes it, and the picture takes clicks again.
    click(&app, 760 - 60 - 14 - 13, 14 + 11 + 10);
    std::thread::sleep(Duration::from_millis(500));
    click(&app, left + 60, row(2));
    std::thread::sleep(Duration::from_millis(500));
    assert!(!settings(&desktop).contains("output ="), "a closed panel was clicked");
    quit(app);
}

#[test]
fn the_window_opens_where_it_was_unless_that_is_nowhere() {
    let desktop = Desktop::start();
    let place = |app: &App| {
        let text = app.xdotool(&["getwindowgeometry", "--shell", app.window()]);
        let number = |name: &str| -> i32 {
            let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
            line.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("no {name} in {text}"))
        };
        (number("X"), number("Y"))
    };
    let options = ["--silent"];
    let app = open(&desktop, &["--size", "320x180", "--silent"]);
    app.xdotool(&["windowmove", "--sync", app.window(), "333", "222"]);
    std::thread::sleep(Duration::from_millis(500));
    let left_at = place(&app);
    quit(app);
    let mut app = open(&desktop, &options);
    wait_until("its place", || place(&app) == left_at);
    assert_eq!(app.size(), (320, 180));
    // Full screen is no place.
    app.press(&["f"]);
    app.wait_for_size(SCREEN);
    quit(app);
    let mut app = open(&desktop, &options);
    app.wait_for_size(SCREEN);
    app.press(&["f"]);
    app.wait_for_size((320, 180));
    wait_until("its place", || place(&app) == left_at);
    quit(app);
    let app = open(&desktop, &options);
    wait_until("its place", || place(&app) == left_at);
    quit(app);
    let text = settings(&desktop);
    let line = text.lines().find(|line| line.starts_with("place =")).unwrap_or_else(|| panic!("{text}"));
    std::fs::write(settings_file(&desktop), text.replace(line, "place = [9000, 9000]")).unwrap();
    let app = open(&desktop, &options);
    let (x, y) = place(&app);
    assert!(x < 700 && y < 500, "the window is at {x}, {y}, where nobody sees it");
    quit(app);
}
