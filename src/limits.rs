//! Every limit of the program that does not belong to one of its crates: those are in the crate's `limits.rs`.
//!
//! A limit is data: code that applies one reads it here, an error that reports one gives the number defined here, and
//! a test reaches it.

/// Limits on what comes from outside and on what the program allocates for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest width and height of a picture or a window, in pixels.
    pub picture_side_min: u32,
    /// Largest width and height of a picture, in pixels (what OpenGL 3.3 drivers commonly allow).
    pub picture_side_max: u32,
    /// Most pixels of one picture (64 Mi: a target of 16-bit floats takes 512 MiB).
    pub picture_pixels_max: u64,
    /// Lowest and highest frame rate of `analyze`, `video` and the frame cap, in frames per second.
    pub fps_min: f64,
    /// See [`Limits::fps_min`].
    pub fps_max: f64,
    /// Longest time that `--at`, `--start` and `--duration` take, in seconds (a day).
    pub seconds_max: f64,
    /// Most bytes of a song that comes by standard input (1 GiB).
    pub standard_input_bytes_max: u64,
    /// Most interpreters, and most programs of views, that are kept for scenes to come (some 20 MiB each on a
    /// software renderer).
    pub programs_kept_max: usize,
    /// Most bytes of a program in a driver's own form that is kept from run to run (some 100 KiB to 2 MiB are usual).
    pub kept_program_bytes_max: usize,
    /// Most bytes that all kept programs take on the disk; those that were used longest ago go first.
    pub program_cache_bytes_max: u64,
    /// Seconds from the start until the thumbnails of the folder's scenes are drawn ahead.
    pub thumbnails_ahead_after: f64,
    /// Most scenes of a folder that are drawn ahead.
    pub thumbnails_ahead_max: usize,
    /// Most bytes of a song's structure that is kept from run to run (some 30 KiB for each minute are usual).
    pub structure_bytes_max: usize,
    /// Most structures of songs that are kept from run to run; those that were used longest ago go first.
    pub structures_kept_max: usize,
    /// Most bytes, by estimate, that the scenes take which are prepared while another one is shown.
    pub prepared_bytes_max: u64,
    /// Longest time in seconds for which a video's encoder may make no progress while it is waited for.
    pub encoder_wait_seconds: f64,
    /// Most programs that are sent pictures over one port at a time.
    pub send_readers_max: usize,
    /// Most bytes of what such a program asks for.
    pub send_request_bytes_max: usize,
    /// Most header fields of it.
    pub send_request_fields_max: usize,
    /// Most places that pictures are sent to in a run.
    pub sends_max: usize,
    /// Longest time in seconds that a scene's first picture may take in a window; beyond it the previous scene stays.
    pub picture_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    picture_side_min: 1,
    picture_side_max: 16_384,
    picture_pixels_max: 1 << 26,
    fps_min: 1.0,
    fps_max: 1_000.0,
    seconds_max: 86_400.0,
    standard_input_bytes_max: 1 << 30,
    programs_kept_max: 4,
    kept_program_bytes_max: 1 << 24,
    thumbnails_ahead_after: 20.0,
    thumbnails_ahead_max: 100,
    structure_bytes_max: 1 << 24,
    structures_kept_max: 500,
    program_cache_bytes_max: 1 << 26,
    prepared_bytes_max: 1 << 27,
    encoder_wait_seconds: 300.0,
    send_readers_max: 8,
    send_request_bytes_max: 8_192,
    send_request_fields_max: 64,
    sends_max: 8,
    picture_seconds_max: 10.0,
};
