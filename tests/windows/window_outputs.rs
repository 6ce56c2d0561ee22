//! Output on another monitor, as a wallpaper, and in the window of a screen saver.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;
use std::process::Stdio;

use crate::support::desktop::{App, PROGRAM, SCREEN};
use crate::support::wayland::Compositor;
use crate::walls::{BREATHES, Place, TWO_COLOURS, at, fills, is_black, is_blue, is_red, quit, wait_for};
use image::RgbaImage;
use mariana_testing::process::{output_of, wait_until};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, CreateWindowAux, WindowClass};

fn wait_for_half(place: &Place, right: bool, what: &str, wanted: impl Fn(&RgbaImage) -> bool) -> RgbaImage {
    let (width, height) = (SCREEN.0 / 2, SCREEN.1);
    let mut found = None;
    wait_until(what, || {
        let screen = place.desktop.screen();
        let half = image::imageops::crop_imm(&screen, u32::from(right) * width, 0, width, height).to_image();
        let is_there = wanted(&half);
        found = Some(half);
        is_there
    });
    found.unwrap()
}

/// Returns the bounds of the small output image in the control window, in pixels: left, top, right, bottom.
fn small_picture(desk: &RgbaImage) -> Option<[u32; 4]> {
    let mut found: Option<[u32; 4]> = None;
    for (x, y, pixel) in desk.enumerate_pixels() {
        let colour = [pixel[0], pixel[1], pixel[2]];
        if is_red(colour) || is_blue(colour) {
            let [left, top, right, bottom] = found.unwrap_or([x, y, x + 1, y + 1]);
            found = Some([left.min(x), top.min(y), right.max(x + 1), bottom.max(y + 1)]);
        }
    }
    let is_small = |[left, _, right, _]: &[u32; 4]| right - left < desk.width() / 2;
    // The small image must be red on the left and blue on the right.
    found.filter(is_small).filter(|[left, top, right, bottom]| {
        let row = (top + bottom) / 2;
        let colour = |x: u32| desk.get_pixel(x, row).0;
        let [first, last] =
            [colour(left + 1), colour(right - 2)].map(|[red, green, blue, _]| [red, green, blue]);
        is_red(first) && is_blue(last)
    })
}

fn is_dark(half: &RgbaImage) -> bool {
    half.pixels().all(|pixel| pixel.0[..3].iter().all(|value| *value < 80))
}

/// Dithering may change a channel by up to this number of steps.
const GRAIN: u8 = 2;

/// True if [`TWO_COLOURS`] fill an image without an overlay. Skips the columns at the edge between the colours, because
/// later frames draw the edge with more samples.
fn fills_cleanly(picture: &RgbaImage) -> bool {
    let is_near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= GRAIN);
    let (red, blue) = (at(picture, 0.0, 0.0), at(picture, 1.0, 0.0));
    let middle = picture.width() / 2;
    fills(picture)
        && picture.enumerate_pixels().all(|(x, _, pixel)| {
            let [r, g, b, _] = pixel.0;
            x.abs_diff(middle) <= EDGE || is_near([r, g, b], if x < middle { red } else { blue })
        })
}

/// Half of the width, in pixels, of the edge between the colours in a first frame of reduced resolution.
const EDGE: u32 = 8;

