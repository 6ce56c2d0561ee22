//! The subcommand `video`: presets for websites, several scenes, tags and covers, codecs and transparency.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::process::{Command, Stdio};

use crate::support::program::{Outcome, Workplace};
use image::{Rgb, RgbImage, RgbaImage};
use mariana_testing::process::output_of;
use serde_json::Value;

/// These scenes compile quickly.
fn write_colors(place: &Workplace) {
    for (name, color) in [("red", "vec3(0.8, 0, 0)"), ("blue", "vec3(0, 0, 0.8)")] {
        let text = format!(
            "param light = 1 in 0 .. 2\n\
             material paint {{ color = 0  roughness = 1  emission = light * {color} }}\n\
             object wall {{ shape = 5 - p.z  material = paint }}\nsky {{ color = 0  ambient = 0 }}\n\
             light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
             camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n"
        );
        place.write(&format!("{name}.scene"), text);
    }
}

fn probe(place: &Workplace, name: &str) -> Value {
    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-of", "json", "-show_streams", "-show_format", "-count_frames"]);
    let output = output_of(probe.arg(place.path(name)), "ffmpeg").unwrap_or_else(|error| panic!("{error}"));
    serde_json::from_slice(&output).unwrap()
}

fn streams<'a>(report: &'a Value, kind: &str) -> Vec<&'a Value> {
    let all = report["streams"].as_array().unwrap();
    all.iter().filter(|stream| stream["codec_type"] == kind).collect()
}

fn still(place: &Workplace, name: &str) -> RgbImage {
    image::load_from_memory(&place.read(name)).unwrap().to_rgb8()
}

fn redness(picture: &RgbImage) -> i32 {
    let [red, _, blue] = picture.get_pixel(picture.width() / 2, picture.height() / 2).0;
    i32::from(red) - i32::from(blue)
}

const LOOK: [&str; 6] = ["--fps", "10", "--size", "32x18", "--tone-map", "none"];

#[test]
fn scenes_follow_each_other_at_their_times() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    write_colors(&place);
    let video =
        |to: &str, scenes: &[&str]| place.run(&[&["video", "one.wav", "-o", to], &LOOK[..], scenes].concat());
    video("out/", &["--scene", "blue.scene@0:00.4", "--scene", "red.scene"]).done();
    let run = |scenes: &[&str]| video("refused/", scenes);
    let redness: Vec<bool> =
        (0..10).map(|frame| redness(&still(&place, &format!("out/frame-{frame:05}.png"))) > 0).collect();
    assert_eq!(redness, [[true; 4].as_slice(), &[false; 6]].concat());
    run(&["--scene", "red.scene@0.5"]).refused(&["0.5 s", "earlier time"]);
    run(&["--scene", "red.scene", "--scene", "blue.scene"]).refused(&["red.scene", "blue.scene", "@1:20"]);
    run(&["--scene", "red.scene", "--scene", "none.scene@0.5"]).refused(&["none.scene"]);
}

#[test]
fn a_draft_differs_from_the_video_only_at_edges() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let frame = |folder: &str, draft: &[&str]| {
        let part =
            ["--size", "96x54", "--duration", "0.1", "--fps", "10", "--scene", "first_steps", "-o", folder];
        place.run(&[&["video", "one.wav"], &part[..], draft].concat()).done();
        still(&place, &format!("{folder}frame-00000.png"))
    };
    let (video, draft) = (frame("video/", &[]), frame("draft/", &["--draft"]));
    // Bloom spreads the differences at edges over the frame, by less than a few steps.
    let far = |one: &Rgb<u8>, other: &Rgb<u8>| (0..3).any(|i| one[i].abs_diff(other[i]) > 4);
    let is_at_edge = |(x, y): (u32, u32)| {
        let beside =
            (x.saturating_sub(1)..=x + 1).flat_map(|x| (y.saturating_sub(1)..=y + 1).map(move |y| (x, y)));
        let beside = beside.filter_map(|(x, y)| draft.get_pixel_checked(x, y));
        beside.into_iter().any(|other| far(draft.get_pixel(x, y), other))
    };
    let differ = video.enumerate_pixels().filter(|(x, y, pixel)| far(pixel, draft.get_pixel(*x, *y)));
    let (at_edges, elsewhere): (Vec<_>, Vec<_>) = differ.partition(|(x, y, _)| is_at_edge((*x, *y)));
    assert!(at_edges.len() > 96 * 54 / 100, "the draft has the video's edges");
    assert!(elsewhere.len() < 96 * 54 / 500, "{} pixels differ that are not at edges", elsewhere.len());
}

