//! `Frame`: everything the GPU needs for one picture, from time, sound and camera.
//!
//! Plain numbers, no OpenGL: a frame is the same for a window, a still and a video.

pub mod block;
pub mod camera;

use crate::dsp::Features;
use camera::Camera;

/// What one picture shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Scene time in seconds: the position in the song. Finite; non-finite values are taken as 0.
    pub time: f64,
    /// The sound that is audible at that time.
    pub features: Features,
    /// Width and height of the picture in pixels, each at least 1.
    pub size: (u32, u32),
    /// Where the picture is seen from.
    pub camera: Camera,
}

impl Frame {
    /// The frame of the speakers scene at `time`, for a picture of `size` pixels.
    pub fn new(time: f64, features: Features, size: (u32, u32)) -> Self {
        let time = if time.is_finite() { time } else { 0.0 };
        let size = (size.0.max(1), size.1.max(1));
        let aspect = f64::from(size.0) / f64::from(size.1);
        Self { time, features, size, camera: Camera::around_speakers(time, aspect) }
    }
}
