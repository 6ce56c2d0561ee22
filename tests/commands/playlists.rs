//! Playing playlists: features, loudness, and files that are damaged or change during playback.

#![cfg(unix)]
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::support::program::{FORMATS, Workplace};
use mariana::export::song_features::SongFeatures;
use mariana_music::Gain;
use mariana_player::decode::Decoder;
use mariana_player::playlist::Playlist;
use mariana_player::song::Song;
use mariana_player::track::Repeat;
use mariana_player::{Player, PlayerOptions};
use mariana_testing::process::wait_until;

fn play(paths: &[PathBuf], repeat: Repeat) -> Player {
    let opened = Playlist::open(paths, repeat, false).unwrap();
    let options = PlayerOptions { repeat, output: None, ..PlayerOptions::default() };
    Player::start(opened.first, Box::new(opened.list), options).unwrap()
}

fn write_songs(place: &Workplace, seconds: f64) -> Vec<PathBuf> {
    let source = format!("sine=frequency=300:sample_rate=44100:duration={seconds}");
    let write = |format: &crate::support::program::Format| {
        let arguments = [&["-f", "lavfi", "-i", &source, "-ac", "2"], format.arguments].concat();
        place.ffmpeg(&arguments, format.file);
        place.path(format.file)
    };
    FORMATS.iter().map(write).collect()
}

#[test]
fn every_tracks_features_equal_its_file_alone_bit_for_bit() {
    let place = Workplace::new();
    // Long enough for many comparisons on a busy machine.
    place.write_tone("1.wav", 440.0, 2.1, [0.6, 0.2]);
    place.write_tone("2.wav", 97.0, 2.7, [0.1, 0.5]);
    let louder =
        ["-i", &*place.path("1.wav").to_string_lossy(), "-ar", "44100", "-metadata"].map(str::to_owned);
    let louder = [&louder[..], &["REPLAYGAIN_TRACK_GAIN=-9.5 dB".to_owned()]].concat();
    place.ffmpeg(&louder.iter().map(String::as_str).collect::<Vec<_>>(), "3.flac");
    let files = ["1.wav", "2.wav", "3.flac"].map(|name| place.path(name));
    let mut alone = files.clone().map(|file| SongFeatures::open(&Song::File(file), 0.0).unwrap());
    let mut player = play(&files, Repeat::Off);
    let mut compared = [0; 3];
    let start = Instant::now();
    while !player.status().ended {
        assert!(start.elapsed() < Duration::from_secs(60), "the playlist does not end");
        let moment = player.now(0.0);
        let track = player.status().track.entry;
        // Another track may start between the two calls of `now`. At the start of the song, the analysis may lag behind
        // the playback.
        let begun = track > 0 || moment.song_time > 0.2;
        if begun && player.now(0.0).lap == moment.lap && moment.segment > 0 {
            let wanted = alone[track].at(moment.song_time).unwrap();
            if let Some(wanted) = wanted {
                assert_eq!(moment.features, wanted, "track {track} at {} s", moment.song_time);
                compared[track] += 1;
            }
        }
        std::thread::sleep(Duration::from_millis(3));
    }
    assert!(compared.iter().all(|count| *count > 30), "{compared:?}");
}

#[test]
fn loudness_tags_of_every_kind_are_read() {
    let place = Workplace::new();
    place.write_tone("plain.wav", 440.0, 0.5, [0.5; 2]);
    let plain = place.path("plain.wav").to_string_lossy().into_owned();
    assert_eq!(Decoder::open(&place.path("plain.wav")).unwrap().info().scene_gain, 1.0);
    for (file, tags, db) in [
        ("a.flac", &["replaygain_track_gain=-10.00 dB", "REPLAYGAIN_ALBUM_GAIN=-3 dB"][..], -6.0),
        ("b.mp3", &["REPLAYGAIN_TRACK_GAIN=-10.00 dB"], -6.0),
        ("c.ogg", &["REPLAYGAIN_ALBUM_GAIN=+2.5 dB"], 6.5),
        ("d.opus", &["R128_TRACK_GAIN=-1280"], 4.0),
        ("e.flac", &["REPLAYGAIN_TRACK_GAIN=none at all"], 0.0),
    ] {
        let tags: Vec<&str> = tags.iter().flat_map(|tag| ["-metadata", tag]).collect();
        place.ffmpeg(&[&["-i", &plain], &tags[..]].concat(), file);
        let gain = Decoder::open(&place.path(file)).unwrap().info().scene_gain;
        assert!((20.0 * gain.log10() - db).abs() < 0.01, "{file}: {} dB", 20.0 * gain.log10());
    }
    // The file's tag specifies a loudness, and the features are scaled by it.
    let volume = |name: &str| {
        let song = Song::File(place.path(name));
        let sound = SongFeatures::open_with(&song, 0.0, Gain::Off).unwrap().require(0.3).unwrap();
        sound.features.volume[0]
    };
    let ratio = volume("a.flac") / volume("plain.wav");
    assert!((20.0 * ratio.log10() + 6.0).abs() < 0.05, "{ratio}");
}

