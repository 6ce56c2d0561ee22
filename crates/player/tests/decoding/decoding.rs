//! Tests of decoding through the public API, with files that ffmpeg creates from a known signal. The signal is a
//! function of time, so that the decoded sound can be compared at any rate. Left and right differ, are broad-band (to
//! reveal shifts) and stay below 8 kHz (to survive lossy codecs).

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use mariana_player::decode::{DecodeError, Decoder, Problem};
use mariana_player::source::FrameSource;
use mariana_testing::wave::write_wav;

pub(super) type Frame = [f32; 2];

pub(super) const SECONDS: f64 = 4.0;

fn signal(t: f64) -> Frame {
    let sweep = |from: f64, to: f64, period: f64| {
        let u = t.rem_euclid(period);
        (TAU * (from * u + (to - from) * u * u / (2.0 * period))).sin()
    };
    let burst = |every: f64, hz: f64| {
        let u = t.rem_euclid(every) - every / 2.0;
        (-(u * 400.0).powi(2)).exp() * (TAU * hz * u).cos()
    };
    let left = 0.3 * sweep(100.0, 6000.0, 1.7) + 0.35 * burst(0.25, 2500.0);
    let right = 0.3 * sweep(5000.0, 200.0, 1.3) + 0.35 * burst(0.4, 1500.0);
    [left as f32, right as f32]
}

pub(super) fn reference(rate: u32, frames: usize) -> Vec<Frame> {
    (0..frames).map(|n| signal(n as f64 / f64::from(rate))).collect()
}

pub(super) fn ffmpeg(args: &[&str], output: &Path) {
    let run = Command::new("ffmpeg")
        .args(["-v", "error", "-nostdin", "-y"])
        .args(args)
        .arg(output)
        .output()
        .expect("ffmpeg is needed to make the test media: install it");
    assert!(run.status.success(), "ffmpeg {args:?}: {}", String::from_utf8_lossy(&run.stderr));
}

pub(super) struct Case {
    pub(super) file: &'static str,
    args: &'static [&'static str],
    pub(super) rate: u32,
    /// Maximum error of a sample in a lossless codec; 0 for lossy codecs, which are not checked for this.
    lossless: f32,
    /// Maximum difference between a sample after a seek and the same sample of an uninterrupted run.
    seek: f32,
    tail: usize,
    /// Encoder delay that ffmpeg does not write into this container, in frames.
    unreported: usize,
}

const fn case(
    file: &'static str,
    args: &'static [&'static str],
    rate: u32,
    lossless: f32,
    seek: f32,
    tail: usize,
) -> Case {
    Case { file, args, rate, lossless, seek, tail, unreported: 0 }
}

const fn unreported(case: Case, frames: usize) -> Case {
    Case { unreported: frames, ..case }
}

