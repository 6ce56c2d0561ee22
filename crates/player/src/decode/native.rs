//! Decoding of common formats with symphonia and libopus.
//!
//! - Containers: WAV, AIFF, FLAC, MP3, Ogg, MP4, CAF, Matroska/WebM, ADTS. Codecs: PCM (integer and float), ADPCM,
//!   FLAC, ALAC, MP1-3, Vorbis, Opus (mono and stereo), AAC-LC.
//! - Encoder delay and padding are cut off if the file reports them, so frame 0 is the encoder's first input frame.
//! - A seek is exact to the frame. If the container cannot seek, or its clock is too coarse, the file is decoded again
//!   from its start. After a seek, lossy codecs decode half a second before the target first. So the samples are the
//!   same as without the seek (except for AAC's random substituted noise).
//! - Damaged packets are skipped. Silence of the same length replaces them, so that later sound stays in
//!   time.
//! - Chained streams (Ogg) play in succession, resampled to the first rate.
//! - No buffer is sized by a number from the file. A panic in a codec library becomes an error.

use crate::limits;
use crate::resample::Resampler;
use mariana_music::StereoFrame;

use super::input::MediaInput;
use super::packets::{Block, PacketReader};
use super::{Problem, StreamInfo, sniff};

/// Gaps are filled with at most this many seconds of silence until the next seek. More would mean a broken clock.
const HOLE_SECONDS_MAX: i64 = 10;

const NEAR_SECONDS: i64 = 1;

pub(super) struct NativeDecoder {
    pub(super) input: MediaInput,
    reader: PacketReader,
    pub(super) info: StreamInfo,
    /// Number of raw frames before the first audible frame.
    delay: i64,
    /// The number of audible frames, if the container states it exactly.
    length: Option<i64>,
    raw: RawPlace,
    /// Frames before this frame are dropped.
    from: i64,
    /// Frames to drop at the start of a chained stream.
    drop_next: usize,
    pending: Vec<StereoFrame>,
    position: i64,
    /// Converts chained streams to the first stream's rate.
    resampler: Resampler,
    /// True once the rate has changed or a chained stream has begun. The container's clock is meaningless from then on.
    uneven: bool,
    ended: bool,
    scratch: Vec<StereoFrame>,
}

/// The decoder's position in raw frames, since the start or the last jump.
struct RawPlace {
    /// The next raw frame, which is unknown until the first packet is decoded.
    next: i64,
    settled: bool,
    at_start: bool,
    filled: i64,
}

impl RawPlace {
    const START: Self = Self { next: 0, settled: false, at_start: true, filled: 0 };
}

impl NativeDecoder {
    /// Opens the audio track with this index, or the first track that can be decoded.
    pub(super) fn open(input: MediaInput, track: Option<usize>) -> Result<Self, Problem> {
        let mut reader = PacketReader::open(&input, track)?;
        let mut first = Vec::new();
        let Some(block) = reader.next(&mut first)? else {
            return Err(Problem::Damaged("no sound in it could be decoded".into()));
        };
        let rate = block.rate;
        sniff::check(reader.channels(), rate)?;
        let (length, duration) = reader.length(rate);
        let tags = reader.tags();
        let mut decoder = Self {
            info: StreamInfo {
                name: input.name.clone(),
                demuxer: reader.demuxer()?,
                sample_rate: rate,
                source_channels: reader.channels(),
                duration,
                title: tags.title,
                artist: tags.artist,
                lyrics: tags.lyrics,
                scene_gain: tags.loudness.scene_gain(),
            },
            delay: i64::try_from(reader.delay(rate)).unwrap_or(i64::MAX / 4),
            length: length.and_then(|frames| i64::try_from(frames).ok()),
            input,
            reader,
            raw: RawPlace::START,
            from: 0,
            drop_next: 0,
            pending: Vec::new(),
            position: 0,
            resampler: Resampler::passing(rate),
            uneven: false,
            ended: false,
            scratch: first,
        };
        decoder.append(block)?;
        Ok(decoder)
    }

    pub(super) fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, Problem> {
        self.fill()?;
        let frames = self.pending.len();
        out.append(&mut self.pending);
        self.position += frames as i64;
        Ok(frames)
    }

    pub(super) fn seek(&mut self, seconds: f64) -> Result<f64, Problem> {
        let rate = f64::from(self.info.sample_rate);
        // The conversion saturates and maps NaN to 0. A quarter of the range leaves room for sums.
        let target = ((seconds * rate).round() as i64).clamp(0, i64::MAX / 4);
        let near = i64::from(self.info.sample_rate) * NEAR_SECONDS;
        let ahead = !self.ended && (self.position..self.position + near).contains(&target);
        if ahead {
            let skip = usize::try_from(target - self.position).unwrap_or(0).min(self.pending.len());
            self.pending.drain(..skip);
            self.position += skip as i64;
            self.from = target;
            self.fill()?;
        } else if !self.jump(target)? {
            self.restart()?;
            self.from = target;
            self.fill()?;
        }
        Ok(self.position as f64 / rate)
    }

    fn fill(&mut self) -> Result<(), Problem> {
        while self.pending.is_empty() && self.advance()? {}
        Ok(())
    }

    fn restart(&mut self) -> Result<(), Problem> {
        self.forget();
        self.reader = PacketReader::open(&self.input, self.reader.track)?;
        self.raw = RawPlace::START;
        (self.position, self.from) = (0, 0);
        Ok(())
    }

