//! Tests of decoding with ffmpeg, compared with native decoding of the same sound.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use mariana_player::decode::{Decoder, Problem};
use mariana_testing::wave::write_wav;

use super::decoding::{
    Frame, SECONDS, best_shift, decode_all, decode_file, downmix_levels, ffmpeg, reference, rms,
};

const RATE: u32 = 48_000;

const REACH: isize = 5000;

struct Case {
    file: &'static str,
    args: &'static [&'static str],
    /// Maximum error of a sample in a lossless codec; 0 for lossy codecs, which are not checked for this.
    lossless: f32,
    /// Maximum shift of the sound, in frames. The shift comes from encoder delay that the container does not report,
    /// and from clock rounding after a seek.
    shift: usize,
}

const fn case(file: &'static str, args: &'static [&'static str], lossless: f32, shift: usize) -> Case {
    Case { file, args, lossless, shift }
}

const CASES: &[Case] = &[
    case("a.wv", &["-c:a", "wavpack"], 4e-5, 0),
    case("a.tta", &["-sample_fmt", "s16"], 4e-5, 0),
    case("a.au", &["-c:a", "pcm_s16be"], 4e-5, 0),
    case("a.w64", &["-c:a", "pcm_s16le"], 4e-5, 0),
    case("rf64.wav", &["-c:a", "pcm_s16le", "-rf64", "always"], 4e-5, 0),
    case("a.voc", &["-c:a", "pcm_s16le"], 4e-5, 0),
    case("a.wma", &["-c:a", "wmav2", "-b:a", "192k"], 0.0, 4096),
    case("a.ac3", &["-b:a", "256k"], 0.0, 1536),
    case("eac3.mka", &["-c:a", "eac3", "-b:a", "256k"], 0.0, 1536),
    case("a.dts", &["-c:a", "dca", "-strict", "-2", "-b:a", "1024k"], 0.0, 1024),
];

static MEDIA: LazyLock<(tempfile::TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.wav");
    let frames = (SECONDS * f64::from(RATE)) as usize;
    write_wav(&source, RATE, 2, reference(RATE, frames).into_iter().flatten());
    for case in CASES {
        make(&source, case.args, &folder.path().join(case.file));
    }
    (folder, source)
});

fn make(source: &Path, args: &[&str], path: &Path) {
    let mut all = vec!["-i", source.to_str().unwrap()];
    all.extend(args);
    all.extend(["-metadata", "title=Ebb", "-metadata", "artist=The Tide"]);
    ffmpeg(&all, path);
}

