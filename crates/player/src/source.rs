//! The source of samples for playback and analysis. [`crate::decode::Decoder`] reads them from a file.

use mariana_music::StereoFrame;

/// An error that ends a source. The message is one sentence: what happened, where, and what to do.
pub type SourceError = Box<dyn std::error::Error + Send + Sync>;

/// A source skips damaged parts by itself. If it cannot continue, it returns an error for the caller to show.
pub trait FrameSource: Send {
    /// Frames per second, constant over the source's life.
    fn sample_rate(&self) -> u32;

    /// Length in seconds, if the container or a scan of the file reports a length.
    fn duration(&self) -> Option<f64>;

    /// Appends the next decoded frames (at most one packet) to `out` and returns their number, which is 0 at the end of
    /// the stream.
    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError>;

    /// Moves to the frame at `seconds`, clamped to the stream, and returns the time reached. The position is exact to
    /// the frame.
    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError>;
}