#[test]
fn inputs_can_be_set_in_stills_and_videos() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    write_colors(&place);
    let look = ["--size", "32x18", "--tone-map", "none"];
    let light = |set: &[&str]| {
        place.run(&[&["still", "one.wav", "red.scene", "-o", "a.png"], &look[..], set].concat()).done();
        redness(&still(&place, "a.png"))
    };
    assert!(light(&[]) > light(&["--set", "light=0.3"]) + 50);
    let scenes = ["--scene", "blue.scene", "--scene", "red.scene@0.1", "--duration", "0.2"];
    let set = ["--set", "light=0.3", "-o", "out/"];
    place.run(&[&["video", "one.wav"], &LOOK[..], &scenes, &set].concat()).done();
    assert_eq!(redness(&still(&place, "out/frame-00001.png")), light(&["--set", "light=0.3"]));
    for (set, part) in [("light=9", "0 to 2"), ("lihgt=1", "one of light, t"), ("band(1)=-1", "0 to 1")] {
        place
            .run(&[&["still", "red.scene", "-o", "b.png", "--set", set], &look[..]].concat())
            .refused(&["--set", part]);
    }
    place.run(&["still", "-o", "b.png", "--set", "light"]).refused_arguments("--set", &["NAME=VALUE"]);
}

#[test]
fn a_video_has_the_songs_tags_and_cover() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    place.ffmpeg(&["-f", "lavfi", "-i", "color=red:s=16x16", "-frames:v", "1"], "cover.jpg");
    let tags = ["-metadata", "title=Ein Lied; a=b", "-metadata", "artist=Jemand"];
    let cover =
        ["-i", "cover.jpg", "-map", "0:a", "-map", "1:v", "-c:v", "copy", "-disposition:v", "attached_pic"];
    for song in ["song.flac", "song.mp3", "song.ogg"] {
        let picture = if song.ends_with("ogg") { &cover[..0] } else { &cover };
        place.ffmpeg(&[&["-i", "one.wav"], picture, &tags].concat(), song);
        for video in ["v.mp4", "v.mkv"] {
            let part = ["--start", "0.4", "--duration", "0.5", "-o", video];
            place.run(&[&["video", song, "red.scene"], &part[..], &LOOK].concat()).done();
            let report = probe(&place, video);
            let tag = |name: &str| {
                let tags = report["format"]["tags"].as_object().unwrap();
                let found = tags.iter().find(|(key, _)| key.eq_ignore_ascii_case(name));
                found.map(|(_, value)| value.as_str().unwrap().to_owned())
            };
            assert_eq!(tag("title").as_deref(), Some("Ein Lied; a=b"), "{song}: {report}");
            assert_eq!(tag("artist").as_deref(), Some("Jemand"), "{song}: {report}");
            let pictures = streams(&report, "video");
            assert_eq!(pictures[0]["nb_read_frames"], "5", "{song}: {report}");
            let covers: Vec<&&Value> =
                pictures.iter().filter(|stream| stream["disposition"]["attached_pic"] == 1).collect();
            assert_eq!(covers.len(), usize::from(!picture.is_empty()), "{song} in {video}: {report}");
            assert_eq!(streams(&report, "audio").len(), 1);
        }
    }
    // The video omits a cover that is damaged or has too many pixels.
    place.ffmpeg(&["-f", "lavfi", "-i", "color=red:s=4100x16", "-frames:v", "1"], "wide.jpg");
    let wide: Vec<&str> =
        cover.iter().map(|word| if *word == "cover.jpg" { "wide.jpg" } else { word }).collect();
    place.ffmpeg(&[&["-i", "one.wav"], &wide[..]].concat(), "wide.flac");
    let part = ["--duration", "0.5", "-o", "wide.mp4"];
    place.run(&[&["video", "wide.flac", "red.scene"], &part[..], &LOOK].concat()).done();
    assert_eq!(streams(&probe(&place, "wide.mp4"), "video").len(), 1);
    let mut song = place.read("song.flac");
    let cover = place.read("cover.jpg");
    let at = song.windows(cover.len()).position(|bytes| bytes == cover).unwrap();
    song[at + 3..at + cover.len()].fill(0x55);
    place.write("song.flac", song);
    let part = ["--duration", "0.5", "-o", "v.mp4"];
    place.run(&[&["video", "song.flac", "red.scene"], &part[..], &LOOK].concat()).done();
    assert_eq!(streams(&probe(&place, "v.mp4"), "video").len(), 1);
}

