//! The window's saved position and size.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use crate::support::desktop::{App, Desktop, PROGRAM, SCREEN};
use crate::walls::quit;
use mariana_testing::process::wait_until;

const SCENE: &str = "length(p - vec3(0, 1, 0)) - 1";

fn settings_file(desktop: &Desktop) -> PathBuf {
    desktop.folder().join(".config/mariana/settings.toml")
}

fn settings(desktop: &Desktop) -> String {
    std::fs::read_to_string(settings_file(desktop)).unwrap_or_default()
}

fn open<'d>(desktop: &'d Desktop, options: &[&str]) -> App<'d> {
    let mut command = desktop.command(PROGRAM);
    command.args(["--prepare-ahead", "off", "--scene", SCENE, "-v"]).args(options);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut app = desktop.show(command, Path::new(""));
    app.wait_until_reported("first picture after");
    app
}

#[test]
fn the_window_opens_at_its_last_visible_position() {
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
    // Full screen does not change the saved position.
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
    assert!(x < 700 && y < 500, "the window is at {x}, {y}, outside the screen");
    quit(app);
}
