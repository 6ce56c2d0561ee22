//! The limits of the program itself. Each crate has its own `limits.rs`.
//!
//! Code that applies a limit reads it from here, error messages print the limit, and a test reaches it.

/// Smallest width and height of an image or a window, in pixels.
pub const PICTURE_SIDE_MIN: u32 = 1;
/// Largest width and height of an image, in pixels (OpenGL 3.3 drivers commonly allow this).
pub const PICTURE_SIDE_MAX: u32 = 16_384;
/// Maximum number of pixels in an image (64 Mi: as 16-bit floats, these take 512 MiB).
pub const PICTURE_PIXELS_MAX: u64 = 1 << 26;
/// Lowest frame rate of `analyze`, `video` and the frame cap, in frames per second.
pub const FPS_MIN: f64 = 1.0;
/// Highest frame rate of `analyze`, `video` and the frame cap, in frames per second.
pub const FPS_MAX: f64 = 1_000.0;
/// Largest number of parts of a video.
pub const PARTS_OF_VIDEO_MAX: u16 = 10_000;
/// Largest number of exposures of a frame with motion blur.
pub const EXPOSURES_MAX: u16 = 256;
/// Largest number of paths of light of a pixel, which the shaders count in 32-bit floats.
pub const PATH_SAMPLES_MAX: u16 = u16::MAX;
/// Maximum size of a message from an editor, in bytes. A larger message is skipped and reported.
pub const EDITOR_MESSAGE_BYTES_MAX: u64 = 16 << 20;
/// Maximum size of the header of a message from an editor, in bytes.
pub const EDITOR_HEADER_BYTES_MAX: u64 = 4_096;
/// Largest number of paths of light of a pixel of a refined moment in the window.
pub const REFINED_PATHS_MAX: u16 = 256;
/// Maximum number of pixels of a refined moment (4 Mi: their paths take 1 GiB). Larger windows enlarge the image.
pub const REFINED_PIXELS_MAX: u64 = 1 << 22;
/// Longest time that `--at`, `--start` and `--duration` accept, in seconds (a day).
pub const SECONDS_MAX: f64 = 86_400.0;
/// Maximum size of a song from standard input, in bytes (1 GiB).
pub const STANDARD_INPUT_BYTES_MAX: u64 = 1 << 30;
/// Maximum number of interpreters and view programs kept for later scenes (some 20 MiB each on a software
/// renderer).
pub const PROGRAMS_KEPT_MAX: usize = 4;
/// Maximum size in bytes of a program in the driver's binary format on disk (usually 100 KiB to 2 MiB).
pub const KEPT_PROGRAM_BYTES_MAX: usize = 1 << 24;
/// Maximum size of all programs on disk, in bytes; the least recently used ones are deleted first.
pub const PROGRAM_CACHE_BYTES_MAX: u64 = 1 << 26;
/// Maximum size of a song's structure on disk, in bytes (usually 30 KiB for each minute).
pub const STRUCTURE_BYTES_MAX: usize = 1 << 24;
/// Maximum number of song structures on disk; the least recently used ones are deleted first.
pub const STRUCTURES_KEPT_MAX: usize = 500;
/// Maximum number of pixels of a song's cover. Larger covers are not shown.
pub const COVER_PIXELS_MAX: u64 = 1 << 24;
/// Maximum size of the parts of a song on disk, in bytes (usually 1.8 MB for each minute).
pub const PARTS_BYTES_MAX: usize = 1 << 27;
/// Maximum number of songs whose parts are on disk; the least recently used ones are deleted first.
pub const PARTS_KEPT_MAX: usize = 20;
/// Maximum estimated size of the prepared scenes, in bytes.
pub const PREPARED_BYTES_MAX: u64 = 1 << 27;
/// Maximum number of unfinished videos in the window's queue.
pub const VIDEOS_MAX: usize = 50;
/// Maximum size of the file of that queue, in bytes.
pub const VIDEO_QUEUE_BYTES_MAX: u64 = 1 << 22;
/// Longest wait for a video encoder that makes no progress, in seconds.
pub const ENCODER_WAIT_SECONDS: f64 = 300.0;
/// Maximum number of clients that receive frames over one port at the same time.
pub const SEND_READERS_MAX: usize = 8;
/// Maximum size of a client's request for frames, in bytes.
pub const SEND_REQUEST_BYTES_MAX: usize = 8_192;
/// Maximum number of header fields in a client's request for frames.
pub const SEND_REQUEST_FIELDS_MAX: usize = 64;
/// Maximum number of programs to which frames are sent.
pub const SENDS_MAX: usize = 8;
/// Maximum size of a song in a web page, in bytes.
pub const PAGE_SONG_BYTES_MAX: usize = 100_000_000;
/// Longest time for a scene's first frame in a window, in seconds. A slower scene is refused.
pub const PICTURE_SECONDS_MAX: f64 = 10.0;
