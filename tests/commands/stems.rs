//! The parts of a song, read from its stems: in stills, videos and text, and with broken stems.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::song_numbers::{LOOK, colour, write_wall};
use crate::support::program::Workplace;

fn stems(place: &Workplace, folder: &str) {
    std::fs::create_dir_all(place.path(folder)).unwrap();
}

#[test]
fn stills_and_videos_show_the_parts_in_both_modes() {
    let place = Workplace::new();
    stems(&place, "song.stems");
    place.write_tone("song.wav", 440.0, 4.0, [0.5; 2]);
    place.write_tone("song.stems/drums.wav", 440.0, 4.0, [0.0; 2]);
    // Another rate, one channel and another format.
    let tone = "sine=f=440:d=4:r=22050,volume=4,aformat=channel_layouts=mono";
    place.ffmpeg(&["-f", "lavfi", "-i", tone], "song.stems/Vocals.FLAC");
    // The bands of the tone are right of the middle: the index depends on the point.
    write_wall(
        &place,
        "parts.scene",
        "vec3(drums.volume.x + drums.band(11) + 0.2 * volume.x, vocals.volume.y, vocals.band(11.5 + 9 * p.x))",
    );
    let run = |arguments: &[&str]| place.run(&[arguments, &LOOK[..]].concat()).done();
    for mode in ["compiled", "interpreted"] {
        run(&["still", "song.wav", "parts.scene", "--at", "2", "--sdf", mode, "-o", &format!("{mode}.png")]);
    }
    let [red, green, blue] = colour(&place, "compiled.png");
    // The mix has a volume of 0.318, and both stems are analysed like the mix, so the silent part adds nothing.
    assert!((69..=71).contains(&red), "{red} is not 0.2 * 0.318");
    assert!(green > 130 && blue > 150, "{green} {blue}");
    let picture = image::load_from_memory(&place.read("compiled.png")).unwrap().to_rgb8();
    assert!(picture.get_pixel(0, 9).0[2] < 30, "{:?}", picture.get_pixel(0, 9));
    let other = image::load_from_memory(&place.read("interpreted.png")).unwrap().to_rgb8();
    let differs =
        picture.pixels().zip(other.pixels()).any(|(a, b)| (0..3).any(|i| a.0[i].abs_diff(b.0[i]) > 1));
    assert!(!differs, "the modes differ");
    let video = ["--start", "1.9", "--duration", "0.2", "--fps", "10", "-o", "out/"];
    run(&[&["video", "song.wav", "parts.scene"], &video[..]].concat());
    assert_eq!(colour(&place, "out/frame-00001.png"), [red, green, blue]);
    // Without stems, the parts are silent and the scene still runs; inputs can be held.
    place.write_tone("alone.wav", 440.0, 4.0, [0.5; 2]);
    run(&["still", "alone.wav", "parts.scene", "--at", "2", "-o", "alone.png"]);
    assert_eq!(colour(&place, "alone.png"), [red, 0, 0]);
    let held = ["--set", "vocals.volume.y=1", "--set", "drums.volume.x=1"];
    run(&[&["still", "alone.wav", "parts.scene", "--at", "2", "-o", "held.png"], &held[..]].concat());
    let [red, green, blue] = colour(&place, "held.png");
    assert!(red > 250 && green > 250 && blue == 0, "{red} {green} {blue}");
}

#[test]
fn the_tracks_of_a_stem_file_are_its_parts() {
    let place = Workplace::new();
    // The mix, drums, bass, other, vocals: one part sounds at a time.
    let tracks = ["volume=4", "volume=0", "volume=2", "volume=0", "volume=8"];
    let mut arguments: Vec<String> = Vec::new();
    for volume in tracks {
        arguments.extend(["-f", "lavfi", "-i"].map(str::to_owned));
        arguments.push(format!("sine=f=440:d=3:r=48000,{volume},aformat=channel_layouts=stereo"));
    }
    (0..tracks.len()).for_each(|track| arguments.extend(["-map".to_owned(), track.to_string()]));
    arguments.extend(["-c:a", "alac", "-f", "mp4"].map(str::to_owned));
    place.ffmpeg(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), "set.stem.mp4");
    write_wall(
        &place,
        "parts.scene",
        "vec3(drums.volume.x + other.volume.x, bass.volume.x, vocals.volume.x)",
    );
    let still = ["still", "set.stem.mp4", "parts.scene", "--at", "1.5", "-o", "a.png"];
    place.run(&[&still[..], &LOOK[..]].concat()).done();
    let [red, green, blue] = colour(&place, "a.png");
    assert!(red == 0 && green > 60 && blue > green + 30, "{red} {green} {blue}");
    // A file with too few tracks.
    place.ffmpeg(
        &["-i", place.path("set.stem.mp4").to_str().unwrap(), "-map", "0:0", "-c", "copy", "-f", "mp4"],
        "mix.stem.mp4",
    );
    let outcome = place.run(&[&["still", "mix.stem.mp4"], &still[2..], &LOOK[..]].concat());
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let reported = outcome.stderr;
    assert!(
        reported.contains("the part drums stays silent: mix.stem.mp4 has no audio track 2"),
        "{reported}"
    );
    assert_eq!(colour(&place, "a.png"), [0; 3]);
}

