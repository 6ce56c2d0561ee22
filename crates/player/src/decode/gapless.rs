//! Encoder delays that the demuxers do not report: the edit list and the `iTunSMPB` tag of MP4 files, and the header
//! of Opus. Sources: ISO/IEC 14496-12, 8.2 to 8.6 (boxes, edit list); RFC 7845, 5.1 (`OpusHead`).

use std::io::{self, Read, Seek, SeekFrom};

/// Maximum depth of nested boxes that are read: `moov/trak/edts/elst` and `moov/trak/mdia/mdhd`.
const DEPTH_MAX: usize = 4;

const BOXES_MAX: usize = 4096;

#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct TrackEdit {
    pub(super) track_id: u32,
    /// Ticks per second of the track.
    pub(super) timescale: u32,
    /// The start of the playable part, in ticks of the track.
    pub(super) media_time: u64,
}

/// Returns the edits of all tracks of an MP4 file, and true if the file is fragmented. Other files have no edits.
pub(super) fn track_edits(source: &mut (impl Read + Seek)) -> (Vec<TrackEdit>, bool) {
    let mut walk = Walk { source, edits: Vec::new(), fragmented: false, boxes: 0 };
    let end = walk.source.seek(SeekFrom::End(0)).unwrap_or(0);
    // The edits read before a damaged box stay valid.
    let _ = walk.children(0, end, 0);
    (walk.edits, walk.fragmented)
}

struct Walk<'a, S> {
    source: &'a mut S,
    edits: Vec<TrackEdit>,
    fragmented: bool,
    boxes: usize,
}

impl<S: Read + Seek> Walk<'_, S> {
    fn children(&mut self, mut at: u64, end: u64, depth: usize) -> io::Result<()> {
        while at.saturating_add(8) <= end && self.boxes < BOXES_MAX {
            self.boxes += 1;
            self.source.seek(SeekFrom::Start(at))?;
            let short = u64::from(self.u32()?);
            let mut kind = [0; 4];
            self.source.read_exact(&mut kind)?;
            let (header, size) = match short {
                0 => (8, end - at),
                1 => (16, self.u64()?),
                _ => (8, short),
            };
            let next = at.saturating_add(size);
            if size < header || next > end {
                return Ok(());
            }
            let body = at + header;
            match &kind {
                b"moov" | b"edts" | b"mdia" if depth < DEPTH_MAX => self.children(body, next, depth + 1)?,
                b"trak" if depth < DEPTH_MAX => {
                    self.edits.push(TrackEdit::default());
                    self.children(body, next, depth + 1)?;
                }
                b"mvex" => self.fragmented = true,
                b"tkhd" | b"mdhd" => self.header(&kind)?,
                b"elst" => self.edit_list()?,
                _ => {}
            }
            if &kind == b"moov" {
                return Ok(());
            }
            at = next;
        }
        Ok(())
    }

    /// Reads the track's number (`tkhd`) or its time scale (`mdhd`). Both fields follow two dates.
    fn header(&mut self, kind: &[u8; 4]) -> io::Result<()> {
        let version = self.u32()? >> 24;
        self.source.seek(SeekFrom::Current(if version == 1 { 16 } else { 8 }))?;
        let value = self.u32()?;
        if let Some(edit) = self.edits.last_mut() {
            if kind == b"tkhd" {
                edit.track_id = value;
            } else {
                edit.timescale = value;
            }
        }
        Ok(())
    }

    /// Reads the start of the sound from the first edit that is not empty. (An empty edit has the media time -1.)
    fn edit_list(&mut self) -> io::Result<()> {
        let version = self.u32()? >> 24;
        let entries = self.u32()?.min(16);
        for _ in 0..entries {
            let media_time = if version == 1 {
                self.u64()?;
                self.u64()? as i64
            } else {
                self.u32()?;
                i64::from(self.u32()? as i32)
            };
            self.u32()?;
            if let (Ok(time), Some(edit)) = (u64::try_from(media_time), self.edits.last_mut()) {
                edit.media_time = time;
                break;
            }
        }
        Ok(())
    }

    fn u32(&mut self) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.source.read_exact(&mut bytes)?;
        Ok(u32::from_be_bytes(bytes))
    }

    fn u64(&mut self) -> io::Result<u64> {
        let mut bytes = [0; 8];
        self.source.read_exact(&mut bytes)?;
        Ok(u64::from_be_bytes(bytes))
    }
}

/// Parses the delay and the number of playable frames from an `iTunSMPB` tag. The tag consists of hexadecimal words:
/// the second word is the delay, the third is the padding and the fourth is the length.
pub(super) fn parse_itun_smpb(text: &str) -> Option<(u64, u64)> {
    let mut words = text.split_whitespace().skip(1).map(|word| u64::from_str_radix(word, 16).ok());
    let delay = words.next()??;
    let _padding = words.next()??;
    let length = words.next()??;
    (length > 0).then_some((delay, length))
}

/// The number of frames at 48 kHz to drop at the start, from an `OpusHead` packet.
pub(super) fn opus_pre_skip(head: &[u8]) -> Option<u64> {
    match head {
        [b'O', b'p', b'u', b's', b'H', b'e', b'a', b'd', _version, _channels, low, high, ..] => {
            Some(u64::from(u16::from_le_bytes([*low, *high])))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn boxed(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
        let mut bytes = (body.len() as u32 + 8).to_be_bytes().to_vec();
        bytes.extend_from_slice(kind);
        bytes.extend_from_slice(body);
        bytes
    }

    fn words(values: &[u32]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_be_bytes()).collect()
    }

    #[test]
    fn an_edit_list_is_found_behind_an_empty_edit() {
        let elst = boxed(b"elst", &words(&[0, 2, 40, u32::MAX, 0x1_0000, 960, 1024, 0x1_0000]));
        let mdhd = boxed(b"mdhd", &words(&[0, 0, 0, 44_100, 0, 0]));
        let trak =
            [boxed(b"tkhd", &words(&[0, 0, 0, 7, 0])), boxed(b"edts", &elst), boxed(b"mdia", &mdhd)].concat();
        let file = [boxed(b"ftyp", b"M4A "), boxed(b"moov", &boxed(b"trak", &trak)), boxed(b"mdat", &[0; 9])]
            .concat();
        let wanted = TrackEdit { track_id: 7, timescale: 44_100, media_time: 1024 };
        assert_eq!(track_edits(&mut Cursor::new(&file)), (vec![wanted], false));
        for end in 0..file.len() {
            track_edits(&mut Cursor::new(&file[..end]));
        }
        assert_eq!(track_edits(&mut Cursor::new(b"no boxes here at all")), (vec![], false));
    }

    #[test]
    fn tags_and_heads_are_read() {
        let tag = " 00000000 00000840 000001CA 00000000003F31F6 00000000 00000000";
        assert_eq!(parse_itun_smpb(tag), Some((0x840, 0x3F_31F6)));
        assert_eq!(parse_itun_smpb("00000000 00000840"), None);
        assert_eq!(parse_itun_smpb("x y z w"), None);
        assert_eq!(opus_pre_skip(b"OpusHead\x01\x02\x38\x01rest"), Some(312));
        assert_eq!(opus_pre_skip(b"OpusHead"), None);
    }
}
