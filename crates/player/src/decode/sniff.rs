//! Recognition of files that the demuxers reject, so that the error can name their format.

use std::io::Cursor;

use mariana_music::limits as music_limits;

use crate::limits;

use super::error::Problem;
use super::mended::chunks;

pub(super) const SNIFF_BYTES: usize = 4096;

/// Known audio and video containers without a demuxer here: offset, mark, name.
const FOREIGN_MEDIA: &[(usize, &[u8], &str)] = &[
    (0, b"\x30\x26\xB2\x75\x8E\x66\xCF\x11", "a Windows Media file (WMA, ASF)"),
    (8, b"AVI ", "an AVI file"),
    (0, b"MAC ", "a Monkey's Audio file"),
    (0, b"wvpk", "a WavPack file"),
    (0, b"MPCK", "a Musepack file"),
    (0, b"MP+", "a Musepack file"),
    (0, b"TTA1", "a True Audio file"),
    (0, b"DSD ", "a DSD file"),
    (0, b"FRM8", "a DSD file"),
    (0, b".RMF", "a RealMedia file"),
    (0, b"FLV\x01", "a Flash video"),
    (0, b"#!AMR", "an AMR file"),
    (0, b"\x00\x00\x01\xBA", "an MPEG program stream"),
    (0, b".snd", "an AU file"),
    (0, b"riff\x2E\x91\xCF\x11", "a Wave64 file"),
    (28, b"Speex   ", "a Speex file"),
    (0, b"RF64", "an RF64 file"),
    (0, b"BW64", "a BW64 file"),
    (0, b"Creative Voice File", "a Creative Voice file"),
    (0, b"\x0B\x77", "an AC-3 file (Dolby Digital)"),
    (0, b"\x7F\xFE\x80\x01", "a DTS file"),
    (0, b"\xFE\x7F\x01\x80", "a DTS file"),
    (0, b"\x1F\xFF\xE8\x00", "a DTS file"),
    (0, b"\xFF\x1F\x00\xE8", "a DTS file"),
    (0, b"DTSHDHDR", "a DTS file"),
    (0, b"Extended Module: ", "a tracker's module"),
    (0, b"IMPM", "a tracker's module"),
    (44, b"SCRM", "a tracker's module"),
    (1080, b"M.K.", "a tracker's module"),
    (1080, b"M!K!", "a tracker's module"),
    (1080, b"FLT4", "a tracker's module"),
    (1080, b"4CHN", "a tracker's module"),
    (1080, b"6CHN", "a tracker's module"),
    (1080, b"8CHN", "a tracker's module"),
];

/// Other files that are often mistaken for audio: offset, mark, description.
const OTHER_FILES: &[(usize, &[u8], &str)] = &[
    (0, b"\x89PNG", "it is a PNG image"),
    (0, b"\xFF\xD8\xFF", "it is a JPEG image"),
    (0, b"GIF8", "it is a GIF image"),
    (8, b"WEBP", "it is a WebP image"),
    (0, b"%PDF", "it is a PDF document"),
    (0, b"PK\x03\x04", "it is a zip archive"),
    (0, b"\x1F\x8B", "it is a gzip archive"),
    (0, b"\x7FELF", "it is a program"),
    (0, b"MThd", "it is a MIDI file, which contains notes and no sound"),
    (0, b"#EXTM3U", "it is a playlist, not the sound itself"),
];

fn marked(head: &[u8], marks: &[(usize, &[u8], &'static str)]) -> Option<&'static str> {
    marks
        .iter()
        .find(|(offset, mark, _)| head.get(*offset..).is_some_and(|rest| rest.starts_with(mark)))
        .map(|(_, _, name)| *name)
}

/// True if packets of 188 bytes begin with the byte 0x47. In files of cameras a time stamp of 4 bytes precedes each packet.
fn is_transport_stream(head: &[u8]) -> bool {
    [(0, 188), (4, 192)]
        .iter()
        .any(|(first, step)| (0..4).all(|packet| head.get(first + packet * step) == Some(&0x47)))
}

pub(super) fn foreign(head: &[u8]) -> Option<Problem> {
    let transport_stream = is_transport_stream(head).then_some("an MPEG transport stream");
    if let Some(what) = transport_stream.or_else(|| marked(head, FOREIGN_MEDIA)) {
        return Some(Problem::UnsupportedFormat(what.into()));
    }
    marked(head, OTHER_FILES).map(|what| Problem::NotAudio(what.into()))
}

/// Checks the header of a WAVE file, whose demuxer would refuse the channels as unsupported.
pub(super) fn over_limit(head: &[u8]) -> Option<Problem> {
    let chunks = chunks(&mut Cursor::new(head));
    let format = chunks.iter().find(|chunk| chunk.id == *b"fmt ")?;
    let body = head.get(usize::try_from(format.body).ok()?..)?;
    let [_, _, c0, c1, r0, r1, r2, r3, ..] = body else { return None };
    check(usize::from(u16::from_le_bytes([*c0, *c1])), u32::from_le_bytes([*r0, *r1, *r2, *r3])).err()
}

pub(super) fn check(channels: usize, rate: u32) -> Result<(), Problem> {
    let over = |what: String, limit: String| Problem::OverLimit { what, limit };
    if channels > usize::from(limits::CHANNELS_MAX) {
        return Err(over(format!("{channels} channels"), format!("{} channels", limits::CHANNELS_MAX)));
    }
    if !(music_limits::SAMPLE_RATE_MIN..=music_limits::SAMPLE_RATE_MAX).contains(&rate) {
        return Err(over(
            format!("a sample rate of {rate} Hz"),
            format!("{} to {} Hz", music_limits::SAMPLE_RATE_MIN, music_limits::SAMPLE_RATE_MAX),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_over_the_limits_are_reported() {
        let mut wave = b"RIFF\x00\x00\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00\x40\x00".to_vec();
        wave.extend_from_slice(&48_000u32.to_le_bytes());
        assert!(over_limit(&wave).unwrap().to_string().contains("64 channels"));
        wave[22] = 2;
        assert!(over_limit(&wave).is_none());
        wave[24..28].fill(0);
        assert!(over_limit(&wave).unwrap().to_string().contains("0 Hz"));
        for end in 0..wave.len() {
            over_limit(&wave[..end]);
        }
    }

    #[test]
    fn marks_are_known() {
        assert!(matches!(foreign(b"\x89PNG\r\n"), Some(Problem::NotAudio(_))));
        assert!(matches!(foreign(b"RIFF....AVI LIST"), Some(Problem::UnsupportedFormat(_))));
        assert!(foreign(b"fLaC").is_none());
        assert!(foreign(b"").is_none());
    }
}
