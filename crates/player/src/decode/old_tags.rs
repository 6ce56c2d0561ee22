//! Titles, artists and lyrics in tags with text of unknown encoding: ID3v2.2 to 2.4, and `INFO` lists of WAVE files.
//!
//! Old taggers wrote the system's encoding where the specification wants Latin-1, and UTF-16 without a mark. The demuxers
//! replace such bytes, so this module reads the tags from the file. Source: id3.org, "ID3 tag version 2.4.0", "2.3.0" and
//! "2.2.0".

use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};

use encoding_rs::{Encoding, UTF_8, UTF_16BE};

use super::mended::chunks;
use crate::encoding::{encoding_of, utf16_encoding_of};
use crate::limits;

/// Maximum size of a tag that is undone from unsynchronisation, in bytes.
const UNSYNCHRONISED_MAX: u64 = 1 << 20;

/// The fields of a tag. Text in no stated encoding is decoded in one encoding for the whole tag.
#[derive(Debug, Default)]
pub(super) struct OldTags {
    pub(super) title: Option<String>,
    pub(super) artist: Option<String>,
    pub(super) lyrics: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Field {
    Title,
    Artist,
    Lyrics,
}

/// A text as stored, with its encoding if the file states the right encoding.
type Stored = (Field, Vec<u8>, Option<&'static Encoding>);

/// Reads the tags. Errors end the reading; the fields read before them are valid.
pub(super) fn read(source: &mut (impl Read + Seek)) -> OldTags {
    let mut stored = Vec::new();
    let _ = id3v2(source, &mut stored);
    if stored.is_empty() {
        let _ = info_list(source, &mut stored);
    }
    let unknown = stored.iter().filter(|(_, _, encoding)| encoding.is_none());
    let guess =
        encoding_of(&unknown.map(|(_, bytes, _)| bytes.as_slice()).collect::<Vec<_>>().join(&b"\n"[..]));
    let mut tags = OldTags::default();
    for (field, bytes, encoding) in stored {
        let (text, _, _) = encoding.unwrap_or(guess).decode(&bytes);
        // A tag may hold several texts, which are separated by zeros.
        let text = text.trim_start_matches('\0').split('\0').next().unwrap_or_default().trim_end();
        let slot = match field {
            Field::Title => &mut tags.title,
            Field::Artist => &mut tags.artist,
            Field::Lyrics => &mut tags.lyrics,
        };
        if slot.is_none() && !text.is_empty() {
            *slot = Some(text.to_owned());
        }
    }
    tags
}

fn id3v2(source: &mut (impl Read + Seek), stored: &mut Vec<Stored>) -> io::Result<()> {
    let mut head = [0; 10];
    source.seek(SeekFrom::Start(0))?;
    source.read_exact(&mut head)?;
    let [b'I', b'D', b'3', version @ 2..=4, _, flags, a, b, c, d] = head else { return Ok(()) };
    let tag = source.take(u64::from(seven_bits([a, b, c, d])));
    // From version 2.4 on, each frame is unsynchronised for itself.
    if flags & 0x80 != 0 && version < 4 {
        let mut bytes = Vec::new();
        tag.take(UNSYNCHRONISED_MAX).read_to_end(&mut bytes)?;
        frames(&mut Cursor::new(synchronised(&bytes)), version, flags, stored)
    } else {
        frames(&mut BufReader::new(tag), version, flags, stored)
    }
}

fn frames(tag: &mut impl BufRead, version: u8, flags: u8, stored: &mut Vec<Stored>) -> io::Result<()> {
    if flags & 0x40 != 0 && version > 2 {
        let size = word(tag, 4)?;
        // Version 2.4 counts the four bytes of the size.
        let rest = if version == 4 { seven_bits(size).saturating_sub(4) } else { u32::from_be_bytes(size) };
        skip(tag, rest.into())?;
    }
    loop {
        let (id, size, flags) = match version {
            2 => (word(tag, 3)?, u32::from_be_bytes(word(tag, 3)?) >> 8, 0),
            _ => {
                let (id, size, [_, flags, ..]) = (word(tag, 4)?, word(tag, 4)?, word(tag, 2)?);
                let size = if version == 3 { u32::from_be_bytes(size) } else { seven_bits(size) };
                (id, size, flags)
            }
        };
        let field = match &id {
            b"TIT2" | b"TT2\0" => Field::Title,
            b"TPE1" | b"TP1\0" => Field::Artist,
            b"USLT" | b"ULT\0" => Field::Lyrics,
            [0, ..] => return Ok(()),
            _ => {
                skip(tag, size.into())?;
                continue;
            }
        };
        let mut body = Vec::new();
        let size = u64::from(size);
        tag.take(size.min(limits::LYRICS_BYTES_MAX)).read_to_end(&mut body)?;
        skip(tag, size.saturating_sub(limits::LYRICS_BYTES_MAX))?;
        // Compressed, encrypted and grouped frames are left to the demuxer.
        let (packed, is_unsynchronised) = if version == 4 { (0x4c, flags & 2 != 0) } else { (0xe0, false) };
        if is_unsynchronised {
            body = synchronised(&body);
        }
        // In version 2.4 a length may precede the text.
        let text = if version == 4 && flags & 1 != 0 { body.get(4..) } else { Some(&body[..]) };
        if flags & packed == 0 {
            stored.extend(text.and_then(|text| text_of(field, text)));
        }
    }
}

fn text_of(field: Field, body: &[u8]) -> Option<Stored> {
    let (&encoding, mut text) = body.split_first()?;
    let wide = matches!(encoding, 1 | 2);
    if field == Field::Lyrics {
        // A language of three letters and a description precede the lyrics.
        text = text.get(3..)?;
        let unit = if wide { 2 } else { 1 };
        let end = text.chunks(unit).position(|unit| unit.iter().all(|byte| *byte == 0))?;
        text = text.get((end + 1) * unit..)?;
    }
    let stated = match encoding {
        1 => Some(utf16_encoding_of(text)),
        2 => Some(UTF_16BE),
        3 if std::str::from_utf8(text).is_ok() => Some(UTF_8),
        _ => None,
    };
    Some((field, text.to_vec(), stated))
}

fn info_list(source: &mut (impl Read + Seek), stored: &mut Vec<Stored>) -> io::Result<()> {
    for list in chunks(source).iter().filter(|chunk| chunk.id == *b"LIST") {
        let mut bytes = Vec::new();
        source.seek(SeekFrom::Start(list.body))?;
        source.by_ref().take(limits::LYRICS_BYTES_MAX.min(list.size.into())).read_to_end(&mut bytes)?;
        let mut rest = bytes.strip_prefix(b"INFO").unwrap_or_default();
        while let Some((id, after)) = rest.split_first_chunk::<4>()
            && let Some((size, after)) = after.split_first_chunk::<4>()
        {
            let size = u32::from_le_bytes(*size) as usize;
            let text = after.get(..size).unwrap_or(after);
            // The demuxer reads UTF-8.
            let is_old = std::str::from_utf8(text).is_err();
            match id {
                b"INAM" if is_old => stored.push((Field::Title, text.to_vec(), None)),
                b"IART" if is_old => stored.push((Field::Artist, text.to_vec(), None)),
                _ => {}
            }
            rest = after.get(size.saturating_add(size & 1)..).unwrap_or_default();
        }
    }
    Ok(())
}

/// Removes the zeros that unsynchronisation has inserted after bytes of 255.
fn synchronised(bytes: &[u8]) -> Vec<u8> {
    let mut before = 0;
    let is_kept = |byte: &u8| !(std::mem::replace(&mut before, *byte) == 0xff && *byte == 0);
    bytes.iter().copied().filter(is_kept).collect()
}

/// Reads `count` bytes, and returns them with zeros after them.
fn word(tag: &mut impl Read, count: usize) -> io::Result<[u8; 4]> {
    let mut bytes = [0; 4];
    tag.read_exact(bytes.get_mut(..count).unwrap_or_default())?;
    Ok(bytes)
}

fn skip(tag: &mut impl BufRead, count: u64) -> io::Result<()> {
    io::copy(&mut tag.take(count), &mut io::sink()).map(|_| ())
}

fn seven_bits(bytes: [u8; 4]) -> u32 {
    bytes.iter().fold(0, |sum, byte| sum << 7 | u32::from(byte & 0x7f))
}

#[cfg(test)]
mod tests {
    use super::*;
    use encoding_rs::{GBK, SHIFT_JIS, WINDOWS_1251, WINDOWS_1252};
    use proptest::prelude::*;

    fn tag(version: u8, flags: u8, frames: &[u8]) -> Vec<u8> {
        let size = frames.len() as u32;
        let size = [size >> 21, size >> 14, size >> 7, size].map(|part| (part & 0x7f) as u8);
        [b"ID3".as_slice(), &[version, 0, flags], &size, frames].concat()
    }

    fn frame(id: &str, flags: u8, body: &[u8]) -> Vec<u8> {
        [id.as_bytes(), &(body.len() as u32).to_be_bytes(), &[0, flags], body].concat()
    }

    fn of(file: &[u8]) -> OldTags {
        read(&mut Cursor::new(file))
    }

    #[test]
    fn titles_in_the_encodings_of_old_taggers_are_readable() {
        for (encoding, title) in [
            (WINDOWS_1251, "Тест песня"),
            (WINDOWS_1251, "Я"),
            (GBK, "测试歌曲"),
            (SHIFT_JIS, "テストの歌"),
            (UTF_8, "Größe über Café"),
            (WINDOWS_1252, "Größe über Café"),
            (WINDOWS_1252, "Plain"),
        ] {
            let body = [b"\0".as_slice(), &encoding.encode(title).0].concat();
            // The artist helps to guess the encoding of a short title.
            let artist = [b"\0".as_slice(), &encoding.encode("Группа крови").0].concat();
            let artist = if encoding == WINDOWS_1251 { frame("TPE1", 0, &artist) } else { Vec::new() };
            let file = tag(3, 0, &[frame("TIT2", 0, &body), artist].concat());
            assert_eq!(of(&file).title.as_deref(), Some(title), "{}", encoding.name());
        }
        let wide: Vec<u8> = "Größe".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let body = [b"\x01".as_slice(), &wide].concat();
        assert_eq!(of(&tag(3, 0, &frame("TIT2", 0, &body))).title.as_deref(), Some("Größe"));
    }

    #[test]
    fn every_version_of_a_tag_is_read() {
        let second = tag(2, 0, b"TT2\0\0\x04\0One\0\0\0\0");
        let fourth = [
            frame("APIC", 0, &[9; 100]),
            frame("TIT2", 1, b"\0\0\0\x04\x03One"),
            frame("TPE1", 2, b"\x01\xff\0\xfeT\0w\0o\0\0\0X\0"),
            frame("TPE1", 8, b"packed"),
        ];
        let third = [frame("TIT2", 0, b"\0One\0"), frame("USLT", 0, b"\0eng\0[00:01]la")].concat();
        for file in [second, tag(4, 0, &fourth.concat()), tag(3, 0, &third), tag(3, 0x80, &third)] {
            assert_eq!(of(&file).title.as_deref(), Some("One"));
            for end in 0..file.len() {
                of(&file[..end]);
            }
        }
        assert_eq!(of(&tag(4, 0, &fourth.concat())).artist.as_deref(), Some("Two"));
        assert_eq!(of(&tag(3, 0, &third)).lyrics.as_deref(), Some("[00:01]la"));
        // Unsynchronisation has inserted a zero after a letter of cp1251.
        let letters = tag(3, 0x80, &frame("TIT2", 0, b"\0\xcf\xe5\xf1\xed\xff\0\xe5"));
        assert_eq!(of(&letters).title.as_deref(), Some("Песняе"));
    }

    #[test]
    fn an_info_list_of_a_wave_file_is_decoded() {
        let list = b"LIST\x12\0\0\0INFOINAM\x06\0\0\0Gr\xf6\xdfe\0";
        let file = [b"RIFF\0\0\0\0WAVEdata\x02\0\0\0xx".as_slice(), list].concat();
        assert_eq!(of(&file).title.as_deref(), Some("Größe"));
    }

    proptest! {
        #[test]
        fn no_tag_panics(version in 2_u8..5, flags: u8, frames in prop::collection::vec(any::<u8>(), 0..200)) {
            of(&tag(version, flags, &[b"TIT2\0\0\0\x05\0\0\0abcd".as_slice(), &frames].concat()));
            of(&[b"RIFF\0\0\0\0WAVELIST\x20\0\0\0INFO".as_slice(), &frames].concat());
        }
    }
}
