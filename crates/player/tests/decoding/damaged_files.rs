//! Files that are damaged, truncated or no sound at all: each ends in sound or in its error.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mariana_player::decode::{DecodeError, Decoder, Problem};

use crate::decoding::{CASES, MEDIA, SECONDS, decode_all, decode_file, ffmpeg};

fn wave_header(channels: u16, rate: u32) -> Vec<u8> {
    let mut bytes = b"RIFF\x24\x40\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00".to_vec();
    bytes.extend(channels.to_le_bytes());
    bytes.extend(rate.to_le_bytes());
    bytes.extend((rate * u32::from(channels) * 2).to_le_bytes());
    bytes.extend((channels * 2).to_le_bytes());
    bytes.extend(16u16.to_le_bytes());
    bytes.extend(b"data\x00\x40\x00\x00");
    bytes.extend([0x11; 0x4000]);
    bytes
}

#[test]
fn each_kind_of_bad_input_has_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let put = |file: &str, bytes: &[u8]| {
        let path = folder.path().join(file);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let error = |path: &Path| match Decoder::open(path) {
        Ok(_) => panic!("{} opened", path.display()),
        Err(error) => {
            let text = error.to_string();
            assert!(!text.contains('\n') && text.contains("; ") || text.contains(": "), "{text}");
            assert!(text.contains(path.file_name().unwrap().to_str().unwrap()), "{text}");
            error.problem
        }
    };
    let text = "Once upon a time there was a song that nobody had recorded.\n".repeat(400);
    let mut asf = b"\x30\x26\xB2\x75\x8E\x66\xCF\x11\xA6\xD9\x00\xAA\x00\x62\xCE\x6C".to_vec();
    asf.resize(4000, 0);

    assert!(matches!(error(&folder.path().join("missing.wav")), Problem::NotFound));
    assert!(matches!(error(folder.path()), Problem::IsFolder));
    assert!(matches!(error(&put("empty.flac", b"")), Problem::Empty));
    assert!(matches!(error(&put("text.mp3", text.as_bytes())), Problem::NotAudio(_)));
    assert!(matches!(error(&put("picture.wav", b"\x89PNG\r\n\x1a\n and so on")), Problem::NotAudio(_)));
    assert!(matches!(error(&put("a.wma", &asf)), Problem::Damaged(_)));
    assert!(matches!(error(&put("header.wav", &wave_header(2, 44_100)[..40])), Problem::Damaged(_)));
    for (file, channels, rate, number) in [
        ("still.wav", 2, 0, "0 Hz"),
        ("fast.wav", 2, 4_000_000, "4000000 Hz"),
        ("wide.wav", 64, 48_000, "64 channels"),
    ] {
        let error = error(&put(file, &wave_header(channels, rate)));
        assert!(matches!(error, Problem::OverLimit { .. }) && error.to_string().contains(number), "{error}");
    }
    assert!(Decoder::open(&put("sound.wav", &wave_header(2, 44_100))).is_ok());

    let silent = folder.path().join("silent.mkv");
    ffmpeg(&["-f", "lavfi", "-i", "testsrc=s=64x64:d=0.5", "-c:v", "libvpx"], &silent);
    assert!(matches!(error(&silent), Problem::NoAudioTrack));
}

/// Decodes any file without ffmpeg and seeks once. Returns the frame count and the error that ended the decoding.
fn endure(file: &str, bytes: Vec<u8>, most: usize) -> (usize, Option<DecodeError>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    std::fs::write(&path, bytes).unwrap();
    let begun = Instant::now();
    let mut frames = 0;
    let mut out = Vec::new();
    let result = Decoder::open_track(&path, 0).and_then(|mut decoder| {
        for round in 0..2 {
            loop {
                out.clear();
                let got = decoder.next_block(&mut out)?;
                assert!(out.iter().flatten().all(|s| s.is_finite()), "{file}: a sample is not finite");
                frames += got;
                assert!(frames <= most, "{file}: more than {most} frames");
                if got == 0 {
                    break;
                }
            }
            if round == 0 {
                decoder.seek(0.1)?;
            }
        }
        Ok(())
    });
    assert!(begun.elapsed() < Duration::from_secs(10), "{file}: took {:?}", begun.elapsed());
    (frames, result.err())
}