#[test]
fn an_output_fills_its_monitor_and_survives_a_lost_context_and_a_lost_monitor() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let half = SCREEN.0 as u16 / 2;
    place.desktop.plug_monitor("left", 0, half);
    place.desktop.plug_monitor("right", half as i16, half);
    let lost = [("MARIANA_FAULT", "context-lost@4")];
    let mut app = place.open_with(&lost, "two.scene", &["--output", "RIGHT"]);
    app.wait_until_reported("the driver has lost its context");
    app.xdotool(&["windowmove", "--sync", app.window(), "20", "60"]);
    wait_for_half(&place, true, "the output without overlay", fills_cleanly);
    // The control window shows only a small copy of the output image, with the output's aspect ratio.
    let (width, height) = app.size();
    let desk = wait_for(&app, "the desk", |picture| small_picture(picture).is_some());
    let [left, top, right, bottom] = small_picture(&desk).unwrap();
    let shape = f64::from(right - left) / f64::from(bottom - top);
    assert!((shape - f64::from(half) / f64::from(SCREEN.1)).abs() < 0.03, "{left}..{right}, {top}..{bottom}");
    assert!(
        3 * left >= 2 * width && right < width && top > 0 && 2 * bottom < height,
        "{left}..{right}, {top}..{bottom}"
    );
    let around = at(&desk, 0.3, 0.5);
    assert!(around == at(&desk, 0.99, 0.9) && !is_black(around) && around.iter().all(|part| *part < 40));
    // Messages, panels and the keyboard focus belong to the control window only. There, the overlay does not cover the
    // small image.
    app.press(&["h"]);
    let keys =
        wait_for(&app, "the keys", |picture| picture.pixels().any(|pixel| pixel.0[..3] > [180; 3][..]));
    assert_eq!(small_picture(&keys), Some([left, top, right, bottom]));
    let output = wait_for_half(&place, true, "the output", fills);
    assert!(fills_cleanly(&output), "an overlay covers the output");
    app.press(&["h", "x"]);
    wait_for_half(&place, true, "black", is_dark);
    app.press(&["x"]);
    wait_for_half(&place, true, "the output", fills);
    // The control window enlarges the image while everything else is hidden, and while its corners are moved.
    let shown = f64::from(height) * f64::from(half) / f64::from(SCREEN.1) / f64::from(width);
    let edge = 0.5 - 0.5 * shown as f32;
    for key in ["w", "y"] {
        app.press(&[key]);
        wait_for(&app, "the large image", |picture| {
            is_black(at(picture, edge - 0.03, 0.4))
                && is_red(at(picture, edge + 0.05, 0.4))
                && is_blue(at(picture, 0.95 - edge, 0.4))
                && is_black(at(picture, 1.03 - edge, 0.4))
        });
        app.press(&[key]);
        wait_for(&app, "the desk", |picture| small_picture(picture) == Some([left, top, right, bottom]));
    }
    for _ in 0..2 {
        place.desktop.pull_monitor("right");
        app.wait_until_reported(
            "the monitor RIGHT was disconnected: connect it again to show the image there",
        );
        wait_for_half(&place, true, "an empty disconnected monitor", is_dark);
        wait_for(&app, "the output in the window", |picture| is_red(at(picture, 0.02, 0.5)));
        // The output must return after each disconnection.
        place.desktop.plug_monitor("right", half as i16, half);
        wait_for_half(&place, true, "the output", fills);
    }
    let reported = quit(app);
    assert_eq!(reported.matches("the monitor RIGHT was disconnected").count(), 2, "{reported}");
}

#[test]
fn a_monitor_is_selected_by_number_and_the_small_image_takes_pointer_input() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let half = SCREEN.0 as u16 / 2;
    place.desktop.plug_monitor("left", 0, half);
    let mut app = place.open("two.scene", &["--output", "2", "-vv"]);
    app.wait_until_reported("there is no monitor 2, only left (400x600): connect 2 to show the image there");
    place.desktop.plug_monitor("right", half as i16, half);
    let listed = output_of(place.desktop.command(PROGRAM).args(["--output", "list"]), "mariana").unwrap();
    assert_eq!(String::from_utf8(listed).unwrap(), "1 left (400x600) at 0,0\n2 right (400x600) at 400,0\n");
    wait_for_half(&place, true, "the output", fills);
    app.press(&["g"]);
    wait_for(&app, "the settings", |picture| !is_red(at(picture, 0.45, 0.5)));
    app.press(&["g"]);
    app.xdotool(&["windowmove", "--sync", app.window(), "0", "100"]);
    let desk = wait_for(&app, "the desk", |picture| small_picture(picture).is_some());
    let [left, top, right, bottom] = small_picture(&desk).unwrap();
    let to = |app: &App<'_>, x: u32, y: u32| {
        app.xdotool(&["mousemove", "--window", app.window(), &x.to_string(), &y.to_string()]);
    };
    // A drag outside the image has no effect. A drag on the image turns the camera by the same angle as on a large
    // image.
    let drag = |app: &App<'_>, from: (u32, u32), way: u32| {
        to(app, from.0, from.1);
        app.xdotool(&["mousedown", "1"]);
        to(app, from.0 + way / 2, from.1);
        to(app, from.0 + way, from.1);
        app.xdotool(&["mouseup", "1"]);
    };
    drag(&app, (30, 50), right - left - 8);
    app.press(&["x"]);
    wait_for_half(&place, true, "a black output, drawn after all earlier input", is_dark);
    app.press(&["x"]);
    wait_for_half(&place, true, "the same view", fills);
    drag(&app, (left + 4, (top + bottom) / 2), right - left - 8);
    wait_for_half(&place, true, "another view", |half| !fills(half));
    app.press(&["Home"]);
    wait_for_half(&place, true, "the scene's own view", fills);
    // In the editor, a click on the small image probes the wall under the pointer.
    app.press(&["e"]);
    let (middle, quarter) = ((left + right) / 2, (right - left) / 4);
    for (number, x) in [middle - quarter, middle + quarter].into_iter().enumerate() {
        to(&app, x, (top + bottom) / 2);
        app.xdotool(&["click", "1"]);
        app.wait_until_reported_times("probed: Probed", number + 1);
        let reported = app.reported();
        let probed = reported.lines().filter(|line| line.contains("probed: Probed")).nth(number).unwrap();
        let (_, position) = probed.split_once("position: [").unwrap();
        let wall: Vec<f64> = position.split([',', ']']).map_while(|part| part.trim().parse().ok()).collect();
        // The click was a quarter of the image's width from the image's middle, on the wall at z = 5.
        assert!(wall[0].signum() == [-1.0, 1.0][number] && wall[1].abs() < 0.4, "{probed}");
    }
    // The output window closes together with the control window.
    quit(app);
    wait_for_half(&place, true, "an empty monitor after the end", is_dark);
}

