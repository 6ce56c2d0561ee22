//! The limits of the program itself. Each crate has its own `limits.rs`.
//!
//! Code that applies a limit reads it from here, error messages print the limit, and a test reaches it.

/// Limits of inputs, and of the memory that the program allocates for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest width and height of an image or a window, in pixels.
    pub picture_side_min: u32,
    /// Largest width and height of an image, in pixels (OpenGL 3.3 drivers commonly allow this).
    pub picture_side_max: u32,
    /// Maximum number of pixels in an image (64 Mi: as 16-bit floats, these take 512 MiB).
    pub picture_pixels_max: u64,
    /// Lowest frame rate of `analyze`, `video` and the frame cap, in frames per second.
    pub fps_min: f64,
    /// Highest frame rate of `analyze`, `video` and the frame cap, in frames per second.
    pub fps_max: f64,
    /// Largest number of parts of a video.
    pub parts_of_video_max: u16,
    /// Largest number of exposures of a frame with motion blur.
    pub exposures_max: u16,
    /// Largest number of paths of light of a pixel, which the shaders count in 32-bit floats.
    pub path_samples_max: u16,
    /// Largest number of paths of light of a pixel of a refined moment in the window.
    pub refined_paths_max: u16,
    /// Maximum number of pixels of a refined moment (4 Mi: their paths take 1 GiB). Larger windows enlarge the image.
    pub refined_pixels_max: u64,
    /// Longest time that `--at`, `--start` and `--duration` accept, in seconds (a day).
    pub seconds_max: f64,
    /// Maximum size of a song from standard input, in bytes (1 GiB).
    pub standard_input_bytes_max: u64,
    /// Maximum number of interpreters and view programs kept for later scenes (some 20 MiB each on a software
    /// renderer).
    pub programs_kept_max: usize,
    /// Maximum size in bytes of a program in the driver's binary format on disk (usually 100 KiB to 2 MiB).
    pub kept_program_bytes_max: usize,
    /// Maximum size of all programs on disk, in bytes; the least recently used ones are deleted first.
    pub program_cache_bytes_max: u64,
    /// Time after the start, in seconds, at which thumbnails of the folder's scenes are drawn in advance.
    pub thumbnails_ahead_after: f64,
    /// Maximum number of thumbnails drawn in advance. Others are drawn when a list shows them.
    pub thumbnails_ahead_max: usize,
    /// Maximum size of a song's structure on disk, in bytes (usually 30 KiB for each minute).
    pub structure_bytes_max: usize,
    /// Maximum number of song structures on disk; the least recently used ones are deleted first.
    pub structures_kept_max: usize,
    /// Maximum number of pixels of a song's cover. Larger covers are not shown.
    pub cover_pixels_max: u64,
    /// Maximum size of the parts of a song on disk, in bytes (usually 1.8 MB for each minute).
    pub parts_bytes_max: usize,
    /// Maximum number of songs whose parts are on disk; the least recently used ones are deleted first.
    pub parts_kept_max: usize,
    /// Maximum estimated size of the prepared scenes, in bytes.
    pub prepared_bytes_max: u64,
    /// Maximum number of unfinished videos in the window's queue.
    pub videos_max: usize,
    /// Maximum size of the file of that queue, in bytes.
    pub video_queue_bytes_max: u64,
    /// Longest wait for a video encoder that makes no progress, in seconds.
    pub encoder_wait_seconds: f64,
    /// Maximum number of clients that receive frames over one port at the same time.
    pub send_readers_max: usize,
    /// Maximum size of a client's request for frames, in bytes.
    pub send_request_bytes_max: usize,
    /// Maximum number of header fields in a client's request for frames.
    pub send_request_fields_max: usize,
    /// Maximum number of programs to which frames are sent.
    pub sends_max: usize,
    /// Longest time for a scene's first frame in a window, in seconds. A slower scene is refused.
    pub picture_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    picture_side_min: 1,
    picture_side_max: 16_384,
    picture_pixels_max: 1 << 26,
    fps_min: 1.0,
    fps_max: 1_000.0,
    parts_of_video_max: 10_000,
    exposures_max: 256,
    path_samples_max: u16::MAX,
    refined_paths_max: 256,
    refined_pixels_max: 1 << 22,
    seconds_max: 86_400.0,
    standard_input_bytes_max: 1 << 30,
    programs_kept_max: 4,
    kept_program_bytes_max: 1 << 24,
    thumbnails_ahead_after: 20.0,
    thumbnails_ahead_max: 100,
    structure_bytes_max: 1 << 24,
    structures_kept_max: 500,
    cover_pixels_max: 1 << 24,
    parts_bytes_max: 1 << 27,
    parts_kept_max: 20,
    program_cache_bytes_max: 1 << 26,
    prepared_bytes_max: 1 << 27,
    videos_max: 50,
    video_queue_bytes_max: 1 << 22,
    encoder_wait_seconds: 300.0,
    send_readers_max: 8,
    send_request_bytes_max: 8_192,
    send_request_fields_max: 64,
    sends_max: 8,
    picture_seconds_max: 10.0,
};
