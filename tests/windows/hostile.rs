//! Failures of the program's environment: displays that end, compositors that hang, and too little memory.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::process::Stdio;
use std::time::Duration;

use crate::support::desktop::{Desktop, PROGRAM};
use crate::support::wayland::Compositor;
use mariana_testing::wave::write_wav;

/// The scene compiles quickly.
const SMALL: [&str; 5] = ["--silent", "--size", "160x90", "--scene", "length(p) - 1"];

/// The program's message after its display has ended.
pub(crate) const DISPLAY_LOST: &str = "mariana: the window is gone because its display ended or closed the connection: start \
                            Mariana in a running session\n";

#[test]
fn a_killed_x_server_ends_the_program_with_a_message() {
    let desktop = Desktop::start();
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 8_000, 2, (0..8_000 * 40).map(|_| 0.0));
    let mut app = desktop.open(&song, &SMALL);
    app.wait_for_title("the scene", |title| title.contains('('));
    assert_threads_share_heaps(app.process_id());
    desktop.kill_server();
    let (status, reported) = app.wait_for_end();
    assert_eq!((status.code(), reported.as_str()), (Some(1), DISPLAY_LOST));
}

fn assert_threads_share_heaps(process: u32) {
    /// glibc's heaps, except the first, begin at multiples of this size. They are at most this large.
    const HEAP: u64 = 64 << 20;
    /// If a heap is full, glibc starts a new heap. Without the program's limit, this test found fifteen heaps.
    const HEAPS_MAX: usize = 4;
    let of_process = |name: &str| format!("/proc/{}/{name}", process);
    let threads = std::fs::read_dir(of_process("task")).unwrap().count();
    let maps = std::fs::read_to_string(of_process("maps")).unwrap();
    let is_heap = |line: &&str| {
        let mut words = line.split_whitespace();
        let range = words.next().and_then(|range| range.split_once('-'));
        let start = range.and_then(|(start, _)| u64::from_str_radix(start, 16).ok()).unwrap();
        // Heaps are writable memory without a file.
        start.is_multiple_of(HEAP) && words.next() == Some("rw-p") && words.count() == 3
    };
    let heaps: Vec<&str> = maps.lines().filter(is_heap).collect();
    assert!(
        threads > 3 * HEAPS_MAX && heaps.len() <= HEAPS_MAX,
        "{threads} threads have {} heaps besides the first: {heaps:?}",
        heaps.len()
    );
}

#[test]
fn the_program_ends_when_its_compositor_hangs_or_is_killed() {
    let mut compositor = Compositor::weston();
    // The log shows when the first frame of the demo track is drawn.
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
fn the_program_runs_in_a_gibibyte_of_address_space() {
    let desktop = Desktop::start();
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 8_000, 2, (0..8_000 * 40).map(|_| 0.0));
    let mut limited = desktop.command("bash");
    limited.args(["-c", "ulimit -v 1048576; exec \"$@\"", "bash", PROGRAM]).args(SMALL).arg(&song);
    limited.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut app = desktop.show(limited, &song);
    app.wait_for_title("the scene", |title| title.contains('('));
    for _ in 0..3 {
        app.press(&["n"]);
        std::thread::sleep(Duration::from_millis(300));
    }
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
}
