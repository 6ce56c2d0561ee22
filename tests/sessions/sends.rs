//! Sending frames to other programs by FIFO and HTTP. The readers connect, disconnect and block.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;

use crate::support::session::App;
use crate::support::video_stream::{header, light_of_next};
use crate::walls::{Place, TWO_COLOURS, at, is_black, is_blue, is_red};
use mariana_testing::process::output_of;

#[test]
fn a_fifo_serves_changing_and_slow_readers() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("pictures");
    output_of(Command::new("mkfifo").arg(&fifo), "coreutils").unwrap();
    let to = format!("y4m:{}", fifo.display());
    let app = place.open("two.scene", &["--send", &to, "--send-size", "161x90", "--send-fps", "25"]);
    let mut gone = 0;
    let mut read = |app: &App, count: usize| {
        let pictures = app.meanwhile(|| {
            let mut stream = BufReader::new(File::open(&fifo).unwrap());
            let reported = header(&mut stream);
            assert!(
                reported.starts_with("YUV4MPEG2 W160 H90 F25:1 ") && reported.contains("C420"),
                "{reported}"
            );
            (0..count).map(|_| light_of_next(&mut stream, (160, 90))).collect::<Vec<_>>()
        });
        // Wait for the disconnection. A reader that opens the FIFO before the disconnection would continue in the
        // middle of the old stream.
        gone += 1;
        app.wait_until("the reader to disconnect", |app| {
            app.reported().matches("has disconnected: the next reader gets").count() == gone
        });
        pictures
    };
    // Red has a higher luma than blue.
    let wanted = |pictures: Vec<[u8; 2]>| pictures.iter().all(|[left, right]| left > right && *right > 16);
    assert!(wanted(read(&app, 30)));
    // A new reader gets the current frame, which is black now.
    app.press(&["x"]);
    app.wait_for("black", |picture| is_black(at(picture, 0.5, 0.5)));
    app.wait_until("black pictures", |app| read(app, 3).last() == Some(&[16, 16]));
    app.press(&["x"]);
    app.wait_until("light", |app| wanted(read(app, 2)));
    // A reader that opens the FIFO but does not read must not block the show.
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    app.wait_until_reported("has stopped reading: the show continues without it");
    app.press(&["x"]);
    app.wait_for("black", |picture| is_black(at(picture, 0.5, 0.5)));
    drop(blocks);
    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-f", "yuv4mpegpipe", "-read_intervals", "%+#2", "-show_entries"]);
    probe.args(["stream=width,height,r_frame_rate,pix_fmt", "-of", "csv=p=0"]).arg(&fifo);
    let reported = String::from_utf8(app.meanwhile(|| output_of(&mut probe, "ffmpeg")).unwrap()).unwrap();
    assert_eq!(reported.trim(), "160,90,yuv420p,25/1");
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    // A blocked reader must not delay the end of the session.
    let reported = app.quit_by_key();
    drop(blocks);
    assert_eq!(reported.matches("has stopped reading").count(), 1, "{reported}");
}

#[test]
fn a_client_on_this_machine_gets_jpegs() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    // This port was free just now.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let app = place.open("two.scene", &["--send", &format!("mjpeg:{port}"), "--send-size", "160x90"]);
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let mut lines = BufReader::new(stream);
    let mut next = || {
        let length: usize = loop {
            let line = header(&mut lines);
            if let Some(length) = line.strip_prefix("Content-Length: ") {
                break length.trim().parse().unwrap();
            }
        };
        assert_eq!(header(&mut lines), "\r\n");
        let mut jpeg = vec![0; length];
        lines.read_exact(&mut jpeg).unwrap();
        image::load_from_memory(&jpeg).unwrap().to_rgba8()
    };
    let seen = app.meanwhile(&mut next);
    assert_eq!(seen.dimensions(), (160, 90));
    assert!(is_red(at(&seen, 0.2, 0.5)) && is_blue(at(&seen, 0.8, 0.5)));
    app.press(&["x"]);
    app.wait_until("a black picture", |app| {
        at(&app.meanwhile(&mut next), 0.5, 0.5).iter().all(|value| *value < 3)
    });
    app.quit_by_key();
}

#[test]
fn standard_output_gets_frames_until_it_is_closed() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("out");
    output_of(Command::new("mkfifo").arg(&fifo), "coreutils").unwrap();
    // This handle opens both ends, so that opening the FIFO does not block.
    let both = OpenOptions::new().read(true).write(true).open(&fifo).unwrap();
    let out = OpenOptions::new().write(true).open(&fifo).unwrap();
    // Keep the test's standard output. The end of the test restores it.
    std::io::stdout().flush().unwrap();
    let own = rustix::io::dup(rustix::stdio::stdout()).unwrap();
    rustix::stdio::dup2_stdout(&out).unwrap();
    drop(out);
    let app = place.open("two.scene", &["--send", "y4m:-"]);
    let [left, right] = app.meanwhile(|| {
        let mut stream = BufReader::new(both);
        assert!(header(&mut stream).starts_with("YUV4MPEG2 W320 H180 F30:1 "));
        light_of_next(&mut stream, (320, 180))
    });
    assert!(left > right);
    app.wait_until_reported("the reader of standard output has disconnected");
    app.wait_for("the show", |picture| is_red(at(picture, 0.2, 0.5)));
    app.quit_by_key();
    rustix::stdio::dup2_stdout(&own).unwrap();
}