/// The tested formats. AAC is encoded without noise substitution, whose random noise would differ after a seek.
pub(super) const CASES: &[Case] = &[
    case("s16.wav", &["-c:a", "pcm_s16le"], 44_100, 6e-5, 0.0, 0),
    case("s24.wav", &["-c:a", "pcm_s24le"], 44_100, 4e-7, 0.0, 0),
    case("f32.wav", &["-c:a", "pcm_f32le"], 44_100, 1e-7, 0.0, 0),
    case("u8.wav", &["-c:a", "pcm_u8"], 44_100, 0.017, 0.0, 0),
    case("s16.aiff", &["-c:a", "pcm_s16be"], 44_100, 6e-5, 0.0, 0),
    case("s16.caf", &["-c:a", "pcm_s16le"], 44_100, 6e-5, 0.0, 0),
    case("alac.caf", &["-c:a", "alac"], 44_100, 6e-5, 0.0, 0),
    case("a.flac", &["-c:a", "flac", "-sample_fmt", "s16"], 44_100, 6e-5, 0.0, 0),
    case("flac.ogg", &["-c:a", "flac", "-sample_fmt", "s16"], 44_100, 6e-5, 0.0, 0),
    case("alac.m4a", &["-c:a", "alac", "-sample_fmt", "s16p"], 44_100, 6e-5, 0.0, 0),
    case("cbr.mp3", &["-c:a", "libmp3lame", "-b:a", "192k"], 44_100, 0.0, 1e-5, 0),
    case("vbr.mp3", &["-c:a", "libmp3lame", "-q:a", "2"], 44_100, 0.0, 1e-5, 0),
    case("low.mp3", &["-c:a", "libmp3lame", "-b:a", "64k"], 44_100, 0.0, 1e-5, 0),
    case("vorbis.ogg", &["-c:a", "libvorbis", "-q:a", "6"], 44_100, 0.0, 1e-5, 0),
    case("a.opus", &["-c:a", "libopus", "-b:a", "128k"], 48_000, 0.0, 1e-4, 0),
    case("aac.m4a", &["-c:a", "aac", "-aac_pns", "0", "-b:a", "192k"], 44_100, 0.0, 1e-5, 0),
    case(
        "aac.mp4",
        &[
            "-f",
            "lavfi",
            "-i",
            "testsrc=s=64x64:d=4",
            "-map",
            "1:v",
            "-map",
            "0:a",
            "-c:v",
            "mpeg4",
            "-c:a",
            "aac",
            "-aac_pns",
            "0",
            "-b:a",
            "192k",
        ],
        44_100,
        0.0,
        1e-5,
        0,
    ),
    case(
        "fragmented.mp4",
        &[
            "-c:a",
            "aac",
            "-aac_pns",
            "0",
            "-b:a",
            "192k",
            "-movflags",
            "+frag_keyframe+delay_moov",
            "-frag_duration",
            "500000",
        ],
        44_100,
        0.0,
        1e-5,
        1024,
    ),
    case("pcm.mkv", &["-c:a", "pcm_s16le"], 44_100, 6e-5, 0.0, 0),
    case("flac.mkv", &["-c:a", "flac", "-sample_fmt", "s16"], 44_100, 6e-5, 0.0, 0),
    case("opus.mkv", &["-c:a", "libopus", "-b:a", "128k"], 48_000, 0.0, 1e-4, 960),
    case(
        "opus.webm",
        &[
            "-f",
            "lavfi",
            "-i",
            "testsrc=s=64x64:d=4",
            "-map",
            "1:v",
            "-map",
            "0:a",
            "-c:v",
            "libvpx",
            "-c:a",
            "libopus",
            "-b:a",
            "128k",
        ],
        48_000,
        0.0,
        1e-4,
        960,
    ),
    case("vorbis.mkv", &["-c:a", "libvorbis", "-q:a", "6"], 44_100, 0.0, 0.0, 1024),
    case("vorbis.webm", &["-c:a", "libvorbis", "-q:a", "6"], 44_100, 0.0, 0.0, 1024),
    unreported(
        case("aac.mkv", &["-c:a", "aac", "-aac_pns", "0", "-b:a", "192k"], 44_100, 0.0, 1e-5, 1024),
        1024,
    ),
    unreported(case("mp3.mkv", &["-c:a", "libmp3lame", "-b:a", "192k"], 44_100, 0.0, 1e-5, 1152), 1105),
];

pub(super) struct Media {
    folder: tempfile::TempDir,
}

impl Media {
    pub(super) fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }
}

/// All files of [`CASES`], created once. For the damage tests, there are also `short-` files of a quarter of a second.
pub(super) static MEDIA: LazyLock<Media> = LazyLock::new(|| {
    let media = Media { folder: tempfile::tempdir().unwrap() };
    for (prefix, seconds) in [("", SECONDS), ("short-", 0.25)] {
        let frames = (seconds * 44_100.0) as usize;
        let source = media.path(&format!("{prefix}source.wav"));
        write_wav(&source, 44_100, 2, reference(44_100, frames).into_iter().flatten());
    }
    std::thread::scope(|scope| {
        for chunk in CASES.chunks(CASES.len().div_ceil(4)) {
            let media = &media;
            scope.spawn(move || {
                for case in chunk {
                    for prefix in ["", "short-"] {
                        let source = media.path(&format!("{prefix}source.wav"));
                        let mut args = vec!["-i", source.to_str().unwrap()];
                        args.extend(case.args);
                        args.extend(["-metadata", "title=Ebb", "-metadata", "artist=The Tide"]);
                        ffmpeg(&args, &media.path(&format!("{prefix}{}", case.file)));
                    }
                }
            });
        }
    });
    media
});

pub(super) fn decode_all(decoder: &mut Decoder) -> Result<Vec<Frame>, DecodeError> {
    let mut frames = Vec::new();
    while decoder.next_block(&mut frames)? > 0 {}
    Ok(frames)
}