    fn forget(&mut self) {
        self.pending.clear();
        self.scratch.clear();
        self.resampler = Resampler::passing(self.info.sample_rate);
        self.raw = RawPlace { next: self.raw.next, at_start: false, ..RawPlace::START };
        (self.ended, self.drop_next) = (false, 0);
    }

    /// Jumps with the container's seek. Returns false if the seek is impossible or fails; the caller must then restart.
    fn jump(&mut self, target: i64) -> Result<bool, Problem> {
        if self.uneven {
            return Ok(false);
        }
        let rate = self.info.sample_rate;
        // If the target is past the end, start a second before the end, so that decoding reaches the end.
        let claimed_end = self.info.duration.map_or(i64::MAX / 4, |s| ((s - 1.0) * f64::from(rate)) as i64);
        if !self.reader.jump(target.min(claimed_end) + self.delay, rate)? {
            return Ok(false);
        }
        self.forget();
        self.from = target;
        // If decoding fails, the caller seeks from the start.
        if self.fill().is_err() || !self.raw.settled || self.uneven {
            return Ok(false);
        }
        Ok(self.pending.is_empty() || self.position == target)
    }

    fn advance(&mut self) -> Result<bool, Problem> {
        if self.ended {
            return Ok(false);
        }
        self.scratch.clear();
        match self.reader.next(&mut self.scratch) {
            Ok(Some(block)) => {
                let taken = self.append(block);
                self.ended |= taken.is_err();
                taken?;
                Ok(true)
            }
            Ok(None) => {
                self.end();
                Ok(!self.pending.is_empty())
            }
            Err(error) => {
                self.end();
                Err(error)
            }
        }
    }

    fn append(&mut self, block: Block) -> Result<(), Problem> {
        let padding = block.padding.min(self.scratch.len());
        self.scratch.truncate(self.scratch.len() - padding);
        if let Some(delay) = block.new_link {
            self.uneven = true;
            let begun = usize::try_from(block.start.unwrap_or(0)).unwrap_or(0);
            self.drop_next = usize::try_from(delay).unwrap_or(0).saturating_sub(begun);
        }
        let drop = self.drop_next.min(self.scratch.len());
        self.scratch.drain(..drop);
        self.drop_next -= drop;
        self.equalise(block.rate)?;

        if !self.raw.settled {
            self.settle(&block);
        } else if let (Some(start), true, false) = (block.start, block.exact, self.uneven) {
            // Gaps that are shorter than the block are jitter of the clock and are not filled.
            if start - self.raw.next >= self.scratch.len() as i64 {
                self.fill_hole(start - self.raw.next);
            }
        }
        let (first, last) =
            (self.raw.next - self.delay, self.raw.next - self.delay + self.scratch.len() as i64);
        self.raw.next += self.scratch.len() as i64;
        let from = self.from.max(0).clamp(first, last);
        let to = self.length.filter(|_| !self.uneven).unwrap_or(i64::MAX).clamp(from, last.max(from));
        if to > from {
            self.scratch.truncate((to - first) as usize);
            self.scratch.drain(..(from - first) as usize);
            std::mem::swap(&mut self.pending, &mut self.scratch);
            self.position = from;
        }
        if to < last {
            self.end();
        }
        Ok(())
    }

    fn settle(&mut self, block: &Block) {
        self.raw.settled = true;
        match block.start {
            Some(start) if self.raw.at_start && block.exact => {
                self.raw.next = start.min(self.delay);
                if start > self.delay {
                    self.fill_hole(start - self.raw.next);
                }
            }
            Some(start) if !self.raw.at_start => self.raw.next = start,
            _ => self.raw.next = 0,
        }
        self.raw.at_start = false;
    }

    fn fill_hole(&mut self, frames: i64) {
        let room = HOLE_SECONDS_MAX * i64::from(self.info.sample_rate) - self.raw.filled;
        if (1..=room).contains(&frames) {
            self.raw.filled += frames;
            let frames = (frames as usize).min(limits::PACKET_FRAMES_MAX);
            self.scratch.splice(..0, std::iter::repeat_n([0.0; 2], frames));
        }
    }

    fn equalise(&mut self, rate: u32) -> Result<(), Problem> {
        let wanted = self.info.sample_rate;
        if rate == wanted && self.resampler.from_hz() == rate {
            return Ok(());
        }
        let mut converted = Vec::new();
        let broken = |e: crate::resample::ResampleError| {
            Problem::Damaged(format!("its sample rate changes to {rate} Hz ({e})"))
        };
        if self.resampler.from_hz() != rate {
            self.uneven = true;
            self.resampler.finish(&mut converted).map_err(broken)?;
            self.resampler = Resampler::new(rate, wanted).map_err(broken)?;
        }
        self.resampler.process(&self.scratch, &mut converted).map_err(broken)?;
        self.scratch = converted;
        Ok(())
    }

    fn end(&mut self) {
        if self.ended {
            return;
        }
        self.ended = true;
        // If `finish` fails, at most one block in the filter is lost.
        let mut tail = Vec::new();
        let _ = self.resampler.finish(&mut tail);
        let first = self.raw.next - self.delay;
        self.raw.next += tail.len() as i64;
        let skip = (self.from - first).clamp(0, tail.len() as i64) as usize;
        if self.pending.is_empty() && skip < tail.len() {
            self.position = first + skip as i64;
            self.pending.extend_from_slice(&tail[skip..]);
        }
        if self.pending.is_empty() {
            self.position = (self.raw.next - self.delay).clamp(0, self.length.unwrap_or(i64::MAX).max(0));
        }
    }
}
