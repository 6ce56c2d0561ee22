//! Delays, lengths and padding that the demuxers do not report: the edit list, the fragments and the `iTunSMPB` tag of
//! MP4 files, the padding of Matroska files, and the header of Opus. Sources: ISO/IEC 14496-12, 8.2 to 8.8 (boxes, edit
//! list, fragments); RFC 9559, 5.1.3.5 (blocks); RFC 7845, 5.1 (`OpusHead`).

use std::io::{self, BufReader, Read, Seek, SeekFrom};

/// Maximum depth of nested boxes that are read: `moov/trak/mdia/minf/stbl/stts`.
const DEPTH_MAX: usize = 6;

/// Boxes that hold others.
const PARENTS: [[u8; 4]; 9] =
    [*b"moov", *b"trak", *b"edts", *b"mdia", *b"minf", *b"stbl", *b"mvex", *b"moof", *b"traf"];

/// Maximum number of boxes, elements and entries of tables that are examined. A day of fragments of a second has fewer.
const BOXES_MAX: u32 = 1 << 20;

/// Bytes that are read at once. Most boxes are small or skipped.
const READ_BYTES: usize = 1 << 10;

#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct TrackEdit {
    pub(super) track_id: u32,
    /// Ticks per second of the track.
    pub(super) timescale: u32,
    /// The start of the playable part, in ticks of the track.
    pub(super) media_time: u64,
    /// The sum of the lengths of all samples, in ticks of the track.
    pub(super) length: u64,
    /// The length of samples in fragments that state no length.
    default_length: u32,
}

impl TrackEdit {
    /// Converts ticks to frames.
    pub(super) fn frames(&self, ticks: u64, rate: u32) -> u64 {
        let frames = u128::from(ticks) * u128::from(rate) / u128::from(self.timescale.max(1));
        u64::try_from(frames).unwrap_or(0)
    }
}

#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Edits {
    /// The tracks of an MP4 file.
    pub(super) tracks: Vec<TrackEdit>,
    /// True for an MP4 file whose samples are in fragments.
    pub(super) is_fragmented: bool,
    /// The padding at the end of a Matroska file, in nanoseconds.
    pub(super) padding_ns: u64,
}

/// Reads an MP4 or Matroska file, whose first bytes are `head`. Other files have no edits.
pub(super) fn edits(head: &[u8], source: &mut (impl Read + Seek)) -> Edits {
    let end = source.seek(SeekFrom::End(0)).unwrap_or(0);
    let source = BufReader::with_capacity(READ_BYTES, source);
    let mut walk = Walk { source, edits: Edits::default(), fragment: None, boxes: 0 };
    // The edits read before a damaged box stay valid.
    let _ = match head {
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => walk.children(0, end, 0),
        [0x1a, 0x45, 0xdf, 0xa3, ..] => walk.elements(0, end),
        _ => Ok(()),
    };
    walk.edits
}

struct Walk<S> {
    source: BufReader<S>,
    edits: Edits,
    /// The index of the current fragment's track, and the length of samples that state none.
    fragment: Option<(usize, u32)>,
    boxes: u32,
}

