//! A source that plays a part of another source.

use super::cue::DISC_FRAMES;
use super::lists::Cut;
use crate::source::{FrameSource, SourceError};
use mariana_music::StereoFrame;

/// A range of a source's frames. If two parts are adjacent in the file, their excerpts join without a gap.
pub(crate) struct Excerpt {
    source: Box<dyn FrameSource>,
    start: u64,
    /// The end of the range (exclusive). `u64::MAX` means the source's end.
    end: u64,
    position: u64,
}

impl Excerpt {
    pub(crate) fn new(source: Box<dyn FrameSource>, cut: Cut) -> Result<Self, SourceError> {
        let rate = u64::from(source.sample_rate());
        let frame = |disc: u64| disc.saturating_mul(rate) / DISC_FRAMES;
        let (start, end) = (frame(cut.start), cut.end.map_or(u64::MAX, frame));
        let mut excerpt = Self { source, start, end, position: start };
        excerpt.seek(0.0)?;
        Ok(excerpt)
    }

    fn seconds(&self, frames: u64) -> f64 {
        frames as f64 / f64::from(self.source.sample_rate())
    }
}

impl FrameSource for Excerpt {
    fn sample_rate(&self) -> u32 {
        self.source.sample_rate()
    }

    fn duration(&self) -> Option<f64> {
        let whole = self.source.duration();
        let end = if self.end == u64::MAX { whole? } else { self.seconds(self.end) };
        Some((whole.map_or(end, |whole| whole.min(end)) - self.seconds(self.start)).max(0.0))
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        let left = usize::try_from(self.end.saturating_sub(self.position)).unwrap_or(usize::MAX);
        if left == 0 {
            return Ok(0);
        }
        let before = out.len();
        let count = self.source.next_block(out)?.min(left);
        out.truncate(before + count);
        self.position += count as u64;
        Ok(count)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        let start = self.seconds(self.start);
        let end = if self.end == u64::MAX { f64::INFINITY } else { self.seconds(self.end) };
        let reached = self.source.seek((start + seconds.max(0.0)).min(end))?;
        self.position = (reached * f64::from(self.source.sample_rate())).round() as u64;
        Ok((reached - start).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A source whose samples encode their index, with 750 frames per second: 10 per compact disc frame.
    struct Count {
        frames: u64,
        next: u64,
    }

    impl FrameSource for Count {
        fn sample_rate(&self) -> u32 {
            750
        }

        fn duration(&self) -> Option<f64> {
            Some(self.frames as f64 / 750.0)
        }

        fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
            let end = (self.next + 7).min(self.frames);
            out.extend((self.next..end).map(|frame| [frame as f32; 2]));
            let count = end - self.next;
            self.next = end;
            Ok(count as usize)
        }

        fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
            self.next = ((seconds * 750.0).round() as u64).min(self.frames);
            Ok(self.next as f64 / 750.0)
        }
    }

    fn excerpt(frames: u64, start: u64, end: Option<u64>) -> Excerpt {
        Excerpt::new(Box::new(Count { frames, next: 0 }), Cut { start, end }).unwrap()
    }

    fn rest(source: &mut impl FrameSource) -> Vec<u64> {
        let mut out = vec![[-1.0; 2]];
        while source.next_block(&mut out).unwrap() > 0 {}
        out[1..].iter().map(|frame| frame[0] as u64).collect()
    }

    proptest! {
        #[test]
        fn parts_make_the_whole(frames in 0_u64..500, mut cuts in prop::collection::vec(1_u64..60, 0..5)) {
            cuts.sort_unstable();
            let starts = std::iter::once(0).chain(cuts.iter().copied());
            let ends = cuts.iter().copied().map(Some).chain([None]);
            let mut heard = Vec::new();
            for (start, end) in starts.zip(ends) {
                let mut part = excerpt(frames, start, end);
                let length = part.duration().unwrap();
                let own = rest(&mut part);
                prop_assert!((length * 750.0 - own.len() as f64).abs() < 1e-6, "{} of {}", length, own.len());
                heard.extend(own);
            }
            prop_assert_eq!(heard, (0..frames).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_seek_stays_within_the_part() {
        let mut part = excerpt(1000, 10, Some(20));
        for (asked, reached, first) in
            [(38.0, 38.0, Some(138)), (-900.0, 0.0, Some(100)), (9000.0, 100.0, None)]
        {
            assert!((part.seek(asked / 750.0).unwrap() - reached / 750.0).abs() < 1e-9);
            assert_eq!(rest(&mut part).first().copied(), first);
        }
    }
}
