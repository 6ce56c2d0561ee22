//! Wallpapers on Wayland desktops.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::hostile::DISPLAY_LOST;
use crate::support::wayland::{Compositor, Show};
use crate::walls::{BREATHES, TWO_COLOURS, at, fills, is_blue, is_red, wall};

fn wallpaper(compositor: &Compositor, emission: &str, variables: &[(&str, &str)]) -> Show {
    let scene = compositor.folder().join("wallpaper.scene");
    std::fs::write(&scene, wall(emission)).unwrap();
    let options = ["--wallpaper", "--quality", "best", "--fps-cap", "10", "--scene", scene.to_str().unwrap()];
    let mut show = compositor.open(variables, &options);
    show.wait_until_reported("first picture after");
    show
}

#[test]
fn a_wayland_wallpaper_fills_every_monitor_at_its_resolution() {
    let compositor = Compositor::sway(
        "output HEADLESS-1 resolution 320x180 position 0 0\n\
         output HEADLESS-2 resolution 300x240 scale 1.5 position 320 0\n",
    );
    let mut show = wallpaper(&compositor, TWO_COLOURS, &[]);
    compositor.wait_for_screen("HEADLESS-1", "the wallpaper", |screen| {
        screen.dimensions() == (320, 180) && fills(screen)
    });
    compositor.order("create_output");
    compositor.wait_for_screen("HEADLESS-2", "the wallpaper", |screen| {
        screen.dimensions() == (300, 240) && fills(screen)
    });
    show.wait_until_reported("the wallpaper is on HEADLESS-2 (300x240)");
    compositor.order("output HEADLESS-1 transform 90");
    compositor.wait_for_screen("HEADLESS-1", "the wallpaper", |screen| {
        screen.dimensions() == (180, 320) && fills(screen)
    });
    show.wait_until_reported("the wallpaper is on HEADLESS-1 (180x320)");
    compositor.order("workspace 1");
    let scene = compositor.folder().join("other.scene");
    std::fs::write(&scene, wall(TWO_COLOURS)).unwrap();
    let options = ["--clean", "--flip", "horizontal", "--scene", scene.to_str().unwrap()];
    let window = compositor.open(&[], &options);
    compositor.wait_for_screen("HEADLESS-1", "a window above the wallpaper", |screen| {
        is_blue(at(screen, 0.1, 0.5)) && is_red(at(screen, 0.9, 0.5))
    });
    window.end();
    compositor.wait_for_screen("HEADLESS-1", "the wallpaper", fills);
    assert!(!show.end().contains("the window system refuses"));
}

#[test]
fn a_wayland_wallpaper_survives_a_lost_context_pauses_when_covered_and_ends_with_its_compositor() {
    let mut compositor = Compositor::sway("output HEADLESS-1 resolution 320x180\n");
    let mut show = wallpaper(&compositor, BREATHES, &[("MARIANA_FAULT", "context-lost@4")]);
    show.wait_until_reported("the driver has lost its context");
    let first =
        compositor.wait_for_screen("HEADLESS-1", "the wallpaper", |screen| at(screen, 0.5, 0.5)[0] > 60);
    compositor.wait_for_screen("HEADLESS-1", "another picture", |screen| *screen != first);
    assert!(!show.reported().contains("the wallpaper pauses"), "{}", show.reported());
    let options = ["--clean", "--fullscreen", "--scene", "length(p) - 1"];
    let window = compositor.open(&[], &options);
    // The wallpaper reports a pause if it could not show a frame for a second.
    show.wait_until_reported("the wallpaper pauses");
    window.end();
    show.wait_until_reported("the wallpaper continues");
    let first = compositor.screen("HEADLESS-1").unwrap();
    compositor.wait_for_screen("HEADLESS-1", "another picture", |screen| *screen != first);
    compositor.kill();
    let (status, reported) = show.wait_for_end();
    assert_eq!(status.code(), Some(1), "{reported}");
    // The wallpaper's thread may log the end of its connection before or after the message.
    let is_for_the_user = |line: &&str| line.starts_with("mariana: ");
    let messages: String = reported.split_inclusive('\n').filter(is_for_the_user).collect();
    assert_eq!(messages, DISPLAY_LOST, "{reported}");
}

#[test]
fn a_wayland_wallpaper_takes_no_input_and_survives_disconnected_monitors() {
    let compositor = Compositor::sway_in_windows(
        "output X11-1 resolution 320x180\noutput X11-2 resolution 200x240\noutput X11-3 resolution 240x160\n",
    );
    // With this variable, the Wayland library logs all messages of the compositor.
    let mut show = wallpaper(&compositor, TWO_COLOURS, &[("WAYLAND_DEBUG", "client")]);
    assert!(show.reported().contains(".get_pointer("), "there is no pointer: {}", show.reported());
    compositor.order("seat * cursor set 40 40");
    compositor.order("seat * cursor set 60 90");
    compositor.order("create_output");
    for output in ["X11-1", "X11-2"] {
        compositor.wait_for_screen(output, "the wallpaper", fills);
    }
    let reported = show.reported();
    assert!(
        !reported.lines().any(|line| line.contains("wl_pointer") && line.contains(".enter(")),
        "{reported}"
    );
    compositor.pull("X11-2");
    show.wait_until_reported("the wallpaper leaves X11-2");
    compositor.wait_for_screen("X11-1", "the remaining wallpaper", fills);
    compositor.pull("X11-1");
    show.wait_until_reported("the wallpaper leaves X11-1");
    // All monitors are disconnected now. The next monitor gets the wallpaper.
    compositor.order("create_output");
    compositor.wait_for_screen("X11-3", "the wallpaper", |screen| {
        screen.dimensions() == (240, 160) && fills(screen)
    });
    assert!(show.runs());
    show.end();
}