fn random(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

#[test]
fn damaged_files_of_every_format_are_skipped() {
    let place = Workplace::new();
    let good = write_songs(&place, 0.25);
    let mut state = 7;
    let mut list = Vec::new();
    for song in &good {
        let bytes = fs::read(song).unwrap();
        let name = song.file_name().unwrap().to_string_lossy();
        let mut damaged = |what: &str, bytes: &[u8]| {
            let path = place.path(&format!("{what} {name}"));
            fs::write(&path, bytes).unwrap();
            list.push(path);
        };
        damaged("cut", &bytes[..bytes.len() / 2]);
        damaged("head", &bytes[..bytes.len().min(40)]);
        damaged("empty", &[]);
        let mut flipped = bytes.clone();
        for _ in 0..40 {
            let at = random(&mut state) % flipped.len();
            flipped[at] ^= 1 << (random(&mut state) % 8);
        }
        damaged("flipped", &flipped);
        list.push(song.clone());
    }
    list.push(place.path("missing.ogg"));
    let mut player = play(&list, Repeat::Off);
    let mut heard = BTreeSet::new();
    let start = Instant::now();
    while !player.status().ended {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "the playlist does not end: {:?}",
            player.status()
        );
        heard.insert(player.status().track.entry);
        std::thread::sleep(Duration::from_millis(4));
    }
    for (index, path) in list.iter().enumerate().filter(|(_, path)| good.contains(path)) {
        assert!(heard.contains(&index), "{} was not played", path.display());
    }
    // At least the empty files and the missing file cause errors.
    assert!(player.status().track_errors.count > good.len() as u64, "{:?}", player.status().track_errors);
}

#[test]
fn the_next_track_plays_after_a_file_that_changes() {
    let place = Workplace::new();
    let songs = write_songs(&place, 30.0);
    place.write_tone("end.wav", 440.0, 30.0, [0.5; 2]);
    let end = place.path("end.wav");
    let mut state = 3;
    for (index, song) in songs.iter().enumerate() {
        let mut player = play(&[song.clone(), end.clone()], Repeat::Off);
        wait_until("the song", || player.status().position > 0.05);
        let length = fs::metadata(song).unwrap().len() as usize;
        match index % 3 {
            0 => fs::write(song, b"").unwrap(),
            1 => fs::write(song, (0..length).map(|_| random(&mut state) as u8).collect::<Vec<_>>()).unwrap(),
            _ => fs::File::options().write(true).open(song).unwrap().set_len(length as u64 / 3).unwrap(),
        }
        // Even if the file is damaged now, the next track must start.
        player.seek_to(25.0);
        player.seek_by(1000.0);
        let (mut looks, mut heard_at) = (0, f64::NAN);
        wait_until(&format!("what follows {}", song.display()), || {
            looks += 1;
            let status = player.status();
            // Seek only while the song is playing: on a slow machine, another seek would restart the preparation of
            // the last seek.
            if looks % 50 == 0 && std::mem::replace(&mut heard_at, status.position) != status.position {
                player.seek_by(10.0);
            }
            status.track.entry == 1
        });
    }
}

#[test]
fn endless_files_can_be_skipped() {
    let place = Workplace::new();
    place.write_tone("end.wav", 440.0, 1.0, [0.5; 2]);
    place.write_tone("endless.wav", 440.0, 1.0, [0.5; 2]);
    // The header of endless.wav declares 4 GB, and the file is extended to a sparse terabyte.
    let mut bytes = place.read("endless.wav");
    for length in [4, 40] {
        bytes[length..length + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    }
    fs::write(place.path("endless.wav"), &bytes).unwrap();
    fs::File::options().write(true).open(place.path("endless.wav")).unwrap().set_len(1 << 40).unwrap();
    std::os::unix::fs::symlink("/dev/zero", place.path("zero.wav")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(place.path("pipe.wav")).status().unwrap();
    assert!(made.success());
    let files = ["zero.wav", "pipe.wav", "endless.wav", "end.wav"].map(|name| place.path(name));
    let track_errors = Playlist::open(&files, Repeat::All, false).unwrap().track_errors;
    assert!(
        track_errors.len() == 2
            && track_errors.iter().all(|reported| reported.contains("not a regular file")),
        "{track_errors:?}"
    );
    let mut player = play(&files, Repeat::All);
    wait_until("the endless track", || player.status().track.entry == 2 && player.status().position > 1.2);
    player.seek_by(3600.0);
    wait_until("an hour later in the song", || player.status().position > 3600.0);
    player.skip(true);
    wait_until("the end", || player.status().track.entry == 3);
    wait_until("all again", || player.status().track.entry == 2);
}

#[test]
fn playlists_are_refused_or_played() {
    let place = Workplace::new();
    let write = |name: &str, bytes: &[u8]| fs::write(place.path(name), bytes).unwrap();
    write("binary.m3u", &[0x7f, b'E', b'L', b'F', 0, 1, 2]);
    write("empty.pls", b"[playlist]\n");
    write("hls.m3u8", b"#EXTM3U\n#EXT-X-VERSION:3\nsegment.ts\n");
    write("self.m3u", b"self.m3u\n");
    fs::create_dir(place.path("folder")).unwrap();
    for (list, what) in [
        ("binary.m3u", "not a playlist"),
        ("empty.pls", "no tracks"),
        ("hls.m3u8", "stream"),
        ("self.m3u", "itself"),
        ("folder", "no tracks"),
        ("missing.m3u", "does not exist"),
    ] {
        place.run(&[list]).refused(&[list, what]);
    }
    place.run(&["a.flac", "b.flac", "--once"]).refused(&["do not exist", "a.flac, b.flac"]);
    place.run(&["a.flac", "--once", "--repeat", "all"]).refused_arguments("--once", &["--repeat"]);
    place.run(&["a.flac", "--repeat", "twice"]).refused_arguments("--repeat", &["twice"]);
    // The missing files of a list may appear later, so the list is accepted, and the program tries to open a window.
    write("list.m3u", b"a.flac\nb.flac\n");
    place.run(&["list.m3u"]).refused(&["window"]);
}
