//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that meets one reads it here, an error that reports one names the number that stands here, and a
//! test reaches it.

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
    /// Most bytes of the file of a list of tracks.
    pub playlist_bytes_max: u64,
    /// Most lists that are read for one playlist, nested ones counted.
    pub playlist_lists_max: usize,
    /// Deepest nesting of lists and folders.
    pub playlist_depth_max: usize,
    /// Most entries of lists and folders that are looked at for one playlist.
    pub playlist_looks_max: usize,
    /// Longest duration of a stream, in seconds, that a container's claim is believed (a year); beyond, it is unknown.
    pub claimed_duration_max: f64,
    /// Largest shift of the picture against the sound, in milliseconds, either way.
    pub latency_ms_max: f64,
}

/// The limits that hold.
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
    latency_ms_max: 5_000.0,
};

impl Default for Limits {
    fn default() -> Self {
        LIMITS
    }
}
