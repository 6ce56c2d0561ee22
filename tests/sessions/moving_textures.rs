//! Videos as textures in a session.

#![cfg(target_os = "linux")]

use std::fs;
use std::process::Command;

use image::{Rgba, RgbaImage};

use crate::support::apart::apart;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::Place;
use mariana_testing::process::output_of;

const SIZE: &str = "64x36";

const SCENE: &str = "material paint { color = 0 roughness = 1\n\
                     emission = texture(\"clip.mp4\", vec2(0.5 + p.x / 7.2, 0.5 - p.y / 4.05)).rgb }\n\
                     object wall { shape = 5 - p.z material = paint }\n\
                     light none { direction = vec3(0, -1, 0) color = 0 }\n\
                     camera { position = vec3(0) target = vec3(0, 0, 5) }\n\
                     sky { color = 0 ambient = 0 }\n";

/// The still of the scene at a time in seconds.
fn still(place: &Place, at: &str) -> RgbaImage {
    let path = place.path(&format!("{at}.png"));
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg("still").arg(place.song()).arg(place.path("own.scene")).arg("-o").arg(&path);
    output_of(command.args(["--at", at, "--size", SIZE]), "mariana").unwrap();
    image::open(&path).unwrap().to_rgba8()
}

/// The share of equal pixels, except for the rounding of edges.
fn share(one: &RgbaImage, other: &RgbaImage) -> f64 {
    let is_equal =
        |(a, b): &(&Rgba<u8>, &Rgba<u8>)| (0..3).all(|channel| a[channel].abs_diff(b[channel]) <= 3);
    one.pixels().zip(other.pixels()).filter(is_equal).count() as f64 / f64::from(one.width() * one.height())
}

fn agree(one: &RgbaImage, other: &RgbaImage) -> bool {
    share(one, other) >= 1.0
}

#[test]
fn a_session_shows_the_frames_of_a_video_that_stills_show_also_after_seeks_and_without_the_file() {
    apart!();
    let place = Place::with_song();
    let clip = place.path("clip.mp4");
    let mut made = Command::new("ffmpeg");
    made.args(["-v", "error", "-nostdin", "-f", "lavfi", "-i", "testsrc=s=64x36:r=25:d=13"]);
    output_of(made.args(["-pix_fmt", "yuv420p"]).arg(&clip), "ffmpeg").unwrap();
    let scene = place.save("own.scene", SCENE);
    let stills: Vec<RgbaImage> = ["0", "5", "10", "15"].iter().map(|at| still(&place, at)).collect();
    for (number, one) in stills.iter().enumerate() {
        let others = stills.iter().skip(number + 1);
        assert!(others.clone().all(|other| !agree(one, other)), "still {number} equals another one");
    }
    let app = place.open(&place.song(), &["--size", SIZE, "--scene", scene.to_str().unwrap()]);
    let shows = |what: &str, number: usize| {
        app.wait_for(what, |picture| stills.get(number).is_some_and(|still| agree(picture, still)));
    };
    app.pause_at_start();
    shows("the first frame", 0);
    app.press(&["Right"; 3]);
    shows("a frame of the second round", 3);
    app.press(&["Left"]);
    shows("an earlier frame", 2);
    // Without the file, the last picture stays, and the video goes on when the file is back.
    fs::rename(&clip, place.path("away.mp4")).unwrap();
    app.press(&["Left"]);
    app.wait_until_reported("clip.mp4");
    app.take_steps(5);
    // Messages cover a part of the picture.
    let kept = share(&app.picture(), &stills[2]);
    assert!(kept > 0.3, "only {kept} of the last picture is left");
    fs::rename(place.path("away.mp4"), &clip).unwrap();
    shows("the frame of the file that came back", 1);
    let reported = app.quit_by_key();
    assert!(!reported.contains("panicked"), "{reported}");
}