/// Writes a file that consists of an ID3 tag, an HLS playlist that names `other`, and an MP3 stream. ffmpeg's default
/// is to read such a file as a playlist.
fn write_polyglot(place: &Workplace, song: &str, other: &str) {
    let tag = [b"ID3\x03\0\0\0\0\0\x0a".as_slice(), &[0; 10]].concat();
    let other = place.path(other);
    let list = format!(
        "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nfile://{}\n#EXT-X-ENDLIST\n",
        other.display()
    );
    let bare = ["-id3v2_version", "0", "-write_xing", "0"];
    place.ffmpeg(&[&["-f", "lavfi", "-i", "sine=f=200:d=2", "-b:a", "64k"], &bare[..]].concat(), "own.mp3");
    place.write(song, [&tag, list.as_bytes(), &place.read("own.mp3")].concat());
}

#[test]
fn a_song_that_is_also_a_playlist_keeps_its_own_sound() {
    let place = Workplace::new();
    write_colors(&place);
    place.ffmpeg(&["-f", "lavfi", "-i", "sine=f=1000:d=2", "-b:a", "64k"], "secret.mp3");
    write_polyglot(&place, "song.mp3", "secret.mp3");
    let probed = Command::new("ffprobe")
        .args(["-v", "error", "-show_entries", "format=format_name"])
        .arg(place.path("song.mp3"))
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&probed.stdout).contains("=hls"), "ffmpeg sees no playlist: {probed:?}");
    let video = ["video", "song.mp3", "red.scene", "--duration", "1", "-o", "v.mkv"];
    place.run(&[&video[..], &LOOK].concat()).done();
    place.ffmpeg(&["-i", "v.mkv", "-ac", "1", "-f", "s16le"], "sound.raw");
    let samples: Vec<i16> =
        place.read("sound.raw").as_chunks::<2>().0.iter().map(|pair| i16::from_le_bytes(*pair)).collect();
    let rises = samples.windows(2).filter(|pair| pair[0] < 0 && pair[1] >= 0).count();
    let report = probe(&place, "v.mkv");
    let rate: usize = streams(&report, "audio")[0]["sample_rate"].as_str().unwrap().parse().unwrap();
    let pitch = rises * rate / samples.len();
    assert!((170..260).contains(&pitch), "the song's tone has 200 Hz, the video's {pitch} Hz");
}

