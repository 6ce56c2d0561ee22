//! Corrects the sizes in the headers of WAVE and AIFF files. Recorders that lost their power and programs that write to
//! a pipe leave sizes of 0, or sizes that are too small or too large. The sound then lasts until the end of the file.

use std::io::{self, Read, Seek, SeekFrom};

use symphonia::core::io::MediaSource;

/// Maximum number of chunks that are examined before the sound.
const CHUNKS_MAX: usize = 4096;

/// A chunk of a WAVE or AIFF file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chunk {
    pub(super) id: [u8; 4],
    /// The position of the body.
    pub(super) body: u64,
    pub(super) size: u32,
}

/// Returns the chunks of a WAVE or AIFF file; none for other files, and none after a size beyond the end.
pub(super) fn chunks(source: &mut (impl Read + Seek)) -> Vec<Chunk> {
    let Ok(Some(form)) = Form::of(source) else { return Vec::new() };
    let mut found = Vec::new();
    let mut at = 12;
    while found.len() < CHUNKS_MAX
        && let Ok((id, size)) = form.header(source, at)
    {
        found.push(Chunk { id, body: at + 8, size });
        at += 8 + u64::from(size) + u64::from(size & 1);
    }
    found
}

struct Form {
    sound: [u8; 4],
    is_little_endian: bool,
}

impl Form {
    fn of(source: &mut (impl Read + Seek)) -> io::Result<Option<Self>> {
        let mut head = [0; 12];
        source.seek(SeekFrom::Start(0))?;
        source.read_exact(&mut head)?;
        Ok(match (head.first_chunk(), head.last_chunk()) {
            (Some(b"RIFF"), Some(b"WAVE")) => Some(Self { sound: *b"data", is_little_endian: true }),
            (Some(b"FORM"), Some(b"AIFF" | b"AIFC")) => {
                Some(Self { sound: *b"SSND", is_little_endian: false })
            }
            _ => None,
        })
    }

    fn header(&self, source: &mut (impl Read + Seek), at: u64) -> io::Result<([u8; 4], u32)> {
        let (mut id, mut size) = ([0; 4], [0; 4]);
        source.seek(SeekFrom::Start(at))?;
        source.read_exact(&mut id)?;
        source.read_exact(&mut size)?;
        Ok((id, if self.is_little_endian { u32::from_le_bytes(size) } else { u32::from_be_bytes(size) }))
    }

    fn bytes(&self, size: u64) -> [u8; 4] {
        // The largest size means an unknown size.
        let size = u32::try_from(size).unwrap_or(u32::MAX);
        if self.is_little_endian { size.to_le_bytes() } else { size.to_be_bytes() }
    }
}

/// A source with other bytes in some places.
pub(super) struct Mended {
    source: Box<dyn MediaSource>,
    at: u64,
    patches: Vec<(u64, [u8; 4])>,
}

impl Mended {
    /// Starts at the source's first byte. Sources other than WAVE and AIFF files are unchanged.
    pub(super) fn new(mut source: Box<dyn MediaSource>) -> io::Result<Self> {
        let end = source.seek(SeekFrom::End(0))?;
        let mut patches = Vec::new();
        if let Ok(Some(form)) = Form::of(&mut source)
            && let Some(sound) = chunks(&mut source).iter().find(|chunk| chunk.id == form.sound)
        {
            let rest = end.saturating_sub(sound.body);
            let size = if sound.size == 0 { rest } else { u64::from(sound.size).min(rest) };
            if size != u64::from(sound.size) {
                patches.push((sound.body - 4, form.bytes(size)));
            }
            let whole = form.header(&mut source, 0).map_or(0, |(_, size)| u64::from(size) + 8);
            if whole < sound.body + size || whole > end {
                patches.push((4, form.bytes(end - 8)));
            }
        }
        source.seek(SeekFrom::Start(0))?;
        Ok(Self { source, at: 0, patches })
    }
}

impl Read for Mended {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        for (at, bytes) in &self.patches {
            for (position, byte) in (*at..).zip(bytes) {
                let place = position.checked_sub(self.at).and_then(|place| usize::try_from(place).ok());
                if let Some(target) = place.and_then(|place| buffer.get_mut(..count)?.get_mut(place)) {
                    *target = *byte;
                }
            }
        }
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Mended {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.source.seek(to)?;
        Ok(self.at)
    }
}

impl MediaSource for Mended {
    fn is_seekable(&self) -> bool {
        self.source.is_seekable()
    }

    fn byte_len(&self) -> Option<u64> {
        self.source.byte_len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn wave(riff: u32, data: u32) -> Vec<u8> {
        let mut bytes = [b"RIFF".as_slice(), &riff.to_le_bytes(), b"WAVEJUNK\x01\0\0\0x\0data"].concat();
        bytes.extend(data.to_le_bytes());
        bytes.extend([7; 10]);
        bytes
    }

    #[test]
    fn sizes_of_sound_that_was_not_finished_are_corrected() {
        let right = wave(32, 10);
        for (riff, data) in [(32, 10), (0, 10), (20, 10), (32, 0), (32, 900), (0, 0), (u32::MAX, u32::MAX)] {
            let mut mended = Mended::new(Box::new(Cursor::new(wave(riff, data)))).unwrap();
            let mut bytes = vec![0; 7];
            mended.read_exact(&mut bytes).unwrap();
            mended.read_to_end(&mut bytes).unwrap();
            assert_eq!(bytes, right, "{riff} {data}");
        }
        let mut other = Mended::new(Box::new(Cursor::new(b"RIFF....AVI "))).unwrap();
        let mut bytes = Vec::new();
        other.read_to_end(&mut bytes).unwrap();
        assert_eq!(bytes, b"RIFF....AVI ");
    }
}
