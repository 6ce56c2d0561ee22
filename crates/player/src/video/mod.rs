//! Frames of video files and cameras, decoded by an installed ffmpeg.
//!
//! A video is read on a grid of equal steps: frame `n` is the last frame of the file that begins at or before step
//! `n`. The frame of a step therefore depends only on the file, not on seeks. Frames larger than the limits' `video_size_max`
//! are scaled down; their aspect ratio is kept.
//!
//! ffmpeg writes each frame as a PAM image, whose header has the size.

mod camera;
mod error;
mod frames;
mod probe;
mod reader;

pub use camera::Camera;
pub use error::VideoError;
pub use probe::VideoInfo;
pub use reader::VideoReader;

/// A decoded frame: sRGB with straight alpha, top row first, four bytes per pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VideoFrame {
    /// Width and height in pixels, each at least 1.
    pub size: (u32, u32),
    /// The pixels.
    pub rgba: Vec<u8>,
}
