//! Videos, cameras and covers as textures, in stills and videos.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::program::{Outcome, Workplace};
use image::RgbImage;

const LOOK: [&str; 4] = ["--size", "64x36", "--tone-map", "none"];

/// A place with a song of six seconds, and a video of two seconds with 25 frames a second.
fn place() -> Workplace {
    let place = Workplace::new();
    place.write_tone("song.wav", 440.0, 6.0, [0.5, 0.5]);
    place.ffmpeg(&["-f", "lavfi", "-i", "testsrc=s=64x36:r=25:d=2", "-pix_fmt", "yuv420p"], "clip.mp4");
    place
}

fn write_scene(place: &Workplace, name: &str, texture: &str) {
    let text = format!(
        "material paint {{ color = 0 roughness = 1 \
         emission = texture(\"{texture}\", vec2(0.5 + p.x / 7.2, 0.5 - p.y / 4.05)).rgb }}\n\
         object wall {{ shape = 5 - p.z material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0) color = 0 }}\n\
         camera {{ position = vec3(0) target = vec3(0, 0, 5) }}\nsky {{ color = 0 ambient = 0 }}\n"
    );
    place.write(name, text);
}

fn picture(place: &Workplace, name: &str) -> RgbImage {
    image::load_from_memory(&place.read(name)).unwrap().to_rgb8()
}

fn still_run(place: &Workplace, scene: &str, at: &str) -> (Outcome, RgbImage) {
    let name = format!("{scene} {at}.png");
    let run = place.run(&[&["still", "song.wav", scene, "--at", at, "-o", &name], &LOOK[..]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    (run, picture(place, &name))
}

fn still(place: &Workplace, scene: &str, at: &str) -> RgbImage {
    let (run, picture) = still_run(place, scene, at);
    run.done();
    picture
}

fn spread(picture: &RgbImage) -> u8 {
    let values = || picture.pixels().flat_map(|pixel| pixel.0);
    values().max().unwrap() - values().min().unwrap()
}

#[test]
fn stills_show_the_frames_of_the_video_at_their_times() {
    let place = place();
    write_scene(&place, "own.scene", "clip.mp4");
    let part = ["--start", "0.4", "--duration", "3.2", "--fps", "5", "--scene", "own.scene", "-o", "frames/"];
    place.run(&[&["video", "song.wav"], &part[..], &LOOK[..]].concat()).done();
    let of_video = |number: usize| picture(&place, &format!("frames/frame-{number:05}.png"));
    for (at, number) in [("0.4", 0), ("1.8", 7), ("2.2", 9)] {
        assert!(still(&place, "own.scene", at) == of_video(number), "the still at {at} s differs");
    }
    assert!(of_video(0) != of_video(1), "the video stands still");
    assert!(of_video(0) == of_video(10), "the video does not repeat after two seconds");
    assert!(spread(&of_video(3)) > 200, "the video is not visible");
}

#[test]
fn sources_without_pictures_are_grey_and_reported_once() {
    let place = place();
    write_scene(&place, "own.scene", "clip.mp4");
    write_scene(&place, "camera.scene", "camera 2");
    write_scene(&place, "sound.scene", "sound.mp4");
    place.ffmpeg(&["-f", "lavfi", "-i", "sine=d=1"], "sound.mp4");
    for (scene, words) in
        [("camera.scene", "camera 2 is live only"), ("sound.scene", "sound.mp4 has no moving")]
    {
        let (run, picture) = still_run(&place, scene, "1");
        run.assert_advises();
        assert!(run.stderr.contains(words) && run.stderr.lines().count() == 1, "{run:?}");
        let middle = picture.get_pixel(32, 18).0;
        assert!(spread(&picture) < 12 && middle.iter().all(|value| (100..140).contains(value)), "{middle:?}");
    }
    let checked = place.run(&["check", "own.scene", "sound.scene", "camera.scene"]).done();
    for words in
        ["clip.mp4: 64 x 36 pixels, 25 frames", "after 2.00 s", "sound.mp4 has no moving", "live only"]
    {
        assert!(checked.contains(words), "{words} is missing: {checked}");
    }
    let mut without = place.command(&["check", "own.scene"]);
    let checked = Outcome::of(without.env("PATH", "/nowhere")).done();
    assert!(checked.contains("clip.mp4 needs ffmpeg, which is not installed: install ffmpeg"), "{checked}");
    let warned = Outcome::of(&mut place.command(&["check", "--json", "sound.scene"])).done();
    assert!(warned.contains("\"warning\"") && warned.contains("\"line\":1,"), "{warned}");

    write_scene(&place, "none.scene", "clap.mp4");
    let refused = place.run(&["still", "song.wav", "none.scene", "-o", "none.png"]);
    assert!(refused.code == 1 && refused.stderr.contains("there is no video `clap.mp4`"), "{refused:?}");
    assert!(refused.stderr.contains("clip.mp4"), "{refused:?}");
}

#[test]
fn the_cover_comes_from_the_song_or_its_name() {
    let place = place();
    write_scene(&place, "cover.scene", "cover");
    let painted = still(&place, "cover.scene", "1");
    place.write_tone("other.wav", 440.0, 2.0, [0.5, 0.5]);
    place.run(&[&["still", "other.wav", "cover.scene", "-o", "other.png"], &LOOK[..]].concat()).done();
    assert!(spread(&painted) > 12 && picture(&place, "other.png") != painted);
    let blue = RgbImage::from_pixel(40, 40, image::Rgb([0, 0, 255]));
    blue.save(place.path("cover.png")).unwrap();
    let [red, _, blue] = still(&place, "cover.scene", "2").get_pixel(32, 18).0;
    assert!(blue > 240 && red < 16, "the cover in the folder is not shown: {red}, {blue}");
}