#[test]
fn presets_set_the_size_and_a_loop_ends_where_it_begins() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 3.0, [0.5, 0.5]);
    let run = |arguments: &[&str]| place.run(&[&["video", "one.wav"], arguments].concat());
    for (name, size, rate) in
        [("youtube", (1920, 1080), "60/1"), ("story", (1080, 1920), "30/1"), ("square", (1080, 1080), "30/1")]
    {
        run(&["red.scene", "--for", name, "--duration", "0.05", "-qo", "v.mp4"]).done();
        let report = probe(&place, "v.mp4");
        let picture = streams(&report, "video")[0];
        assert_eq!((&picture["width"], &picture["height"]), (&size.0.into(), &size.1.into()), "{name}");
        assert_eq!(picture["r_frame_rate"], rate, "{name}");
        assert_eq!(streams(&report, "audio")[0]["sample_rate"], "48000", "{name}");
    }
    place.run(&["still", "one.wav", "red.scene", "--for", "tiktok", "-o", "s.png"]).done();
    assert_eq!(still(&place, "s.png").dimensions(), (1080, 1920));
    // The brightness grows linearly with time.
    place.write(
        "moving.scene",
        "material paint { color = 0  roughness = 1  emission = vec3(0.3 * t, 0, 0) }\n\
         object wall { shape = 5 - p.z  material = paint }\nsky { color = 0  ambient = 0 }\n\
         light none { direction = vec3(0, -1, 0)  color = 0 }\n\
         camera { position = vec3(0)  target = vec3(0, 0, 5) }\n",
    );
    let a_loop = ["moving.scene", "--for", "loop", "--flash-limiter", "off", "--duration"];
    run(&[&a_loop[..], &["2", "-o", "v.mp4"], &LOOK].concat()).done();
    let report = probe(&place, "v.mp4");
    assert_eq!(streams(&report, "video")[0]["nb_read_frames"], "20");
    assert!(streams(&report, "audio").is_empty(), "{report}");
    run(&[&a_loop[..], &["2", "-o", "out/"], &LOOK].concat()).done();
    let light: Vec<i32> =
        (0..20).map(|frame| redness(&still(&place, &format!("out/frame-{frame:05}.png")))).collect();
    let greatest = light.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().unwrap();
    assert!(light[9] > light[0] + 20, "the brightness does not change: {light:?}");
    assert!(light[19].abs_diff(light[0]) <= greatest, "the loop jumps at its end: {light:?}");
    run(&[&a_loop[..], &["2.5", "-o", "v.mp4"], &LOOK].concat())
        .refused(&["2.5 s", "3.50 s", "3.00 s", "--start"]);
}

#[test]
fn the_requested_codec_and_rate_are_used() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let run = |codec: &str, output: &str| {
        let codec = ["--codec", codec, "--size", "64x64", "--fps", "10", "-o", output];
        place.run(&[&["video", "one.wav", "red.scene", "--quality", "low"], &codec[..]].concat())
    };
    for (codec, output, reported) in [
        ("h264", "a.mp4", "h264"),
        ("h265", "a.mp4", "hevc"),
        ("vp9", "a.webm", "vp9"),
        ("av1", "a.mkv", "av1"),
    ] {
        run(codec, output).done();
        assert_eq!(streams(&probe(&place, output), "video")[0]["codec_name"], reported);
    }
    let film = ["--fps", "23.976", "--size", "64x64", "--duration", "0.2", "-o", "f.mp4"];
    place.run(&[&["video", "one.wav", "red.scene"], &film[..]].concat()).done();
    assert_eq!(streams(&probe(&place, "f.mp4"), "video")[0]["r_frame_rate"], "24000/1001");
    run("h264", "b.webm").refused(&["b.webm", "h264", "vp9 and av1"]);
    run("h264x", "b.mp4").refused_arguments("--codec", &["h264x"]);
}

