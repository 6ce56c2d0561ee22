//! Videos and pictures that the window makes.

#![cfg(target_os = "linux")]

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;

use crate::support::apart::apart;
use crate::support::session::{App, Place};
use image::RgbaImage;
use mariana::commands::{Command, Edge, JobAction, Mark, VideoChoice, VideoEdit};

/// A wall whose colour follows nothing, so that a frame is drawn quickly.
const WALL: &str = "param light = 0.5 in 0 .. 1\n\
                    material paint { color = 0  roughness = 1  emission = light * vec3(0.9, 0.2, 0.1) }\n\
                    object wall { shape = 5 - p.z  material = paint }\n\
                    light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                    camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                    sky { color = 0  ambient = 0 }\n";

/// The last option of the row of places is the size of the window.
const WINDOW_SIZE: usize = 10;

fn choose(app: &App, what: VideoChoice, option: usize) {
    app.command(Command::Video(VideoEdit::Choose { what, option }));
}

fn act(app: &App, id: u64, action: JobAction) {
    app.command(Command::Video(VideoEdit::Job { id, action }));
}

/// Opens a small window, and the panel with a part of one second.
fn open(place: &Place) -> App {
    let scene = place.save("wall.scene", WALL);
    let app = place.open(&place.song(), &["--scene", scene.to_str().unwrap(), "--size", "160x90"]);
    app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
    app.press(&["F10"]);
    choose(&app, VideoChoice::Place, WINDOW_SIZE);
    for (edge, at) in [(Edge::Start, 2.0), (Edge::End, 3.0)] {
        app.command(Command::Mark(Mark { edge, at: Some(at) }));
    }
    app
}

fn make(app: &App) {
    app.command(Command::Video(VideoEdit::Make));
}

fn videos(place: &Place) -> Vec<String> {
    let entries = std::fs::read_dir(place.path("videos")).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn queue(place: &Place) -> String {
    std::fs::read_to_string(place.path("state/videos.json")).unwrap_or_default()
}

/// Replaces the program that renders by a shell script, in which `$MARIANA` is the program.
fn render_by(place: &mut Place, script: &str) -> PathBuf {
    let text = format!("#!/bin/sh\nMARIANA='{}'\n{script}\n", env!("CARGO_BIN_EXE_mariana"));
    let path = place.save("renderer", &text);
    std::fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
    place.draw_by(path.clone());
    path
}

fn length_of(place: &Place, name: &str) -> f64 {
    let mut probe = std::process::Command::new("ffprobe");
    probe.args(["-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0"]);
    let output = probe.arg(place.path("videos").join(name)).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}

#[test]
fn enter_makes_a_video_of_the_marked_part_and_replaces_no_file() {
    apart!();
    let place = Place::with_song();
    place.save("videos/quiet.mp4", "another video");
    let app = open(&place);
    app.press(&["Return", "Return"]);
    app.wait_for_title("progress", |title| title.contains("video "));
    assert!(queue(&place).contains("quiet 3.mp4"), "{}", queue(&place));
    app.wait_until_reported("quiet 2.mp4");
    app.wait_until_reported("the video is ready: ");
    app.wait_until("both videos", |_| videos(&place) == ["quiet 2.mp4", "quiet 3.mp4", "quiet.mp4"]);
    app.wait_until("an empty queue", |_| queue(&place).trim() == "[]");
    app.wait_for_title("no video", |title| !title.contains("video"));
    assert_eq!(std::fs::read(place.path("videos/quiet.mp4")).unwrap(), b"another video");
    for name in ["quiet 2.mp4", "quiet 3.mp4"] {
        let length = length_of(&place, name);
        assert!((length - 1.0).abs() < 0.1, "{name} has {length} s");
    }
    app.quit_content();
}

#[test]
fn a_paused_video_continues_and_a_cancelled_one_leaves_nothing() {
    apart!();
    let place = Place::with_song();
    let app = open(&place);
    app.command(Command::Mark(Mark { edge: Edge::End, at: Some(50.0) }));
    make(&app);
    app.wait_for_title("percent", |title| title.contains("video ") && title.contains('%'));
    act(&app, 1, JobAction::Pause);
    app.wait_for_title("a pause", |title| title.contains("video paused"));
    act(&app, 1, JobAction::Continue);
    app.wait_for_title("percent", |title| title.contains("video ") && title.contains('%'));
    app.wait_until("an unfinished file", |_| !videos(&place).is_empty());
    act(&app, 1, JobAction::Remove);
    app.wait_until("no file", |_| videos(&place).is_empty());
    app.wait_for_title("no video", |title| !title.contains("video"));
    assert_eq!(queue(&place).trim(), "[]");
    app.quit_content();
}

#[test]
fn the_end_of_the_program_keeps_the_queue_and_the_next_start_offers_it() {
    apart!();
    let place = Place::with_song();
    let app = open(&place);
    app.command(Command::Mark(Mark { edge: Edge::End, at: Some(50.0) }));
    make(&app);
    app.wait_for_title("percent", |title| title.contains("video ") && title.contains('%'));
    // Q asks first.
    app.press(&["q"]);
    assert!(app.runs());
    app.wait_until_reported("press Q again");
    app.press(&["q"]);
    assert!(!app.runs(), "the second Q quits");
    app.quit();
    mariana_testing::process::wait_until("the end of the renderer", || videos(&place).is_empty());
    let app = open(&place);
    app.wait_until_reported("a video is unfinished: press F10");
    app.take_steps(20);
    assert!(!app.title().contains("video"), "nothing is rendered before the user wants it");
    // The choices are kept, so this makes the same video.
    act(&app, 1, JobAction::Continue);
    app.wait_for_title("percent", |title| title.contains("video ") && title.contains('%'));
    act(&app, 1, JobAction::Remove);
    app.wait_until("an empty queue", |_| queue(&place).trim() == "[]");
    app.quit_content();
}

#[test]
fn a_crash_is_tried_again_once_and_an_error_is_told_at_once() {
    apart!();
    let mut place = Place::with_song();
    // The first run kills itself, as a crashing driver would. Measurements have another output.
    let script = "case \"$4\" in *quiet.mp4) echo run >> runs; [ $(wc -l < runs) = 1 ] && kill -9 $$;; esac\n\
                  exec \"$MARIANA\" \"$@\"";
    let runs = place.path("runs");
    render_by(&mut place, &script.replace("runs", runs.to_str().unwrap()));
    let app = open(&place);
    make(&app);
    app.wait_until_reported("the video is ready: ");
    assert_eq!(std::fs::read_to_string(&runs).unwrap().lines().count(), 2);
    app.quit_content();
    render_by(&mut place, "kill -9 $$");
    let app = open(&place);
    make(&app);
    app.wait_until_reported("the renderer crashed twice, the last time with: signal: 9");
    // The song vanishes while the window plays it.
    app.quit_content();
    render_by(&mut place, "exec \"$MARIANA\" \"$@\"");
    let app = open(&place);
    std::fs::remove_file(place.song()).unwrap();
    make(&app);
    app.wait_until_reported("was not made: ");
    app.wait_until_reported("quiet.wav does not exist");
    assert!(queue(&place).contains("\"failed\""), "a failed video can be tried again");
    app.quit_content();
}

#[test]
fn a_full_disk_and_a_missing_encoder_cost_one_sentence() {
    apart!();
    let mut place = Place::with_song();
    // No file may become larger than 4 KiB.
    render_by(&mut place, "ulimit -f 4; exec \"$MARIANA\" \"$@\"");
    let app = open(&place);
    make(&app);
    app.wait_until_reported("was not made: ffmpeg could not write ");
    app.wait_until_reported(": choose another folder");
    assert_eq!(videos(&place), [""; 0]);
    app.quit_content();
    render_by(&mut place, "PATH=/nowhere exec \"$MARIANA\" \"$@\"");
    let app = open(&place);
    make(&app);
    app.wait_until_reported("install ffmpeg");
    app.quit_content();
}

#[test]
fn a_damaged_queue_is_kept_aside() {
    apart!();
    let place = Place::with_song();
    place.save("state/videos.json", "rubbish");
    let app = open(&place);
    app.wait_until_reported("the list of unfinished videos cannot be read");
    assert_eq!(std::fs::read_to_string(place.path("state/videos damaged.json")).unwrap(), "rubbish");
    app.quit_content();
}

#[test]
fn an_input_and_an_unsaved_variation_are_refused_with_a_reason() {
    apart!();
    let place = Place::with_song();
    let app = open(&place);
    app.press(&["F5"]);
    app.wait_until_reported("F7 keep");
    app.wait_for_title("the variation", |title| title.contains("wall-"));
    make(&app);
    app.wait_until_reported("press F7 to keep it");
    app.quit_content();
}

fn pictures(place: &Place) -> Vec<(String, RgbaImage)> {
    let entries = std::fs::read_dir(place.path("pictures")).into_iter().flatten().flatten();
    let mut found: Vec<_> = entries
        .filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'))
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, image::open(entry.path()).unwrap().into_rgba8())
        })
        .collect();
    found.sort_by(|(a, _), (b, _)| a.cmp(b));
    found
}

