//! Flags for outputs to screens and other programs: accepted values, and values refused before a window opens.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::net::TcpListener;

use crate::support::program::{Outcome, Workplace};

#[test]
fn invalid_targets_for_sending_are_refused() {
    let place = Workplace::new();
    place.write("file", "kept");
    let send = |to: &str| place.run(&["--silent", "--send", to]);
    send("y4m:file").refused(&["file", "it is no FIFO", "mkfifo"]);
    assert_eq!(place.read("file"), b"kept");
    send("y4m:nowhere").refused(&["nowhere", "there is no such FIFO"]);
    send("v4l2:/dev/video-none").refused(&["/dev/video-none", "modprobe v4l2loopback"]);
    send("v4l2:file").refused(&["it is no device"]);
    let taken = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port();
    send(&format!("mjpeg:{port}")).refused(&[&port.to_string(), "choose another port"]);
    for (to, part) in [
        ("ndi:x", "y4m:FIFO"),
        ("mjpeg:0", "no port"),
        ("y4m:", "is incomplete"),
        ("", "write the target as"),
    ] {
        send(to).refused_arguments("--send", &[part]);
    }
    // Eight outputs are allowed.
    let many: Vec<String> = (0..9).map(|n| format!("y4m:{n}")).collect();
    let flags: Vec<&str> = many.iter().flat_map(|to| ["--send", to.as_str()]).collect();
    place.run(&flags).refused(&["at most 8 targets, not 9"]);
}

#[test]
fn numbers_out_of_range_are_refused() {
    let place = Workplace::new();
    for (flag, value, part) in [
        ("--brightness", "101", "0 to 100"),
        ("--blackout-fade", "-1", "0 to 60"),
        ("--flip", "over", "horizontal"),
        ("--crop", "50,0,50,0", "0 to 90"),
        ("--crop", "1,2,3", "4 numbers"),
        ("--corners", "0,0,100,100,100,0,0,100", "clockwise"),
        ("--corners", "0,0,300,0,100,100,0,100", "one screen"),
        ("--send-fps", "0", "1 to 1000"),
        ("--send-size", "0x9", "1 to 16384"),
    ] {
        let reported = place.run(&["--send", "mjpeg:9", flag, value]);
        assert_eq!(reported.code, 2, "{reported:?}");
        assert!(
            reported.stderr.contains(flag) && reported.stderr.contains(part),
            "'{part}' is missing in the message: {reported:?}"
        );
    }
}

#[test]
fn without_an_x_server_monitor_lists_wallpapers_and_savers_are_refused() {
    let place = Workplace::new();
    place.run(&["--output", "list"]).refused(&[
        "monitors can be listed on X11 only",
        "there is no display",
        "start Mariana",
    ]);
    place.run(&["--wallpaper"]).refused(&[
        "monitors can be listed on X11 only",
        "there is no display",
        "start Mariana",
    ]);
    let mut wayland = place.command(&["--wallpaper"]);
    wayland.env("WAYLAND_DISPLAY", "wayland-none");
    Outcome::of(&mut wayland).refused(&["cannot open a window", "start Mariana"]);
    for number in ["nothing", "0", "0x7fffffff"] {
        let mut saver = place.command(&["--silent"]);
        saver.env("XSCREENSAVER_WINDOW", number);
        Outcome::of(&mut saver).refused(&["XSCREENSAVER_WINDOW", number, "unset it"]);
    }
}