impl<S: Read + Seek> Walk<S> {
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
                b"trak" => self.edits.tracks.push(TrackEdit::default()),
                b"mvex" => self.edits.is_fragmented = true,
                b"tkhd" | b"mdhd" => self.header(&kind)?,
                b"elst" => self.edit_list()?,
                b"stts" => self.sample_lengths()?,
                b"trex" => {
                    let [_, id, _, length] = self.words()?;
                    if let Some(edit) = self.edits.tracks.iter_mut().find(|edit| edit.track_id == id) {
                        edit.default_length = length;
                    }
                }
                b"tfhd" => self.fragment_header()?,
                b"trun" => self.run()?,
                _ => {}
            }
            if PARENTS.contains(&kind) && depth < DEPTH_MAX {
                self.children(body, next, depth + 1)?;
            }
            if &kind == b"moov" && !self.edits.is_fragmented {
                return Ok(());
            }
            at = next;
        }
        Ok(())
    }

    /// Adds up the lengths in the table of the track's samples.
    fn sample_lengths(&mut self) -> io::Result<()> {
        let [_, entries] = self.words()?;
        for _ in 0..entries.min(BOXES_MAX) {
            let [count, length] = self.words()?;
            if let Some(edit) = self.edits.tracks.last_mut() {
                edit.length = edit.length.saturating_add(u64::from(count) * u64::from(length));
            }
        }
        Ok(())
    }

    fn fragment_header(&mut self) -> io::Result<()> {
        let [flags, id] = self.words()?;
        let before =
            [(1, 8), (2, 4)].iter().filter(|(flag, _)| flags & flag != 0).map(|(_, size)| size).sum();
        self.source.seek_relative(before)?;
        let own = if flags & 8 != 0 { Some(self.u32()?) } else { None };
        let tracks = self.edits.tracks.iter();
        self.fragment = tracks
            .enumerate()
            .find(|(_, edit)| edit.track_id == id)
            .map(|(index, edit)| (index, own.unwrap_or(edit.default_length)));
        Ok(())
    }

    /// Adds the lengths of a run of samples to its track.
    fn run(&mut self) -> io::Result<()> {
        let [flags, samples] = self.words()?;
        let Some((index, default)) = self.fragment else { return Ok(()) };
        let mut length = u64::from(samples) * u64::from(default);
        if flags & 0x100 != 0 {
            let words = |flags: u32| i64::from(flags.count_ones()) * 4;
            self.source.seek_relative(words(flags & 5))?;
            length = 0;
            for _ in 0..samples.min(BOXES_MAX) {
                length += u64::from(self.u32()?);
                self.source.seek_relative(words(flags & 0xe00))?;
            }
        }
        if let Some(edit) = self.edits.tracks.get_mut(index) {
            edit.length = edit.length.saturating_add(length);
        }
        Ok(())
    }

    /// Reads the elements of a Matroska file. Only the last cluster can have padding at the end.
    fn elements(&mut self, mut at: u64, mut end: u64) -> io::Result<()> {
        const SEGMENT: u64 = 0x1853_8067;
        const CLUSTER: u64 = 0x1f43_b675;
        const SIMPLE_BLOCK: u64 = 0xa3;
        const BLOCK_GROUP: u64 = 0xa0;
        const DISCARD_PADDING: u64 = 0x75a2;
        let mut last = None;
        while self.boxes < BOXES_MAX {
            if at >= end {
                // After the segment, descend into its last cluster.
                let Some((body, next)) = last.take() else { break };
                (at, end) = (body, next);
            }
            self.boxes += 1;
            self.source.seek(SeekFrom::Start(at))?;
            let Some((id, id_bytes)) = self.variable(false)? else { break };
            let Some((size, size_bytes)) = self.variable(true)? else { break };
            let body = at + id_bytes + size_bytes;
            let is_open = size == (1 << (7 * size_bytes)) - 1;
            let next = body.saturating_add(size);
            match id {
                CLUSTER if !is_open => (last, at) = (Some((body, next.min(end))), next),
                BLOCK_GROUP | SEGMENT | CLUSTER => (self.edits.padding_ns, at) = (0, body),
                DISCARD_PADDING if size <= 8 => {
                    let mut bytes = vec![0; size as usize];
                    self.source.read_exact(&mut bytes)?;
                    // A negative number cuts the start of a block.
                    let is_negative = bytes.first().is_some_and(|byte| byte & 0x80 != 0);
                    let value = bytes.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
                    (self.edits.padding_ns, at) = (if is_negative { 0 } else { value }, next);
                }
                SIMPLE_BLOCK => (self.edits.padding_ns, at) = (0, next),
                _ => at = next,
            }
        }
        Ok(())
    }

    /// Reads a number of variable length, and its number of bytes; `None` for an invalid number.
    fn variable(&mut self, without_mark: bool) -> io::Result<Option<(u64, u64)>> {
        let mut byte = [0];
        self.source.read_exact(&mut byte)?;
        let zeros = byte[0].leading_zeros();
        if zeros > 7 {
            return Ok(None);
        }
        let first = if without_mark { u32::from(byte[0]) & (0x7f >> zeros) } else { u32::from(byte[0]) };
        let mut value = u64::from(first);
        for _ in 0..zeros {
            self.source.read_exact(&mut byte)?;
            value = value << 8 | u64::from(byte[0]);
        }
        Ok(Some((value, u64::from(zeros) + 1)))
    }

    /// Reads the track's number (`tkhd`) or its time scale (`mdhd`). Both fields follow two dates.
    fn header(&mut self, kind: &[u8; 4]) -> io::Result<()> {
        let version = self.u32()? >> 24;
        self.source.seek_relative(if version == 1 { 16 } else { 8 })?;
        let value = self.u32()?;
        if let Some(edit) = self.edits.tracks.last_mut() {
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
            if let (Ok(time), Some(edit)) = (u64::try_from(media_time), self.edits.tracks.last_mut()) {
                edit.media_time = time;
                break;
            }
        }
        Ok(())
    }

    fn words<const COUNT: usize>(&mut self) -> io::Result<[u32; COUNT]> {
        let mut words = [0; COUNT];
        for word in &mut words {
            *word = self.u32()?;
        }
        Ok(words)
    }

    fn u32(&mut self) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.source.read_exact(&mut bytes)?;
        Ok(u32::from_be_bytes(bytes))
    }

    fn u64(&mut self) -> io::Result<u64> {
        let [high, low] = self.words()?;
        Ok(u64::from(high) << 32 | u64::from(low))
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

/// The number of frames at 48 kHz to drop at the start, and the factor for all samples, from an `OpusHead` packet.
pub(super) fn opus_head(head: &[u8]) -> Option<(u64, f32)> {
    let [_version, _channels, skip_low, skip_high, _, _, _, _, gain_low, gain_high, ..] =
        head.strip_prefix(b"OpusHead")?
    else {
        return None;
    };
    let decibels = f32::from(i16::from_le_bytes([*gain_low, *gain_high])) / 256.0;
    Some((u64::from(u16::from_le_bytes([*skip_low, *skip_high])), 10_f32.powf(decibels / 20.0)))
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

    fn read(file: &[u8]) -> Edits {
        edits(file, &mut Cursor::new(file))
    }

    #[test]
    fn an_edit_list_is_found_behind_an_empty_edit() {
        let elst = boxed(b"elst", &words(&[0, 2, 40, u32::MAX, 0x1_0000, 960, 1024, 0x1_0000]));
        let mdhd = boxed(b"mdhd", &words(&[0, 0, 0, 44_100, 0, 0]));
        let trak =
            [boxed(b"tkhd", &words(&[0, 0, 0, 7, 0])), boxed(b"edts", &elst), boxed(b"mdia", &mdhd)].concat();
        let file = [boxed(b"ftyp", b"M4A "), boxed(b"moov", &boxed(b"trak", &trak)), boxed(b"mdat", &[0; 9])]
            .concat();
        let wanted = TrackEdit { track_id: 7, timescale: 44_100, media_time: 1024, ..TrackEdit::default() };
        assert_eq!(read(&file), Edits { tracks: vec![wanted], ..Edits::default() });
        for end in 0..file.len() {
            read(&file[..end]);
        }
        assert_eq!(read(b"no boxes here at all"), Edits::default());
    }

    #[test]
    fn fragments_are_added_up() {
        let tkhd = boxed(b"tkhd", &words(&[0, 0, 0, 7, 0]));
        let moov = [boxed(b"trak", &tkhd), boxed(b"mvex", &boxed(b"trex", &words(&[0, 7, 1, 1024, 0, 0])))];
        let fragment = |tfhd: &[u32], trun: &[u32]| {
            boxed(
                b"moof",
                &boxed(b"traf", &[boxed(b"tfhd", &words(tfhd)), boxed(b"trun", &words(trun))].concat()),
            )
        };
        let file = [
            boxed(b"ftyp", b"M4A "),
            boxed(b"moov", &moov.concat()),
            fragment(&[0, 7], &[0, 3]),
            boxed(b"mdat", &[0; 9]),
            fragment(&[8, 7, 100], &[0x1, 2, 0]),
            fragment(&[0, 7], &[0x301, 2, 0, 10, 5, 20, 5]),
            fragment(&[0, 8], &[0, 50]),
        ]
        .concat();
        let edits = read(&file);
        assert!(edits.is_fragmented);
        assert_eq!(edits.tracks[0].length, 3 * 1024 + 200 + 30);
        for end in 0..file.len() {
            read(&file[..end]);
        }
    }

    #[test]
    fn the_padding_of_the_last_block_is_found() {
        let cluster = |padding: &[u8]| {
            let group =
                [&[0xa0, 0x80 | (padding.len() as u8 + 6)][..], b"\xa1\x81x", b"\x75\xa2\x82", padding]
                    .concat();
            [&[0x1f, 0x43, 0xb6, 0x75, 0x80 | group.len() as u8][..], &group].concat()
        };
        let file =
            |cluster: &[u8]| [b"\x1a\x45\xdf\xa3\x80\x18\x53\x80\x67\xff".as_slice(), cluster].concat();
        let (long, short) = (cluster(&[2, 1]), cluster(&[0, 3]));
        assert_eq!(read(&file(&[long.clone(), short].concat())).padding_ns, 3);
        assert_eq!(read(&file(&[long.clone(), cluster(&[0xff, 0])].concat())).padding_ns, 0);
        for end in 0..file(&long).len() {
            read(&file(&long)[..end]);
        }
    }

    #[test]
    fn tags_and_heads_are_read() {
        let tag = " 00000000 00000840 000001CA 00000000003F31F6 00000000 00000000";
        assert_eq!(parse_itun_smpb(tag), Some((0x840, 0x3F_31F6)));
        assert_eq!(parse_itun_smpb("00000000 00000840"), None);
        assert_eq!(parse_itun_smpb("x y z w"), None);
        assert_eq!(opus_head(b"OpusHead\x01\x02\x38\x01rate\0\xec\0"), Some((312, 0.1)));
        assert_eq!(opus_head(b"OpusHead"), None);
    }
}
