//! Files that other programs play in spite of wrong numbers in their headers.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use mariana_player::decode::Decoder;

use crate::decoding::{MEDIA, decode_all, decode_file, ffmpeg, rms};

/// Changes the pages of an Ogg file and corrects their checksums. `change` gets the number of the page.
fn with_pages(file: &Path, change: impl Fn(usize, &mut [u8])) -> Vec<u8> {
    let mut bytes = std::fs::read(file).unwrap();
    let (mut at, mut number) = (0, 0);
    while at < bytes.len() {
        let lacing = usize::from(bytes[at + 26]);
        let size =
            27 + lacing + bytes[at + 27..at + 27 + lacing].iter().map(|n| usize::from(*n)).sum::<usize>();
        let page = &mut bytes[at..at + size];
        change(number, page);
        page[22..26].fill(0);
        let sum = page.iter().fold(0_u32, |sum, byte| {
            (0..8).fold(sum ^ u32::from(*byte) << 24, |sum, _| sum << 1 ^ (0x04c1_1db7 * (sum >> 31)))
        });
        page[22..26].copy_from_slice(&sum.to_le_bytes());
        (at, number) = (at + size, number + 1);
    }
    bytes
}

fn decoded(file: &str, bytes: &[u8]) -> (Vec<[f32; 2]>, Option<f64>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    std::fs::write(&path, bytes).unwrap();
    let mut decoder = Decoder::open(&path).unwrap();
    let frames = decode_all(&mut decoder).unwrap();
    (frames, decoder.info().duration)
}

#[test]
fn the_gain_in_the_header_of_opus_is_applied() {
    let quiet = with_pages(&MEDIA.path("a.opus"), |page, bytes| {
        if page == 0 {
            let head = bytes.windows(8).position(|bytes| bytes == b"OpusHead").unwrap();
            bytes[head + 16..head + 18].copy_from_slice(&(-20_i16 * 256).to_le_bytes());
        }
    });
    let (quiet, _) = decoded("a.opus", &quiet);
    let gain = 20.0 * (rms(&quiet, 0) / rms(&decode_file(&MEDIA.path("a.opus")), 0)).log10();
    assert!((gain + 20.0).abs() < 0.01, "{gain} dB");
}

#[test]
fn ogg_pages_without_a_position_keep_their_sound() {
    for file in ["vorbis.ogg", "a.opus", "flac.ogg"] {
        let last = std::cell::Cell::new(0);
        with_pages(&MEDIA.path(file), |page, _| last.set(page));
        let bytes = with_pages(&MEDIA.path(file), |page, bytes| {
            if page > 2 && page % 2 == 1 && page < last.get() {
                bytes[6..14].fill(0xff);
            }
        });
        assert!(decoded(file, &bytes).0 == decode_file(&MEDIA.path(file)), "{file} differs");
    }
}

#[test]
fn an_mp3_longer_than_its_header_says_plays_to_its_end() {
    let bytes = std::fs::read(MEDIA.path("cbr.mp3")).unwrap();
    let whole = decode_file(&MEDIA.path("cbr.mp3")).len();
    let count = bytes.windows(4).position(|bytes| bytes == b"Info").unwrap() + 8;
    let mut none = bytes.clone();
    none[count..count + 4].fill(0);
    let (frames, duration) = decoded("none.mp3", &none);
    assert!(frames.len() >= whole && frames.len() < whole + 1152, "{} of {whole} frames", frames.len());
    let length = frames.len() as f64 / 44_100.0;
    assert!(duration.is_some_and(|seconds| (seconds - length).abs() < 0.1), "{duration:?} not {length}");
    let (frames, _) = decoded("twice.mp3", &[bytes.clone(), bytes].concat());
    assert!(frames.len() >= 2 * whole, "{} of {} frames", frames.len(), 2 * whole);
}

#[test]
fn a_wave_file_with_wrong_sizes_plays_to_its_end() {
    let bytes = std::fs::read(MEDIA.path("s16.wav")).unwrap();
    let wanted = decode_file(&MEDIA.path("s16.wav"));
    let data = bytes.windows(4).position(|bytes| bytes == b"data").unwrap() + 4;
    let aiff = std::fs::read(MEDIA.path("s16.aiff")).unwrap();
    let sound = aiff.windows(4).position(|bytes| bytes == b"SSND").unwrap() + 4;
    for (at, size) in [(4, 0), (4, 5008), (data, 0), (data, 0x7000_0000)] {
        let mut changed = bytes.clone();
        changed[at..at + 4].copy_from_slice(&u32::to_le_bytes(size));
        let (frames, duration) = decoded("a.wav", &changed);
        assert!(frames == wanted && duration == Some(4.0), "{size} at {at}");
    }
    for at in [4, sound] {
        let mut changed = aiff.clone();
        changed[at..at + 4].fill(0);
        assert!(decoded("a.aiff", &changed).0 == wanted, "AIFF at {at}");
    }
}

#[test]
fn sound_ends_without_the_padding_of_its_container() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webm");
    ffmpeg(&["-f", "lavfi", "-i", "sine=f=440:d=1.001:r=48000", "-c:a", "libopus"], &path);
    assert_eq!(decode_file(&path).len(), 48_048);
}

#[test]
fn a_fragmented_file_has_a_length_and_jumps() {
    let mut decoder = Decoder::open(&MEDIA.path("fragmented.mp4")).unwrap();
    let length = decoder.info().duration.expect("a length");
    assert!((length - 4.0).abs() < 0.05, "{length} s");
    let straight = decode_all(&mut decoder).unwrap();
    assert!((straight.len() as f64 / 44_100.0 - length).abs() < 1e-3, "{} frames", straight.len());
    assert_eq!(decoder.seek(3.0).unwrap(), 3.0);
    assert_eq!(decode_all(&mut decoder).unwrap().len(), straight.len() - 3 * 44_100);
}
