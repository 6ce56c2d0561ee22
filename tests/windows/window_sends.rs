//! The picture of the window in other programs: a FIFO, standard output and HTTP, with readers that come, go and block.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::Command;

use crate::support::desktop::App;
use crate::walls::{Place, TWO_COLOURS, at, is_black, is_blue, is_red, quit, wait_for};
use mariana_testing::process::{output_of, wait_until};

fn make_fifo(path: &Path) {
    output_of(Command::new("mkfifo").arg(path), "coreutils").unwrap();
}

/// Reads the header of a stream and gives it.
fn header(stream: &mut impl BufRead) -> String {
    let mut line = Vec::new();
    stream.read_until(b'\n', &mut line).unwrap();
    String::from_utf8(line).unwrap()
}

/// Reads a picture of a stream and gives the light of its left and its right.
fn light_of_next(stream: &mut impl BufRead, (width, height): (usize, usize)) -> [u8; 2] {
    assert_eq!(header(stream), "FRAME\n");
    let mut bytes = vec![0; width * height * 3 / 2];
    stream.read_exact(&mut bytes).unwrap();
    let row = &bytes[height / 2 * width..];
    [row[width / 4], row[3 * width / 4]]
}

#[test]
fn a_fifo_gets_pictures_whoever_reads_it_and_however_slowly() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("pictures");
    make_fifo(&fifo);
    let to = format!("y4m:{}", fifo.display());
    let mut app = place.open("two.scene", &["--send", &to, "--send-size", "161x90", "--send-fps", "25"]);
    let mut gone = 0;
    let mut read = |app: &App, count: usize| {
        let mut stream = BufReader::new(File::open(&fifo).unwrap());
        let told = header(&mut stream);
        assert!(told.starts_with("YUV4MPEG2 W160 H90 F25:1 ") && told.contains("C420"), "{told}");
        let pictures = (0..count).map(|_| light_of_next(&mut stream, (160, 90))).collect::<Vec<_>>();
        drop(stream);
        // Whoever opens it sooner is taken for the same reader, in the middle of the stream.
        gone += 1;
        wait_until("the reader's going", || {
            app.told().matches("has gone: the next one gets").count() == gone
        });
        pictures
    };
    // Of red more light is seen than of blue.
    let wanted = |pictures: Vec<[u8; 2]>| pictures.iter().all(|[left, right]| left > right && *right > 16);
    assert!(wanted(read(&app, 30)));
    // Another one, and what it is sent is what shows: a blackout.
    app.press(&["x"]);
    wait_for(&app, "black", |picture| is_black(at(picture, 0.5, 0.5)));
    wait_until("black pictures", || read(&app, 3).last() == Some(&[16, 16]));
    app.press(&["x"]);
    wait_until("light", || wanted(read(&app, 2)));
    // One that opens it and reads nothing holds nobody up.
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    app.wait_until_told("takes no pictures: the show goes on without it");
    app.press(&["x"]);
    wait_for(&app, "black", |picture| is_black(at(picture, 0.5, 0.5)));
    drop(blocks);
    // ffprobe knows what it is.
    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-f", "yuv4mpegpipe", "-read_intervals", "%+#2", "-show_entries"]);
    probe.args(["stream=width,height,r_frame_rate,pix_fmt", "-of", "csv=p=0"]).arg(&fifo);
    let told = String::from_utf8(output_of(&mut probe, "ffmpeg").unwrap()).unwrap();
    assert_eq!(told.trim(), "160,90,yuv420p,25/1");
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    // A receiver that blocks does not hold the end up either.
    let told = quit(app);
    drop(blocks);
    assert_eq!(told.matches("takes no pictures").count(), 1, "{told}");
}

#[test]
fn standard_output_gets_pictures_until_it_is_closed() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("out");
    make_fifo(&fifo);
    // So that neither end waits for the other.
    let both = OpenOptions::new().read(true).write(true).open(&fifo).unwrap();
    let out = OpenOptions::new().write(true).open(&fifo).unwrap();
    let scene = place.path("two.scene");
    let options = ["--silent", "--size", "160x90", "--scene", scene.to_str().unwrap(), "--send", "y4m:-"];
    let mut app = place.desktop.listen_printing_to(out.into(), &options);
    let mut stream = BufReader::new(both);
    assert!(header(&mut stream).starts_with("YUV4MPEG2 W160 H90 F30:1 "));
    let [left, right] = light_of_next(&mut stream, (160, 90));
    assert!(left > right);
    drop(stream);
    app.wait_until_told("whoever read standard output has gone");
    wait_for(&app, "the show", |picture| is_red(at(picture, 0.2, 0.5)));
    quit(app);
}

#[test]
fn a_client_on_this_machine_gets_jpegs() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let port = 41_000 + (std::process::id() % 20_000) as u16;
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
    let seen = next();
    assert_eq!(seen.dimensions(), (160, 90));
    assert!(is_red(at(&seen, 0.2, 0.5)) && is_blue(at(&seen, 0.8, 0.5)));
    app.press(&["x"]);
    wait_until("a black picture", || at(&next(), 0.5, 0.5).iter().all(|value| *value < 3));
    quit(app);
}