#[test]
fn gifs_and_webps_are_written_and_checked() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let run = |arguments: &[&str]| {
        let scenes = ["video", "one.wav", "--scene", "blue.scene@0.5", "--scene", "red.scene"];
        place.run(&[&scenes[..], &["--tone-map", "none", "--size", "33x17"], arguments].concat())
    };
    run(&["--fps", "10", "-o", "a.gif"]).done();
    let bytes = place.read("a.gif");
    let repeats = bytes.windows(16).any(|part| part == b"NETSCAPE2.0\x03\x01\0\0\0");
    assert!(repeats, "the GIF does not repeat");
    let report = probe(&place, "a.gif");
    assert_eq!(streams(&report, "video")[0]["nb_read_frames"], "10", "{report}");
    place.ffmpeg(&["-i", "a.gif", "-start_number", "0"], "gif-%d.png");
    let gif: Vec<i32> =
        [0, 4, 5, 9].map(|frame| redness(&still(&place, &format!("gif-{frame}.png")))).to_vec();

    run(&["--fps", "10", "-o", "a.webp"]).done();
    let bytes = place.read("a.webp");
    let at = bytes.windows(4).position(|name| name == b"ANIM").unwrap();
    assert_eq!(bytes[at + 12..at + 14], [0, 0], "the WebP does not repeat endlessly");
    let decoder = image::codecs::webp::WebPDecoder::new(std::io::Cursor::new(&bytes)).unwrap();
    let frames = image::AnimationDecoder::into_frames(decoder).collect_frames().unwrap();
    let pictures: Vec<i32> = frames
        .iter()
        .map(|frame| redness(&image::DynamicImage::from(frame.buffer().clone()).to_rgb8()))
        .collect();
    for redness in [&gif[..], &[pictures[0], pictures[pictures.len() - 1]]] {
        assert!(redness[0] > 100 && redness[redness.len() - 1] < -100, "{redness:?}");
    }
    assert!(gif[1] > 100 && gif[2] < -100, "{gif:?}");

    run(&["--fps", "60", "-o", "b.gif"]).refused(&["b.gif", "50 frames a second", "--fps 50"]);
    run(&["--codec", "h264", "-o", "b.webp"]).refused(&["b.webp", "leave out --codec"]);
    write_ball(&place, "ball", 0.0, "");
    let ball = ["video", "one.wav", "ball.scene", "--alpha", "--fps", "10", "--size", "64x36", "--duration"];
    place.run(&[&ball[..], &["0.2", "-o", "ball.webp"]].concat()).done();
    let first = image::load_from_memory(&place.read("ball.webp")).unwrap().to_rgba8();
    assert!(first.get_pixel(2, 2)[3] < 4 && first.get_pixel(32, 18)[3] > 251);
    place.run(&[&ball[..], &["0.2", "-o", "ball.gif"]].concat()).refused(&["ball.gif", ".webp"]);
}

#[test]
fn images_go_to_standard_output_without_messages() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let look = ["--size", "33x17", "--tone-map", "none", "red.scene", "-o", "-"];
    let output = |job: &[&str]| {
        let output = place.command(&[job, &look[..]].concat()).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{job:?}: {output:?}");
        output.stdout
    };
    let png = image::load_from_memory(&output(&["still", "one.wav"])).unwrap().to_rgb8();
    assert_eq!(png.dimensions(), (33, 17));
    let stream = output(&["video", "one.wav", "--fps", "10", "--duration", "0.3"]);
    let header = b"YUV4MPEG2 W33 H17 F10:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    assert!(stream.starts_with(header));
    assert_eq!(stream.len(), header.len() + 3 * ("FRAME\n".len() + 3 * 33 * 17));
    // In BT.709, red has a blue difference (plane 1) below the middle and a red difference (plane 2) above the middle.
    let plane = |index: usize| stream[header.len() + "FRAME\n".len() + index * 33 * 17 + 300];
    assert!(plane(1) < 120 && plane(2) > 170, "{} {}", plane(1), plane(2));
}

#[test]
fn a_title_is_shown_only_on_request() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("A song of tones.wav", 440.0, 2.0, [0.5, 0.5]);
    let frame = |out: &str, card: &[&str]| {
        let look = ["--size", "320x180", "--fps", "1", "-o", out];
        place.run(&[&["video", "A song of tones.wav", "red.scene"], &look[..], card].concat()).done();
        still(&place, &format!("{out}frame-00001.png"))
    };
    let (with, without) = (frame("with/", &["--title-card"]), frame("without/", &[]));
    let differ = |rows: std::ops::Range<u32>| {
        rows.flat_map(|y| (0..320).map(move |x| (x, y)))
            .filter(|&(x, y)| with.get_pixel(x, y) != without.get_pixel(x, y))
            .count()
    };
    assert_eq!(differ(0..120), 0);
    assert!(differ(120..180) > 150, "{} pixels", differ(120..180));
}

