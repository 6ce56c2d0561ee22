//! Where playback and analysis pull samples from: a decoded file today, anything seekable tomorrow.

use mariana_music::StereoFrame;

/// Why a source cannot go on. The message is one sentence that says what, where and what to do.
pub type SourceError = Box<dyn std::error::Error + Send + Sync>;

/// A seekable stream of stereo frames at a fixed rate.
///
/// A source never ends the program: damaged stretches are skipped inside, and what cannot be skipped comes
/// back as an error that the caller shows.
pub trait FrameSource: Send {
    /// Frames per second, constant over the life of the source.
    fn sample_rate(&self) -> u32;

    /// Length in seconds, if the container (or a scan) gives it.
    fn duration(&self) -> Option<f64>;

    /// Appends the next decoded frames to `out` and returns how many; 0 is the end of the stream.
    /// One call appends at most a packet.
    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError>;

    /// Moves so that the next block starts at `seconds` (clamped to the stream), exact to the frame, and returns the
    /// time reached; past the end, that is the end.
    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError>;
}