fn ground<'d>(place: &'d Place, variables: &[(&str, &str)], options: &[&str]) -> App<'d> {
    let mut command = place.desktop.command(PROGRAM);
    let scene = place.path("two.scene");
    command.envs(variables.iter().copied()).args(["--silent", "-v", "--prepare-ahead", "off", "--scene"]);
    command.arg(scene).args(options).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut app = place.desktop.show_without_focus(command, Path::new(""));
    app.wait_until_reported("first picture after");
    app
}

#[test]
fn a_wallpaper_is_below_all_windows_takes_no_input_and_pauses_when_covered() {
    let place = Place::new(&[("two.scene", TWO_COLOURS), ("breathes.scene", BREATHES)]);
    let half = SCREEN.0 as u16 / 2;
    place.desktop.plug_monitor("left", 0, half);
    place.desktop.plug_monitor("right", half as i16, half);
    let mut wallpaper = ground(&place, &[], &["--wallpaper", "--fps-cap", "10"]);
    for right in [false, true] {
        wait_for_half(&place, right, "the wallpaper", fills);
    }
    // The wallpaper lets clicks through to the window below.
    let under_pointer = wallpaper.xdotool(&["mousemove", "100", "300", "getmouselocation", "--shell"]);
    assert!(!under_pointer.contains(&format!("WINDOW={}\n", wallpaper.window())), "{under_pointer}");
    // A window that opens later is above the wallpaper.
    let app = place.open("two.scene", &["--flip", "horizontal"]);
    app.xdotool(&["windowmove", "--sync", app.window(), "40", "200"]);
    wait_for_half(&place, false, "a window above the wallpaper", |half| {
        is_blue(at(half, 0.3, 0.5)) && is_red(at(half, 0.02, 0.02)) && is_blue(at(half, 0.98, 0.98))
    });
    wallpaper.xdotool(&["windowraise", wallpaper.window()]);
    wait_for(&app, "the window above the wallpaper", |picture| is_blue(at(picture, 0.2, 0.5)));
    quit(app);
    // One monitor replaces both monitors.
    place.desktop.pull_monitor("right");
    place.desktop.pull_monitor("left");
    wait_until("the wallpaper of one monitor", || fills(&place.desktop.screen()));
    // A covered wallpaper pauses.
    let app = place.open("breathes.scene", &[]);
    assert!(!wallpaper.reported().contains("the wallpaper pauses"), "{}", wallpaper.reported());
    app.press(&["f"]);
    wallpaper.wait_until_reported("the wallpaper pauses");
    app.press(&["f"]);
    wallpaper.wait_until_reported("the wallpaper continues");
    quit(app);
    assert!(wallpaper.runs());
}

#[test]
fn a_screen_saver_draws_into_its_window_and_ends_with_it() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let (server, root) = place.desktop.connect();
    let saver = server.generate_id().unwrap();
    let colors = CreateWindowAux::new().override_redirect(1).background_pixel(0);
    let kind = WindowClass::INPUT_OUTPUT;
    server.create_window(0, saver, root, 400, 0, 400, 600, 0, kind, 0, &colors).unwrap().check().unwrap();
    server.map_window(saver).unwrap().check().unwrap();
    let app = ground(&place, &[("XSCREENSAVER_WINDOW", &format!("{saver:#x}"))], &[]);
    wait_for_half(&place, true, "the frame in the screen saver's window", fills);
    server.destroy_window(saver).unwrap().check().unwrap();
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && !reported.contains("panicked"), "{status}: {reported}");
}

#[test]
fn a_wayland_output_is_a_full_screen_window_and_a_wallpaper_needs_the_layer_shell() {
    let compositor = Compositor::weston();
    let mut show =
        compositor.open(&[], &["--size", "160x90", "--scene", "length(p) - 1", "--output", "headless"]);
    for what in ["the output is on headless (640x360)", "first picture after"] {
        show.wait_until_reported(what);
    }
    let reported = show.end();
    assert!(!reported.contains("no output on another monitor"), "{reported}");
    let show = compositor.open(&[], &["--wallpaper", "--scene", "length(p) - 1"]);
    let (status, reported) = show.wait_for_end();
    assert_eq!(status.code(), Some(1), "{reported}");
    let last = reported.lines().last().unwrap();
    for part in ["this Wayland compositor", "zwlr_layer_shell_v1", "start Mariana in"] {
        assert!(last.contains(part), "{reported}");
    }
}