#[test]
fn a_title_card_hid_the_lyrics_of_a_short_video() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("Sea song.wav", 440.0, 2.0, [0.5, 0.5]);
    place.write("Sea song.lrc", "[00:00.50]Somewhere in the sea\n[00:01.70]");
    let frames = |flags: &[&str], out: &str| {
        let part = ["--fps", "2", "--size", "320x180", "-o", out];
        place.run(&[&["video", "Sea song.wav", "red.scene"], &part[..], flags].concat()).done();
        [2, 3].map(|number| still(&place, &format!("{out}frame-{number:05}.png")))
    };
    let plain = frames(&[], "plain/");
    let lyrics = frames(&["--lyrics"], "lyrics/");
    let both = frames(&["--lyrics", "--title-card"], "both/");
    let mut letters = [0, 0];
    for ((both, lyrics), plain) in both[0].pixels().zip(lyrics[0].pixels()).zip(plain[0].pixels()) {
        let is_lyric = lyrics != plain;
        assert!(!is_lyric || both == lyrics, "the card covers the lyrics");
        letters[0] += usize::from(is_lyric);
        letters[1] += usize::from(!is_lyric && both != plain);
    }
    assert!(letters.iter().all(|count| *count > 150), "{letters:?} pixels of lyrics and of the card");
    assert!(both[1] == lyrics[1], "the card of a video of 2 s is over at 1.5 s");
}

#[test]
fn lyrics_are_shown_while_they_are_sung() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 2.0, [0.5, 0.5]);
    place.write("one.lrc", "[00:00.50]Somewhere in the sea\n[00:01.50]");
    place.write("bad.lrc", "Somewhere in the sea");
    let frames = |flags: &[&str], out: &str| {
        let part = ["--fps", "2", "--size", "320x180", "-o", out];
        place.run(&[&["video", "one.wav", "red.scene"], &part[..], flags].concat()).done();
        [0, 2, 3].map(|number| still(&place, &format!("{out}frame-{number:05}.png")))
    };
    let (with, without) = (frames(&["--lyrics"], "with/"), frames(&[], "without/"));
    let same = std::array::from_fn::<_, 3, _>(|at| with[at] == without[at]);
    assert_eq!(same, [true, false, true], "the line is sung from 0.5 to 1.5 s");
    let refused = |flag: &str, part: &str| {
        place.run(&["video", "one.wav", "red.scene", "-o", "x/", flag]).refused(&[part]);
    };
    refused("--lyrics=bad.lrc", "have no line with a time");
    refused("--lyrics=none.lrc", "cannot read the lyrics none.lrc");
    std::fs::remove_file(place.path("one.lrc")).unwrap();
    refused("--lyrics", "one.wav has no lyrics with times");
}

#[test]
fn quiet_hides_the_progress() {
    let place = Workplace::new();
    write_colors(&place);
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let video = [&["video", "one.wav", "red.scene", "-o", "v.mkv"], &LOOK[..]].concat();
    assert!(place.run(&video).done().contains("10 frames in v.mkv"));
    assert_eq!(place.run(&[&video[..], &["--quiet"]].concat()).done(), "");
    // Progress bars appear only on a terminal.
    let command = place.command(&video);
    let words: Vec<String> = std::iter::once(command.get_program())
        .chain(command.get_args())
        .map(|word| format!("'{}'", word.to_string_lossy()))
        .collect();
    let mut terminal = Command::new("script");
    terminal.args(["-qec", &words.join(" "), "/dev/null"]).current_dir(command.get_current_dir().unwrap());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => terminal.env(name, value),
            None => terminal.env_remove(name),
        };
    }
    terminal.env("TERM", "xterm");
    let shown = String::from_utf8(output_of(&mut terminal, "bsdutils").unwrap()).unwrap();
    assert!(shown.contains("100 %  frame 10 of 10") && shown.contains("0:00 left"), "{shown}");
}