#[test]
fn each_broken_stem_is_reported_and_the_others_are_used() {
    let place = Workplace::new();
    stems(&place, "separated/htdemucs/song");
    let stem = |name: &str| format!("separated/htdemucs/song/{name}");
    place.write_tone("song.wav", 440.0, 4.0, [0.5; 2]);
    place.write(&stem("drums.wav"), b"");
    place.write(&stem("bass.mp3"), b"this is no song, but it is a file with some text in it");
    place.write_tone(&stem("vocals.wav"), 440.0, 6.0, [0.5; 2]);
    place.write_tone(&stem("other.wav"), 440.0, 1.5, [0.5; 2]);
    write_wall(&place, "parts.scene", "vec3(drums.beat + bass.volume.x, vocals.volume.x, other.volume.x)");
    let still = |at: &str| {
        let still = ["still", "song.wav", "parts.scene", "--at", at, "-o", "a.png"];
        let outcome = place.run(&[&still[..], &LOOK[..]].concat());
        assert_eq!(outcome.code, 0, "{outcome:?}");
        (colour(&place, "a.png"), outcome.stderr)
    };
    let ([red, green, blue], reported) = still("1");
    assert!(red == 0 && green > 100 && blue == green, "{red} {green} {blue}");
    for part in [
        "the part drums stays silent: drums.wav is empty",
        "the part bass stays silent: bass.mp3 ",
        "vocals.wav lasts 6.0 s, but its song lasts 4.0 s",
        "other.wav lasts 1.5 s, but its song lasts 4.0 s",
    ] {
        assert_eq!(reported.matches(part).count(), 1, "{part} in {reported}");
    }
    let ([_, green, blue], _) = still("3");
    assert!(green > 100 && blue == 0, "{green} {blue}");
    // A scene that reads no part opens no stem.
    write_wall(&place, "parts.scene", "vec3(volume, 0)");
    let (_, reported) = still("1");
    assert!(!reported.contains("stays silent"), "{reported}");
    // A folder with other names.
    stems(&place, "own.stems");
    place.write_tone("own.wav", 440.0, 2.0, [0.5; 2]);
    place.write_tone("own.stems/mix.wav", 440.0, 2.0, [0.5; 2]);
    write_wall(&place, "parts.scene", "vec3(drums.beat)");
    let outcome = place.run(&[&["still", "own.wav", "parts.scene", "-o", "a.png"], &LOOK[..]].concat());
    assert!(outcome.stderr.contains("own.stems has no stems"), "{}", outcome.stderr);
}

#[test]
fn parts_have_names_in_every_command_that_reads_scenes() {
    let place = Workplace::new();
    place.write("parts.scene", "length(p) - drums.volume.x - 2 * bass.band(3) - vocals.band(x)\n");
    let check = place.run(&["check", "parts.scene"]).done();
    assert!(check.contains("bass.band(3)") && check.contains("drums.volume.x"), "{check}");
    assert!(check.contains("bands of parts"), "{check}");
    let held = ["--set", "drums.volume.x=0.25", "--set", "bass.band(3)=0.5"];
    let value = place.run(&[&["eval", "parts.scene", "--at", "0,0,3"], &held[..]].concat()).done();
    assert_eq!(value.trim(), "1.75");
    place
        .run(&["eval", "parts.scene", "--at", "0,0,3", "--set", "drums.foo=1"])
        .refused(&["drums.foo", "(drums, bass, vocals, other), such as drums.beat"]);
    assert!(place.run(&["tape", "parts.scene"]).done().contains("PART"));
}
