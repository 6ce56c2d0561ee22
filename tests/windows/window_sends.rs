//! The picture of the window on the program's standard output.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs::OpenOptions;
use std::io::BufReader;
use std::process::Command;

use crate::support::video_stream::{header, light_of_next};
use crate::walls::{Place, TWO_COLOURS, at, is_red, quit, wait_for};
use mariana_testing::process::output_of;

#[test]
fn standard_output_gets_pictures_until_it_is_closed() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("out");
    output_of(Command::new("mkfifo").arg(&fifo), "coreutils").unwrap();
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
