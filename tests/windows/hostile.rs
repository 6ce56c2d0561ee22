//! What a hostile evening does to the program: displays that go, too little memory.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::process::Stdio;
use std::time::Duration;

use crate::support::desktop::{Desktop, PROGRAM};
use crate::support::wayland::Compositor;
use mariana_testing::wave::write_wav;

/// A small window with a scene that is there at once.
const SMALL: [&str; 5] = ["--silent", "--size", "160x90", "--scene", "length(p) - 1"];

/// What is said of a display that goes.
pub(crate) const DISPLAY_LOST: &str = "mariana: the window is gone because its display ended or closed the connection: start \
                            Mariana in a running session\n";

/// How long the program may take to find that out.
const END_LIMIT: Duration = Duration::from_secs(30);

#[test]
fn an_x_server_that_was_killed_ended_the_show_by_xlibs_words_and_exit() {
    let desktop = Desktop::start();
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 48_000, 2, (0..48_000 * 40).map(|_| 0.0));
    let mut app = desktop.open(&song, &SMALL);
    app.wait_for_title("that the scene is shown", |title| title.contains('('));
    assert_threads_fraction_heaps(app.process_id());
    desktop.kill_server();
    let (status, reported) = app.wait_for_end(END_LIMIT);
    assert_eq!((status.code(), reported.as_str()), (Some(1), DISPLAY_LOST));
}

/// Each thread kept a heap of its own.
fn assert_threads_fraction_heaps(process: u32) {
    /// glibc's heaps, but for the first one, begin at multiples of this, and have this size at most.
    const HEAP: u64 = 64 << 20;
    /// The second heap goes over into another of that size when it is full. Before, there were fifteen.
    const HEAPS_MAX: usize = 4;
    let of_process = |name: &str| format!("/proc/{}/{name}", process);
    let threads = std::fs::read_dir(of_process("task")).unwrap().count();
    let maps = std::fs::read_to_string(of_process("maps")).unwrap();
    let is_heap = |line: &&str| {
        let mut words = line.split_whitespace();
        let range = words.next().and_then(|range| range.split_once('-'));
        let start = range.and_then(|(start, _)| u64::from_str_radix(start, 16).ok()).unwrap();
        // Memory that can be written, of no file.
        start.is_multiple_of(HEAP) && words.next() == Some("rw-p") && words.count() == 3
    };
    let heaps: Vec<&str> = maps.lines().filter(is_heap).collect();
    assert!(
        threads > 3 * HEAPS_MAX && heaps.len() <= HEAPS_MAX,
        "{threads} threads have {} heaps beside the first: {heaps:?}",
        heaps.len()
    );
}

#[test]
fn a_wayland_compositor_that_stood_still_or_was_killed_left_a_show_that_never_ended() {
    let mut compositor = Compositor::weston();
    // The demo track; what it logs tells when it shows.
    let mut show = compositor.open(&[], &SMALL[1..]);
    show.wait_until_reported("first picture");
    compositor.stop();
    show.ask_to_end();
    let (status, reported) = show.wait_for_end();
    assert_eq!(status.code(), Some(128 + 15), "{reported}");
    assert!(!reported.contains("panicked"), "{reported}");

    compositor.go_on();
    let mut show = compositor.open(&[], &SMALL[1..]);
    show.wait_until_reported("first picture");
    compositor.kill();
    let (status, reported) = show.wait_for_end();
    assert_eq!(status.code(), Some(1), "{reported}");
    assert!(reported.ends_with(DISPLAY_LOST), "{reported}");
}

#[test]
fn a_gibibyte_of_address_space_killed_the_program_within_a_driver() {
    let desktop = Desktop::start();
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 48_000, 2, (0..48_000 * 40).map(|_| 0.0));
    let mut limited = desktop.command("bash");
    limited.args(["-c", "ulimit -v 1048576; exec \"$@\"", "bash", PROGRAM]).args(SMALL).arg(&song);
    limited.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut app = desktop.show(limited, &song);
    app.wait_for_title("that the scene is shown", |title| title.contains('('));
    for _ in 0..3 {
        app.press(&["n"]);
        std::thread::sleep(Duration::from_millis(300));
    }
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end(END_LIMIT);
    assert!(status.success(), "{status}: {reported}");
}
