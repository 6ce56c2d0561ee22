//! The seam of a loop: the frames after the loop's end fade into the loop's first frames.
//!
//! A loop of n frames with a seam of m frames draws n + m frames of the song. The first m frames are stored; at the
//! end, the last m frames fade into the stored frames. The loop therefore begins with frame m and ends at frame m - 1.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};

use super::encoder::no_room;
use crate::export::error::ExportError;

pub(super) struct Seam {
    /// The loop's first frames, stored on disk, because the frames may take hundreds of megabytes.
    aside: File,
    loop_frames: u64,
    seam_frames: u64,
    drawn: u64,
}

impl Seam {
    /// Creates the seam of a loop of `loop_frames` frames. The seam has at most half of the loop's frames.
    pub(super) fn new(loop_frames: u64, seam_frames: u64) -> Result<Self, ExportError> {
        let aside = tempfile::tempfile().map_err(no_room)?;
        Ok(Self { aside, loop_frames, seam_frames: seam_frames.min(loop_frames / 2), drawn: 0 })
    }

    pub(super) fn needed(&self) -> u64 {
        self.loop_frames + self.seam_frames
    }

    /// Takes the next frame of the song. Returns a frame of the loop, or `None` while the first frames are stored.
    pub(super) fn pass(&mut self, mut picture: Vec<u8>) -> Result<Option<Vec<u8>>, ExportError> {
        let index = self.drawn;
        self.drawn += 1;
        if index < self.seam_frames {
            self.aside.write_all(&picture).map_err(no_room)?;
            return Ok(None);
        }
        let Some(number) = index.checked_sub(self.loop_frames) else { return Ok(Some(picture)) };
        if number == 0 {
            self.aside.seek(SeekFrom::Start(0)).map_err(no_room)?;
        }
        let mut first = vec![0; picture.len()];
        self.aside.read_exact(&mut first).map_err(no_room)?;
        let fraction = (number + 1) as f32 / (self.seam_frames + 1) as f32;
        for (last, first) in picture.iter_mut().zip(first) {
            *last = (f32::from(*last) * (1.0 - fraction) + f32::from(first) * fraction).round() as u8;
        }
        Ok(Some(picture))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frame_of_a_loop_is_followed_by_its_first() {
        let mut seam = Seam::new(8, 3).unwrap();
        assert_eq!(seam.needed(), 11);
        // Every byte of frame n is 10 n.
        let passed: Vec<u8> =
            (0..11).filter_map(|index| Some(seam.pass(vec![10 * index; 4]).unwrap()?[0])).collect();
        // 80, 90 and 100 fade into 0, 10 and 20, which 30 follows.
        assert_eq!(passed, [30, 40, 50, 60, 70, 60, 50, 40]);
    }

    #[test]
    fn a_seam_takes_at_most_half_of_a_loop() {
        let mut seam = Seam::new(1, 30).unwrap();
        assert_eq!(seam.needed(), 1);
        assert_eq!(seam.pass(vec![7; 4]).unwrap(), Some(vec![7; 4]));
    }
}