#[test]
fn a_picture_of_a_moving_scene_was_never_saved() {
    apart!();
    let place = Place::with_song();
    let app = place.open(&place.song(), &["--scene", "orb", "--size", "480x270"]);
    app.wait_until_reported("first picture");
    app.press(&["F12"]);
    app.wait_until("the picture", |_| pictures(&place).len() == 1);
    app.quit_content();
}

#[test]
fn the_picture_key_saves_the_frame_without_panels_and_shift_doubles_it() {
    apart!();
    let place = Place::with_song();
    let app = open(&place);
    app.press(&["space", "Escape"]);
    let bare = app.wait_until_still();
    app.press(&["h"]);
    for (number, key) in [(1, "F12"), (2, "F12"), (3, "shift+F12")] {
        app.press(&[key]);
        app.wait_until("the picture", |_| pictures(&place).len() == number);
    }
    app.wait_until_reported("saved as ");
    let pictures = pictures(&place);
    let names: Vec<&str> = pictures.iter().map(|(name, _)| name.as_str()).collect();
    assert!(names.iter().all(|name| name.starts_with("quiet.wav 0.0")), "{names:?}");
    let mut sizes: Vec<_> = pictures.iter().map(|(_, picture)| picture.dimensions()).collect();
    sizes.sort();
    assert_eq!(sizes, [(160, 90), (160, 90), (320, 180)]);
    let of_window = &pictures.iter().find(|(_, picture)| picture.width() == 160).unwrap().1;
    let differ = of_window
        .pixels()
        .zip(bare.pixels())
        .filter(|(a, b)| (0..3).any(|channel| a.0[channel].abs_diff(b.0[channel]) > 2));
    assert_eq!(differ.count(), 0, "the picture shows something else than the frame");
    // Letters search in the table of keys while it is open.
    app.press(&["F1"]);
    app.quit_content();
}
