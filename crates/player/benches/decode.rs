//! Measures the decoding speed per format: three minutes of stereo at 44.1 kHz (Opus 48 kHz), from file to frames.
//! Divide frames (elements) per second by the sample rate to get multiples of real time.

use std::path::Path;
use std::process::Command;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use mariana_player::decode::Decoder;
use mariana_player::resample::Resampler;

const SECONDS: u32 = 180;

/// Sound similar to music: chords, and noise that swells four times a second. The two sides differ.
const MUSIC: &str = "aevalsrc=\
    0.15*sin(345*t)+0.1*sin(1727*t)+0.08*sin(5180*t)+0.2*(random(0)-0.5)*exp(-8*mod(t\\,0.25))|\
    0.15*sin(459*t)+0.1*sin(2073*t)+0.08*sin(6911*t)+0.2*(random(1)-0.5)*exp(-6*mod(t\\,0.5)):s=44100";

const FORMATS: &[(&str, &[&str])] = &[
    ("wav-s16.wav", &["-c:a", "pcm_s16le"]),
    ("wav-f32.wav", &["-c:a", "pcm_f32le"]),
    ("aiff.aiff", &["-c:a", "pcm_s16be"]),
    ("caf.caf", &["-c:a", "pcm_s16le"]),
    ("flac.flac", &["-c:a", "flac"]),
    ("alac.m4a", &["-c:a", "alac"]),
    ("mp3.mp3", &["-c:a", "libmp3lame", "-b:a", "192k"]),
    ("vorbis.ogg", &["-c:a", "libvorbis", "-q:a", "5"]),
    ("opus.opus", &["-c:a", "libopus", "-b:a", "128k"]),
    ("aac.m4a", &["-c:a", "aac", "-b:a", "192k"]),
    ("opus.webm", &["-c:a", "libopus", "-b:a", "128k"]),
    ("vorbis.mkv", &["-c:a", "libvorbis", "-q:a", "5"]),
];

fn ffmpeg(args: &[&str], output: &Path) {
    let run = Command::new("ffmpeg").args(["-v", "error", "-nostdin", "-y"]).args(args).arg(output).status();
    assert!(run.is_ok_and(|status| status.success()), "ffmpeg {args:?}: install ffmpeg with this encoder");
}

fn decode(path: &Path) -> usize {
    let mut decoder = Decoder::open(path).unwrap_or_else(|e| panic!("{e}"));
    let mut block = Vec::new();
    let mut frames = 0;
    loop {
        block.clear();
        match decoder.next_block(&mut block) {
            Ok(0) => return frames,
            Ok(n) => frames += n,
            Err(e) => panic!("{e}"),
        }
    }
}

fn decoding(c: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap_or_else(|e| panic!("{e}"));
    let source = folder.path().join("source.wav");
    ffmpeg(&["-f", "lavfi", "-t", &SECONDS.to_string(), "-i", MUSIC, "-c:a", "pcm_s16le"], &source);
    let mut group = c.benchmark_group("decode");
    group.sample_size(10);
    for (file, args) in FORMATS {
        let path = folder.path().join(file);
        ffmpeg(&[&["-i", &source.to_string_lossy()], *args].concat(), &path);
        group.throughput(Throughput::Elements(decode(&path) as u64));
        group.bench_function(*file, |b| b.iter(|| decode(&path)));
    }
    group.finish();
}

fn resampling(c: &mut Criterion) {
    let second: Vec<[f32; 2]> =
        (0..44_100).map(|n| [(n as f32 * 0.1).sin(), (n as f32 * 0.07).cos()]).collect();
    let mut group = c.benchmark_group("resample");
    group.throughput(Throughput::Elements(44_100));
    for to in [48_000, 96_000] {
        let mut resampler = Resampler::new(44_100, to).unwrap_or_else(|e| panic!("{e}"));
        group.bench_function(format!("44100 to {to}"), |b| {
            b.iter_batched_ref(
                || Vec::with_capacity(200_000),
                |out| resampler.process(&second, out),
                BatchSize::SmallInput,
            )
        });
    }
    group.finish();
}

criterion_group!(benches, decoding, resampling);
criterion_main!(benches);
