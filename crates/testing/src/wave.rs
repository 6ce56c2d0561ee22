//! WAVE files.

use std::path::Path;

/// Writes a WAVE file of 32-bit floats.
pub fn write_wav(path: &Path, rate: u32, channels: u16, samples: impl Iterator<Item = f32>) {
    write_tagged_wav(path, rate, channels, samples, &[]);
}

/// Writes a WAVE file of 32-bit floats after an ID3 tag, such as `("TIT2", "a title")` or `("TPE1", "an artist")`.
pub fn write_tagged_wav(
    path: &Path,
    rate: u32,
    channels: u16,
    samples: impl Iterator<Item = f32>,
    tags: &[(&str, &str)],
) {
    let mut data = Vec::new();
    // Tests are not optimized: a loop takes a fraction of the time of nested iterators.
    for sample in samples {
        data.extend_from_slice(&sample.to_le_bytes());
    }
    let mut bytes = id3(tags);
    bytes.extend(b"RIFF");
    bytes.extend((data.len() as u32 + 36).to_le_bytes());
    bytes.extend(b"WAVEfmt \x10\x00\x00\x00\x03\x00");
    bytes.extend(channels.to_le_bytes());
    bytes.extend(rate.to_le_bytes());
    bytes.extend((rate * u32::from(channels) * 4).to_le_bytes());
    bytes.extend((channels * 4).to_le_bytes());
    bytes.extend(32u16.to_le_bytes());
    bytes.extend(b"data");
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    std::fs::write(path, bytes).unwrap();
}

/// An ID3 tag (version 2.4) with texts in UTF-8.
fn id3(tags: &[(&str, &str)]) -> Vec<u8> {
    // Sizes have seven bits in each byte.
    let size = |size: usize| [21, 14, 7, 0].map(|bits| (size >> bits & 0x7f) as u8);
    let mut frames = Vec::new();
    for (name, text) in tags {
        frames.extend(name.as_bytes());
        frames.extend(size(text.len() + 1));
        frames.extend(b"\0\0\x03");
        frames.extend(text.as_bytes());
    }
    if frames.is_empty() {
        return frames;
    }
    [b"ID3\x04\0\0", &size(frames.len())[..], &frames].concat()
}