fn worst(got: &[Frame], wanted: &[Frame]) -> f32 {
    let pairs = got.iter().flatten().zip(wanted.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn ffmpeg_and_native_decoding_agree() {
    let (folder, source) = &*MEDIA;
    let wanted = decode_file(source);
    let mut wrong = Vec::new();
    for case in CASES {
        let mut check = |ok: bool, what: String| {
            if !ok {
                wrong.push(format!("{}: {what}", case.file));
            }
        };
        let mut decoder = Decoder::open(&folder.path().join(case.file)).unwrap();
        let got = decode_all(&mut decoder).unwrap();
        let info = decoder.info();
        check(info.sample_rate == RATE && info.source_channels == 2, format!("{info:?}"));
        let duration = info.duration.unwrap_or(0.0);
        check((duration - SECONDS).abs() < 0.1, format!("claims {duration} s"));
        if case.lossless > 0.0 {
            check(got.len() == wanted.len(), format!("{} frames, not {}", got.len(), wanted.len()));
            let worst = worst(&got, &wanted);
            check(worst <= case.lossless, format!("off by {worst}"));
            continue;
        }
        for side in 0..2 {
            let (shift, correlation) = best_shift(&got, &wanted, side, REACH);
            println!("{}: side {side} shifted by {shift}, correlates by {correlation}", case.file);
            check(shift.unsigned_abs() <= case.shift, format!("side {side} shifted by {shift}"));
            check(correlation > 0.99, format!("side {side} correlates by {correlation}"));
            let middle = 8000..wanted.len() - 8000;
            let level = 20.0 * (rms(&got[middle.clone()], side) / rms(&wanted[middle], side)).log10();
            check(level.abs() < 0.2, format!("side {side} is {level} dB too loud"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_seek_with_ffmpeg_reaches_its_target() {
    let (folder, _) = &*MEDIA;
    let mut wrong = Vec::new();
    for case in CASES {
        let path = folder.path().join(case.file);
        let straight = decode_file(&path);
        let mut decoder = Decoder::open(&path).unwrap();
        for target in [2.5, 1.23456, 1.3, 0.0, 2.0 / 3.0] {
            let frame = (target * f64::from(RATE)).round() as usize;
            let reached = decoder.seek(target).unwrap();
            if (reached * f64::from(RATE)).round() as usize != frame {
                wrong.push(format!("{}: seek to {target} reached {reached}", case.file));
            }
            let mut got = Vec::new();
            while got.len() < 30_000 && decoder.next_block(&mut got).unwrap() > 0 {}
            let rest = &straight[frame..];
            if case.lossless > 0.0 {
                let least = got.len().min(rest.len());
                if least < 30_000 || got[..least] != rest[..least] {
                    wrong.push(format!("{}: other samples after a seek to {target}", case.file));
                }
            } else {
                let (shift, correlation) = best_shift(&got, rest, 0, REACH);
                println!(
                    "{}: after a seek to {target} shifted by {shift}, correlates by {correlation}",
                    case.file
                );
                if shift.unsigned_abs() > case.shift || correlation < 0.99 {
                    wrong.push(format!("{}: shifted by {shift} after a seek to {target}", case.file));
                }
            }
        }
        // A seek past the end reaches the end; NaN reaches the start, from which the whole file is decoded again.
        let end = decoder.seek(1e6).unwrap();
        if (end - SECONDS).abs() > 0.1 || decode_all(&mut decoder).unwrap().len() > 4800 {
            wrong.push(format!("{}: the end is at {end}", case.file));
        }
        assert_eq!(decoder.seek(f64::NAN).unwrap(), 0.0);
        if decode_all(&mut decoder).unwrap() != straight {
            wrong.push(format!("{}: differs when played again from the start", case.file));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn titles_and_gains_are_read_by_ffmpeg() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.wav");
    write_wav(&source, RATE, 2, reference(RATE, 48_000).into_iter().flatten());
    for file in ["a.wma", "a.wv", "a.tta"] {
        let path = folder.path().join(file);
        make(&source, &["-metadata", "REPLAYGAIN_TRACK_GAIN=-10.00 dB"], &path);
        let info = Decoder::open(&path).unwrap().info().clone();
        assert_eq!(
            (info.title.as_deref(), info.artist.as_deref()),
            (Some("Ebb"), Some("The Tide")),
            "{file}"
        );
        assert!((20.0 * info.scene_gain.log10() + 6.0).abs() < 1e-3, "{file}: {}", info.scene_gain);
        assert_eq!(info.name, file);
    }
}

#[test]
fn more_channels_are_mixed_like_natively() {
    let folder = tempfile::tempdir().unwrap();
    for (layout, channels) in [("mono", 1), ("4.0", 4), ("5.0", 5), ("5.1", 6), ("7.1", 8)] {
        let levels = |file: &str, args: &[&str]| downmix_levels(folder.path(), layout, channels, file, args);
        let here = levels("here.wav", &["-c:a", "pcm_s16le"]);
        let there = levels("there.wv", &["-c:a", "wavpack"]);
        for (channel, (here, there)) in here.iter().zip(&there).enumerate() {
            let off = (0..2).map(|side| (here[side] - there[side]).abs()).fold(0.0, f64::max);
            assert!(off < 0.01, "channel {channel} of {layout}: {here:?} natively, {there:?} with ffmpeg");
        }
    }
}

#[test]
fn aac_and_opus_of_six_channels_and_speex_are_heard() {
    let folder = tempfile::tempdir().unwrap();
    for (file, args) in [
        ("six.opus", &["-ac", "6", "-c:a", "libopus"][..]),
        ("six.m4a", &["-ac", "6", "-c:a", "aac"]),
        ("a.spx", &["-ac", "1", "-ar", "32000", "-c:a", "libspeex"]),
        ("dolby.avi", &["-c:a", "ac3"]),
        ("broadcast.ts", &["-c:a", "aac"]),
    ] {
        let path = folder.path().join(file);
        ffmpeg(&[&["-f", "lavfi", "-i", "sine=f=440:d=1:r=48000"], args].concat(), &path);
        let mut decoder = Decoder::open(&path).unwrap_or_else(|error| panic!("{error}"));
        let rate = decoder.info().sample_rate as usize;
        let got = decode_all(&mut decoder).unwrap();
        assert!(got.len().abs_diff(rate) < rate / 10, "{file}: {} frames", got.len());
        assert!(rms(&got, 0) > 0.02, "{file} is silent");
    }
}

#[test]
fn files_that_ffmpeg_cannot_decode_are_reported_as_damaged() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |file: &str, bytes: &[u8]| {
        let path = folder.path().join(file);
        std::fs::write(&path, bytes).unwrap();
        Decoder::open(&path).err().expect("an error")
    };
    for (file, head) in
        [("a.wv", &b"wvpk"[..]), ("a.ape", b"MAC "), ("a.ac3", b"\x0B\x77"), ("a.xm", b"Extended Module: ")]
    {
        let bytes: Vec<u8> =
            head.iter().copied().chain((0..4000_u32).map(|n| ((n * 7919) >> 5) as u8)).collect();
        let error = refused(file, &bytes);
        assert!(matches!(error.problem, Problem::Damaged(_)), "{error}");
        let reported = error.to_string();
        assert!(
            reported.starts_with(file) && reported.contains("ffmpeg") && !reported.contains('\n'),
            "{reported}"
        );
        assert!(!reported.contains(folder.path().to_str().unwrap()), "{reported}");
    }
    let notes = refused("a.mid", b"MThd\0\0\0\x06\0\0\0\x01\0\x60MTrk\0\0\0\0");
    assert!(matches!(notes.problem, Problem::NotAudio(_)) && notes.to_string().contains("MIDI"), "{notes}");
}
