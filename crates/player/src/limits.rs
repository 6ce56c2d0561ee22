//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that obeys a limit reads it here, an error that reports one names the number from here, and
//! a test reaches it.

/// Ceilings on files of sound, lists of them, and delays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most channels of a decoded stream that are mixed down to stereo. More is an over-limit input.
    pub channels_max: u16,
    /// Most undecodable packets in a row before a file is given up as damaged.
    pub bad_packets_in_a_row: u32,
    /// Most frames (one sample per channel) that one decoded packet may hold.
    pub packet_frames_max: usize,
    /// Most tracks of a playlist; further ones are left out.
    pub playlist_tracks_max: usize,
    /// Most bytes of a playlist file.
    pub playlist_bytes_max: u64,
    /// Most lists that are read for one playlist, including nested ones.
    pub playlist_lists_max: usize,
    /// Deepest nesting of lists and folders.
    pub playlist_depth_max: usize,
    /// Most entries of lists and folders that are examined for one playlist.
    pub playlist_looks_max: usize,
    /// Longest stream duration, in seconds, that is believed when a container claims it (a year); beyond, it is
    /// unknown.
    pub claimed_duration_max: f64,
    /// Most letters of a title, an artist or another name that is shown; what follows is left out.
    pub name_letters_max: usize,
    /// Most bytes of a cover; a larger one counts as none.
    pub cover_bytes_max: usize,
    /// Longest time, in seconds, for which ffmpeg may give nothing of a file.
    pub ffmpeg_wait_seconds: f64,
    /// Longest track, in seconds, whose loudness is measured for a picture of it.
    pub shape_seconds_max: f64,
    /// Largest shift of the picture against the sound, in milliseconds, either way.
    pub latency_ms_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    channels_max: 32,
    bad_packets_in_a_row: 256,
    packet_frames_max: 1 << 20,
    playlist_tracks_max: 20_000,
    playlist_bytes_max: 1 << 22,
    playlist_lists_max: 64,
    playlist_depth_max: 16,
    playlist_looks_max: 200_000,
    claimed_duration_max: 31_536_000.0,
    name_letters_max: 300,
    cover_bytes_max: 1 << 24,
    ffmpeg_wait_seconds: 10.0,
    shape_seconds_max: 3.0 * 3_600.0,
    latency_ms_max: 5_000.0,
};