fn write_ball(place: &Workplace, name: &str, bloom: f64, sky: &str) {
    let text = format!(
        "material paint {{ color = 0  roughness = 1  emission = vec3(3, 0.6, 0.1) }}\n\
         object ball {{ shape = sphere(p, 1)  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0, 0, -4)  target = vec3(0) }}\n\
         picture {{ bloom = {bloom}  grain = 0 }}\n{sky}\n"
    );
    place.write(&format!("{name}.scene"), text);
}

/// Returns the numbers of transparent, translucent and opaque pixels. Fails unless the image, composited on black,
/// equals `opaque`.
fn fractions_of(picture: &RgbaImage, opaque: &RgbImage) -> [usize; 3] {
    let mut fractions = [0; 3];
    for (pixel, wanted) in picture.pixels().zip(opaque.pixels()) {
        let alpha = pixel[3];
        fractions[usize::from(alpha > 0) + usize::from(alpha == 255)] += 1;
        for channel in 0..3 {
            let over_black = f64::from(pixel[channel]) * f64::from(alpha) / 255.0;
            let off = (over_black - f64::from(wanted[channel])).abs();
            assert!(off <= 1.5, "{pixel:?} should be {wanted:?} on black");
        }
    }
    fractions
}

#[test]
fn scenes_without_a_sky_are_transparent() {
    let place = Workplace::new();
    let look = ["--size", "64x36"];
    let draw = |bloom: f64| {
        write_ball(&place, "ball", bloom, "sky { ambient = 0 }");
        write_ball(&place, "black", bloom, "sky { color = 0  ambient = 0 }");
        place.run(&[&["still", "black.scene", "-o", "black.png"], &look[..]].concat()).done();
        for file in ["ball.png", "ball.webp"] {
            place.run(&[&["still", "ball.scene", "--alpha", "-o", file], &look[..]].concat()).done();
        }
        let [png, webp] =
            ["ball.png", "ball.webp"].map(|file| image::load_from_memory(&place.read(file)).unwrap());
        assert_eq!(png, webp);
        assert_eq!(png.as_rgba8().unwrap().get_pixel(32, 18)[3], 255);
        fractions_of(png.as_rgba8().unwrap(), &still(&place, "black.png"))
    };
    let [outside, edge, inside] = draw(0.0);
    assert!(outside > 1200 && (20..120).contains(&edge) && inside > 300, "{outside} {edge} {inside}");
    let [left, glow, same] = draw(0.3);
    assert!(glow > edge + 100 && left < outside && same > 300, "{left} {glow} {same}");
}

#[test]
fn videos_can_be_transparent() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    write_ball(&place, "ball", 0.0, "");
    write_ball(&place, "black", 0.0, "sky { color = 0 }");
    let run = |scene: &str, output: &str| {
        let part = ["--fps", "10", "--size", "64x36", "--duration", "0.2", "--title-card"];
        place.run(&[&["video", "one.wav", scene, "--alpha", "-o", output], &part[..]].concat())
    };
    for (video, format, decoder) in [
        ("v.webm", "yuv420p", &["-c:v", "libvpx-vp9"][..]),
        ("v.mov", "yuva444p1", &[]),
        ("v.mkv", "yuva444p10le", &[]),
    ] {
        run("ball.scene", video).done();
        let report = probe(&place, video);
        let picture = streams(&report, "video")[0];
        // VP9 stores alpha in a second stream, which a tag announces.
        assert!(picture["pix_fmt"].as_str().unwrap().starts_with(format), "{report}");
        let tagged = picture["tags"].as_object().unwrap().iter();
        let tagged = tagged.filter(|(name, _)| name.eq_ignore_ascii_case("alpha_mode")).count();
        assert_eq!(tagged, usize::from(video == "v.webm"), "{report}");
        assert_eq!(streams(&report, "audio").len(), 1, "{video}");
        let first = ["-frames:v", "1", "-update", "1", "-pix_fmt", "rgba"];
        place.ffmpeg(&[decoder, &["-i", video], &first].concat(), "first.png");
        let first = image::load_from_memory(&place.read("first.png")).unwrap();
        let alpha = |x, y| first.as_rgba8().unwrap().get_pixel(x, y)[3];
        assert!(alpha(2, 2) < 4 && alpha(32, 18) > 251, "{video}: {} {}", alpha(2, 2), alpha(32, 18));
    }
    run("ball.scene", "out/").done();
    let frame = image::load_from_memory(&place.read("out/frame-00001.png")).unwrap();
    assert_eq!(frame.as_rgba8().unwrap().get_pixel(2, 2)[3], 0);

    run("black.scene", "v.mov").refused(&["black", "`color`", "`sky`"]);
    run("ball.scene", "v.mp4").refused(&["v.mp4", ".webm"]);
    run("ball.scene", "-").refused(&["standard output", ".webm"]);
    place.run(&["still", "ball.scene", "--alpha", "-o", "a.jpg"]).refused(&["a.jpg", ".webp"]);
}

