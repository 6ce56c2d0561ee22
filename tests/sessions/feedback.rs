//! Feedback and inertia in a session: its frames equal stills and the frames of videos.

#![cfg(target_os = "linux")]

use image::RgbaImage;

use crate::support::apart::apart;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::Place;
use mariana_testing::process::output_of;

const SIZE: &str = "64x36";

/// A scene of this colour, whose bright ball leaves trails, and whose brightness has inertia.
fn scene(color: &str) -> String {
    format!(
        "let q = (pixel - resolution / 2) / resolution.y\n\
         let bright = 1 + spring(volume.x, 60, 3) + follow(band(9), 0.3, 1.5) + 0.1 * since(beat > 0.4)\n\
         sky {{ color = {color} * bright * smoothstep(0.1, 0.05, length(q - 0.3 * vec2(cos(9 * t), sin(7 * t)))) }}\n\
         picture {{ decay = 0.85  warp = (pixel / resolution - 0.5) * 0.97 + 0.5 }}"
    )
}

fn run(place: &Place, arguments: &[&str], output: &str) {
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg(arguments[0]).arg(place.song()).args(&arguments[1..]).arg("-o").arg(output);
    output_of(command.args(["--size", SIZE]), "mariana").unwrap();
}

fn still(place: &Place, scene: &str, at: &str) -> RgbaImage {
    let output = place.path("still.png");
    run(place, &["still", "--scene", scene, "--at", at], output.to_str().unwrap());
    image::open(&output).unwrap().to_rgba8()
}

#[test]
fn a_session_shows_the_feedback_of_stills_and_videos_also_after_seeks_and_changes() {
    apart!();
    let place = Place::with_song();
    let path = |name: &str| place.path(name).to_str().unwrap().to_owned();
    place.save("red.scene", &scene("vec3(1, 0.1, 0.1)"));
    place.save("blue.scene", &scene("vec3(0.1, 0.1, 1)"));
    let (red, blue) = (path("red.scene"), path("blue.scene"));
    let times = ["0", "5", "10", "15", "20"];
    let stills: Vec<RgbaImage> = times.iter().map(|at| still(&place, &red, at)).collect();
    for rate in ["30", "60", "144"] {
        for (at, wanted) in times.iter().zip(&stills) {
            // The video begins a little before the moment, and shows it in its last frame.
            let start = (at.parse::<f64>().unwrap() - 0.5).max(0.0);
            let frames =
                ((at.parse::<f64>().unwrap() - start) * rate.parse::<f64>().unwrap()).round() as usize;
            let folder = path(&format!("video {rate} {at}/"));
            let length = (frames as f64 + 0.5) / rate.parse::<f64>().unwrap();
            let (start, length) = (start.to_string(), length.to_string());
            let video = ["video", "--scene", &red, "--start", &start, "--duration", &length, "--fps", rate];
            run(&place, &video, &folder);
            let mut files: Vec<_> =
                std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path()).collect();
            files.sort();
            assert_eq!(files.len(), frames + 1);
            let last = image::open(files.last().unwrap()).unwrap().to_rgba8();
            assert!(last == *wanted, "the frame of a video at {rate} frames a second differs at {at} s");
        }
    }
    let app =
        place.open(&place.song(), &["--size", SIZE, "--fade", "0", "--sdf", "compiled", "--scene", &red]);
    app.pause_at_start();
    app.wait_for("the still of 0 s", |picture| *picture == stills[0]);
    for (at, wanted) in times.iter().zip(&stills).skip(1) {
        app.press(&["Right"]);
        app.wait_for(&format!("the still of {at} s"), |picture| picture == wanted);
    }
    app.press(&["Left"]);
    app.wait_for("the still of 15 s after a jump back", |picture| *picture == stills[3]);
    let other = still(&place, &blue, "15");
    place.save("red.scene", &scene("vec3(0.1, 0.1, 1)"));
    app.wait_for("the other scene without the trails of the first", |picture| *picture == other);
    place.save("red.scene", &scene("vec3(1, 0.1, 0.1)"));
    app.wait_for("the first scene again", |picture| *picture == stills[3]);
    app.quit_by_key();
}