pub(super) fn decode_file(path: &Path) -> Vec<Frame> {
    let mut decoder = Decoder::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    decode_all(&mut decoder).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Returns the best shift of `got` against `wanted`, up to `reach` frames, and its correlation (1 for equal signals).
pub(super) fn best_shift(got: &[Frame], wanted: &[Frame], side: usize, reach: isize) -> (isize, f64) {
    let (start, length) = (20_000usize, 2048usize);
    let wanted: Vec<f64> = wanted[start..start + length].iter().map(|f| f64::from(f[side])).collect();
    let got: Vec<f64> = got.iter().map(|f| f64::from(f[side])).collect();
    let energy = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>();
    let mut best = (0, -1.0);
    for shift in -reach..=reach {
        let at = (start as isize + shift) as usize;
        let piece = &got[at..at + length];
        let dot: f64 = piece.iter().zip(&wanted).map(|(a, b)| a * b).sum();
        let correlation = dot / (energy(piece) * energy(&wanted)).sqrt();
        if correlation > best.1 {
            best = (shift, correlation);
        }
    }
    best
}

pub(super) fn rms(frames: &[Frame], side: usize) -> f64 {
    (frames.iter().map(|f| f64::from(f[side]).powi(2)).sum::<f64>() / frames.len() as f64).sqrt()
}

#[test]
fn every_format_reproduces_the_signal() {
    let mut wrong = Vec::new();
    for case in CASES {
        let mut decoder = Decoder::open(&MEDIA.path(case.file)).unwrap();
        let got = decode_all(&mut decoder).unwrap();
        let info = decoder.info().clone();
        let frames = (SECONDS * f64::from(case.rate)) as usize;
        let wanted = reference(case.rate, frames);
        let mut check = |ok: bool, what: String| {
            if !ok {
                wrong.push(format!("{}: {what}", case.file));
            }
        };
        check(
            info.sample_rate == case.rate && decoder.sample_rate() == case.rate,
            format!("{} Hz", info.sample_rate),
        );
        check(info.source_channels == 2, format!("{} channels", info.source_channels));
        check(
            got.len().abs_diff(frames + case.unreported) <= case.tail,
            format!("{} frames, not {frames}", got.len()),
        );
        let duration = info.duration.unwrap_or(0.0);
        let slack = (case.tail + case.unreported) as f64 / f64::from(case.rate) + 0.03;
        // ffmpeg counts the padding of ALAC in CAF, and a fragmented file states no duration.
        if !["fragmented.mp4", "alac.caf"].contains(&case.file) {
            check((duration - SECONDS).abs() < slack, format!("claims {duration} s"));
        }
        if case.lossless > 0.0 {
            let worst = got
                .iter()
                .flatten()
                .zip(wanted.iter().flatten())
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            check(worst <= case.lossless, format!("off by {worst}"));
        }
        for side in 0..2 {
            let (shift, correlation) = best_shift(&got, &wanted, side, 1500);
            check(shift == case.unreported as isize, format!("side {side} shifted by {shift}"));
            check(correlation > 0.99, format!("side {side} correlates by {correlation}"));
            let middle = 4000..frames - 4000;
            let heard = rms(&got[middle.start + case.unreported..middle.end + case.unreported], side);
            let level = 20.0 * (heard / rms(&wanted[middle], side)).log10();
            // LAME lowers the level by up to 0.45 dB to prevent clipping.
            let tolerance = if case.file.contains("mp3") { 0.5 } else { 0.1 };
            check(level.abs() < tolerance, format!("side {side} is {level} dB too loud"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_seek_lands_on_the_frame() {
    let mut wrong = Vec::new();
    for case in CASES {
        let path = MEDIA.path(case.file);
        let straight = decode_file(&path);
        let mut decoder = Decoder::open(&path).unwrap();
        let mut worst = 0.0f32;
        for target in [2.5, 0.001, 3.9, 1.23456, 1.3, 0.0, 3.0, 0.6, 2.0 / 3.0] {
            let frame = (target * f64::from(case.rate)).round() as usize;
            let reached = decoder.seek(target).unwrap();
            if (reached * f64::from(case.rate)).round() as usize != frame {
                wrong.push(format!("{}: seek to {target} reached {reached}", case.file));
                continue;
            }
            let mut got = Vec::new();
            while got.len() < 6000 && decoder.next_block(&mut got).unwrap() > 0 {}
            let rest = &straight[frame..];
            let least = rest.len().min(6000);
            if got.len() < least {
                wrong.push(format!("{}: only {} frames after a seek to {target}", case.file, got.len()));
            }
            let error = got
                .iter()
                .flatten()
                .zip(rest.iter().flatten())
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            worst = worst.max(error);
        }
        println!("{}: largest difference after a seek {worst:e}", case.file);
        if worst > case.seek {
            wrong.push(format!("{}: samples after a seek differ by {worst}", case.file));
        }
        // A seek past the end reaches the end, and invalid times reach the start.
        let end = decoder.seek(1e6).unwrap();
        if (end * f64::from(case.rate)).round() as usize != straight.len() {
            wrong.push(format!("{}: the end is at {end}, not at frame {}", case.file, straight.len()));
        }
        if decoder.next_block(&mut Vec::new()).unwrap() != 0 {
            wrong.push(format!("{}: sound past the end", case.file));
        }
        for nonsense in [-1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(decoder.seek(nonsense).unwrap(), 0.0, "{}", case.file);
        }
        // After these seeks the whole file is decoded again.
        let again = decode_all(&mut decoder).unwrap();
        if again != straight {
            wrong.push(format!("{}: differs when played again from the start", case.file));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn titles_are_read() {
    for file in ["a.flac", "cbr.mp3", "vorbis.ogg", "a.opus", "aac.m4a"] {
        let info = Decoder::open(&MEDIA.path(file)).unwrap().info().clone();
        assert_eq!(
            (info.title.as_deref(), info.artist.as_deref()),
            (Some("Ebb"), Some("The Tide")),
            "{file}"
        );
        assert_eq!(info.name, file);
    }
}

#[test]
fn a_file_in_memory_decodes_as_on_disk() {
    let path = MEDIA.path("vorbis.ogg");
    let bytes: &'static [u8] = Box::leak(std::fs::read(&path).unwrap().into_boxed_slice());
    let mut decoder = Decoder::from_bytes("demo.ogg", bytes).unwrap();
    assert_eq!(decoder.info().name, "demo.ogg");
    assert_eq!(decode_all(&mut decoder).unwrap(), decode_file(&path));
    let empty = Decoder::from_bytes("nothing", &[]);
    assert!(matches!(empty, Err(DecodeError { problem: Problem::Empty, .. })));
}

#[test]
fn mono_is_heard_on_both_sides_at_full_level() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("mono.wav");
    write_wav(&source, 44_100, 1, reference(44_100, 44_100).into_iter().map(|f| f[0]));
    for (file, args) in [
        ("mono.wav", &[][..]),
        ("mono.mp3", &["-c:a", "libmp3lame"]),
        ("mono.ogg", &["-c:a", "libvorbis"]),
        ("mono.opus", &["-c:a", "libopus"]),
        ("mono.m4a", &["-c:a", "aac"]),
        ("mono.flac", &["-c:a", "flac"]),
        ("mono.caf", &["-c:a", "pcm_s16be"]),
    ] {
        let path = folder.path().join(file);
        if path != source {
            let mut all = vec!["-i", source.to_str().unwrap()];
            all.extend(args);
            ffmpeg(&all, &path);
        }
        let decoder = Decoder::open(&path).unwrap();
        assert_eq!(decoder.info().source_channels, 1, "{file}");
        let got = decode_file(&path);
        assert!(got.iter().all(|f| f[0] == f[1]), "{file}: sides differ");
        let wanted = reference(decoder.sample_rate(), got.len());
        let level = 20.0 * (rms(&got[4000..40_000], 0) / rms(&wanted[4000..40_000], 0)).log10();
        assert!(level.abs() < 0.5, "{file}: {level} dB");
    }
}

/// Decodes each channel alone. Returns the left and right levels, relative to full scale in the channel.
pub(super) fn downmix_levels(
    folder: &Path,
    layout: &str,
    channels: usize,
    file: &str,
    args: &[&str],
) -> Vec<[f64; 2]> {
    let source = folder.join(format!("{layout}-{channels}.wav"));
    let part = 12_000usize;
    let samples = (0..part * channels).flat_map(|n| {
        let tone = (TAU * 300.0 * n as f64 / 48_000.0).sin() as f32 * 0.5;
        (0..channels).map(move |c| if n / part == c { tone } else { 0.0 })
    });
    write_wav(&source, 48_000, channels as u16, samples);
    let path = folder.join(file);
    let mut all = vec!["-channel_layout", layout, "-i", source.to_str().unwrap()];
    all.extend(args);
    ffmpeg(&all, &path);
    let got = decode_file(&path);
    assert_eq!(Decoder::open(&path).unwrap().info().source_channels, channels, "{file}");
    (0..channels)
        .map(|c| {
            let middle = &got[c * part + 4000..(c + 1) * part - 4000];
            [0, 1].map(|side| rms(middle, side) / (0.5 / 2f64.sqrt()))
        })
        .collect()
}

#[test]
fn surround_is_mixed_by_the_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let h = 0.5f64.sqrt();
    let five = [[1.0, 0.0], [0.0, 1.0], [h, h], [h, h], [h, 0.0], [0.0, h]];
    let seven = [five.as_slice(), &[[h, 0.0], [0.0, h]]].concat();
    let four = [[1.0, 0.0], [0.0, 1.0], [h, h], [0.5, 0.5]];
    let five = five.as_slice();
    for (layout, weights, file, args) in [
        ("5.1", five, "51.wav", &["-c:a", "pcm_s16le"][..]),
        ("5.1", five, "51.flac", &["-c:a", "flac"]),
        ("5.1", five, "51.ogg", &["-c:a", "libvorbis", "-q:a", "6"]),
        ("5.1", five, "51-alac.m4a", &["-c:a", "alac"]),
        ("7.1", &seven, "71.wav", &["-c:a", "pcm_s24le"]),
        ("7.1", &seven, "71.flac", &["-c:a", "flac"]),
        ("7.1", &seven, "71.ogg", &["-c:a", "libvorbis", "-q:a", "6"]),
        ("4.0", &four, "40.wav", &["-c:a", "pcm_s16le"]),
    ] {
        let got = downmix_levels(folder.path(), layout, weights.len(), file, args);
        let sum: f64 = weights.iter().map(|w| w[0]).sum();
        for (c, (got, wanted)) in got.iter().zip(weights).enumerate() {
            // libvorbis leaves out most of the LFE channel's tone.
            if c == 3 && file.ends_with(".ogg") {
                continue;
            }
            for side in 0..2 {
                let wanted = wanted[side] / sum;
                assert!(
                    (got[side] - wanted).abs() < 0.02,
                    "{file}: channel {c}, side {side}: {} not {wanted}",
                    got[side]
                );
            }
        }
    }
}

#[test]
fn a_second_track_serves_where_the_first_has_no_decoder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.mkv");
    let sine = ["-f", "lavfi", "-i", "sine=f=440:d=1"];
    let maps = ["-map", "0", "-map", "1", "-c:a:0", "ac3", "-c:a:1", "flac", "-ac", "2"];
    ffmpeg(&[&sine[..], &sine[..], &maps[..]].concat(), &path);
    let got = decode_file(&path);
    assert!(got.len().abs_diff(44_100) < 10 && rms(&got, 0) > 0.05, "{} frames", got.len());
}

#[test]
fn chained_streams_continue_at_the_first_rate() {
    let folder = tempfile::tempdir().unwrap();
    let mut chain = Vec::new();
    for (i, (rate, channels, codec)) in
        [("44100", "2", "libvorbis"), ("44100", "1", "libvorbis"), ("22050", "2", "libvorbis")]
            .iter()
            .enumerate()
    {
        let path = folder.path().join(format!("{i}.ogg"));
        let serial = format!("{}", 100 + i);
        let sine = "sine=f=440:d=1:r=44100";
        ffmpeg(
            &[
                "-f",
                "lavfi",
                "-i",
                sine,
                "-ar",
                rate,
                "-ac",
                channels,
                "-c:a",
                codec,
                "-serial_offset",
                &serial,
            ],
            &path,
        );
        chain.extend(std::fs::read(path).unwrap());
    }
    let path = folder.path().join("chain.ogg");
    std::fs::write(&path, chain).unwrap();
    let mut decoder = Decoder::open(&path).unwrap();
    let straight = decode_all(&mut decoder).unwrap();
    assert!(straight.len().abs_diff(3 * 44_100) < 8, "{} frames", straight.len());
    // The tone has the same pitch and level in all three parts.
    for second in 0..3 {
        let middle = &straight[second * 44_100 + 5000..(second + 1) * 44_100 - 5000];
        let crossings = middle.windows(2).filter(|w| w[0][0] < 0.0 && w[1][0] >= 0.0).count();
        let hz = crossings as f64 * 44_100.0 / middle.len() as f64;
        assert!((hz - 440.0).abs() < 3.0, "second {second}: {hz} Hz");
    }
    for target in [2.5, 0.5, 1.5] {
        let frame = (target * 44_100.0) as usize;
        assert_eq!(decoder.seek(target).unwrap(), target);
        let mut got = Vec::new();
        while got.len() < 1000 && decoder.next_block(&mut got).unwrap() > 0 {}
        assert_eq!(got[..1000], straight[frame..frame + 1000], "after a seek to {target}");
    }
}