#[test]
fn a_controlled_video_reports_lines_replaces_no_file_and_ends_with_its_input() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    write_colors(&place);
    place.write("v.mp4", "another video");
    let part = ["video", "one.wav", "red.scene", "--controlled", "-o", "v.mp4", "--duration", "0.5"];
    let arguments = [&part[..], &LOOK].concat();
    let printed = Outcome::of(place.command(&arguments).stdin(Stdio::piped())).done();
    let lines: Vec<Value> = printed.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 6, "{printed}");
    assert_eq!(lines[4], serde_json::json!({ "drawn": { "done": 5, "of": 5 } }));
    assert_eq!(lines[5], serde_json::json!({ "written": { "name": "v 2.mp4" } }));
    assert_eq!(place.read("v.mp4"), b"another video");
    let names = place.names();
    let ended = place.run(&arguments);
    assert!(ended.code == 129 && ended.stderr.contains("the window has ended this work"), "{ended:?}");
    assert_eq!(place.names(), names);
}

#[test]
fn a_thumbnail_outlived_the_window_that_asked_for_it() {
    let place = Workplace::new();
    write_colors(&place);
    let names = place.names();
    let ended = place.run(&["still", "--controlled", "--scene=red.scene", "-o", "picture.png"]);
    assert!(ended.code == 129 && ended.stderr.contains("the window has ended this work"), "{ended:?}");
    assert_eq!(place.names(), names);
}

#[test]
fn outputs_and_flags_that_no_video_has_were_accepted_or_misread() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    let video = |output: &str, flags: &[&str]| {
        let look = ["--scene", "length(p) - 1", "--fps", "3", "--size", "16x10"];
        place.run(&[&["video", "one.wav", "-o", output], &look[..], flags].concat())
    };
    // The song would become its own output, with a frame as cover.
    video("a.mp3", &[]).refused(&["a.mp3", "cannot hold a video", ".mp4"]);
    assert!(video("out/", &["--duration", "0.2"]).done().contains("1 frame in out/"));
    std::fs::rename(place.path("out/frame-00000.png"), place.path("out/frame-00099.png")).unwrap();
    // An old frame stayed in the sequence.
    video("out/", &[]).refused(&["out/ has frames already", "frame-00099.png"]);
    video("out/", &["--part", "1/1", "--flash-limiter", "off"]).done();
    video("a.mp4", &["--for", "loop", "--start", "0.9", "--duration", "1"])
        .refused(&["only 0.10 s are left"]);
    place.run(&["video", "--scene", "orb@abc", "-o", "a.mp4"]).refused(&["orb@abc", "'abc' is no time"]);
    place.run(&["still", "-o", "out/"]).refused(&["out/ is a folder", "one file"]);
    place.run(&["still", "-o", "a.png", "--set", "volume=0.3"]).refused(&["volume.x or volume.y"]);
    place.write("large.ogg", [&b"OggS"[..], &vec![0xff; 2 << 20]].concat());
    place.run(&["check", "large.ogg"]).refused(&["large.ogg", "is not text"]);
}