#[test]
fn truncated_files_play_as_far_as_they_go() {
    for case in CASES {
        let name = format!("short-{}", case.file);
        let bytes = std::fs::read(MEDIA.path(&name)).unwrap();
        let whole = decode_file(&MEDIA.path(&name)).len();
        for eighth in 0..8 {
            let (frames, error) = endure(case.file, bytes[..bytes.len() * eighth / 8].to_vec(), 4 * whole);
            assert!(frames > 0 || error.is_some(), "{name} at {eighth}/8: neither sound nor error");
        }
        // MP4 may have its tables at the end, and CAF is always read to the end first.
        let streamable = !["alac.m4a", "aac.m4a", "aac.mp4", "alac.caf", "s16.caf"].contains(&case.file);
        if streamable {
            let long = std::fs::read(MEDIA.path(case.file)).unwrap();
            let whole = (SECONDS * f64::from(case.rate)) as usize;
            let (frames, error) = endure(case.file, long[..long.len() * 3 / 4].to_vec(), 4 * whole);
            assert!(error.is_none() && frames > whole / 4, "{name}: {frames} of {whole} frames, {error:?}");
        }
    }
}

/// Pseudo-random numbers (xorshift64*).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % n
    }
}

#[test]
fn corrupted_files_end_in_sound_or_in_an_error() {
    const ROUNDS: usize = 200;
    let failures = Arc::new(Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for chunk in CASES.chunks(CASES.len().div_ceil(4)) {
            let failures = Arc::clone(&failures);
            scope.spawn(move || {
                for case in chunk {
                    let name = format!("short-{}", case.file);
                    let bytes = std::fs::read(MEDIA.path(&name)).unwrap();
                    let whole = decode_file(&MEDIA.path(&name)).len();
                    let mut random = Random(0x9E37_79B9_7F4A_7C15 ^ bytes.len() as u64);
                    let mut survived = 0;
                    for round in 0..ROUNDS {
                        let mut damaged = bytes.clone();
                        // Every second round damages only the headers, because this damage has the most effect.
                        let reach = if round % 2 == 0 { damaged.len() } else { damaged.len().min(600) };
                        for _ in 0..1 + random.below(8) {
                            let at = random.below(reach);
                            damaged[at] = match random.below(3) {
                                0 => damaged[at] ^ (1 << random.below(8)),
                                1 => 0xFF,
                                _ => random.below(256) as u8,
                            };
                        }
                        let (_, error) = endure(case.file, damaged, 400 * whole);
                        if let Some(DecodeError { problem: Problem::CodecFailure(what), .. }) = &error {
                            failures.lock().unwrap().push(format!("{name} round {round}: {what}"));
                        }
                        survived += usize::from(error.is_none());
                    }
                    // A short Ogg file is a single page. A wrong checksum rejects the whole page.
                    let least = if case.file.ends_with("ogg") || case.file.ends_with("opus") {
                        0
                    } else {
                        ROUNDS / 10
                    };
                    assert!(survived >= least, "{name}: only {survived} of {ROUNDS} still play");
                }
            });
        }
    });
    // Contained panics of the libraries are printed, but they do not fail the test.
    for failure in failures.lock().unwrap().iter() {
        println!("contained: {failure}");
    }
}

#[test]
fn a_gap_in_the_middle_does_not_shift_the_rest() {
    // One MP3 frame is overwritten. The total length must not change.
    let bytes = std::fs::read(MEDIA.path("cbr.mp3")).unwrap();
    let mut damaged = bytes.clone();
    let at = bytes.len() / 4;
    damaged[at..at + 700].fill(0x55);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hole.mp3");
    std::fs::write(&path, damaged).unwrap();
    let mut decoder = Decoder::open(&path).unwrap();
    let got = decode_all(&mut decoder).unwrap();
    let whole = decode_file(&MEDIA.path("cbr.mp3"));
    assert!(got.len().abs_diff(whole.len()) <= 2 * 1152, "{} of {}", got.len(), whole.len());
}
