//! All limits of this crate. Errors that report a limit and tests that reach it read the number here.

/// Limits for audio files, playlists and delays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Highest channel count that is mixed down to stereo; files with more are rejected.
    pub channels_max: u16,
    /// Consecutive undecodable packets after which a file counts as damaged.
    pub bad_packets_in_a_row: u32,
    /// Most sample frames in one decoded packet.
    pub packet_frames_max: usize,
    /// Most tracks of a playlist; further ones are left out.
    pub playlist_tracks_max: usize,
    /// Largest playlist file, in bytes.
    pub playlist_bytes_max: u64,
    /// Most list files that are read for one playlist, including nested ones.
    pub playlist_lists_max: usize,
    /// Deepest nesting of lists and folders.
    pub playlist_depth_max: usize,
    /// Most entries of lists and folders that are examined for one playlist.
    pub playlist_looks_max: usize,
    /// Longest duration that a container may claim, in seconds (a year); a longer one counts as unknown.
    pub claimed_duration_max: f64,
    /// Most letters of a displayed title, artist or other name; the rest is cut off.
    pub name_letters_max: usize,
    /// Largest cover image, in bytes; larger ones are ignored.
    pub cover_bytes_max: usize,
    /// Longest time, in seconds, that ffmpeg may take to deliver the next data of a file.
    pub ffmpeg_wait_seconds: f64,
    /// Longest track, in seconds, for which a loudness shape is measured.
    pub shape_seconds_max: f64,
    /// Largest shift of the image against the sound, in milliseconds, in either direction.
    pub latency_ms_max: f64,
}

/// The limits that apply.
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
