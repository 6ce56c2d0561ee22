//! All limits of this crate. Errors that report a limit and tests that reach it use these numbers.

/// Limits for audio files, playlists and delays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum number of channels that are mixed down to stereo. Files with more channels are rejected.
    pub channels_max: u16,
    /// Number of consecutive undecodable packets after which a file counts as damaged.
    pub bad_packets_in_a_row: u32,
    /// Maximum number of sample frames in one decoded packet.
    pub packet_frames_max: usize,
    /// Maximum number of tracks of a playlist. Further tracks are left out.
    pub playlist_tracks_max: usize,
    /// Maximum size of a playlist file, in bytes.
    pub playlist_bytes_max: u64,
    /// Maximum number of list files that are read for one playlist, including nested lists.
    pub playlist_lists_max: usize,
    /// Maximum depth of nested lists and folders.
    pub playlist_depth_max: usize,
    /// Maximum number of entries of lists and folders that are examined for one playlist.
    pub playlist_looks_max: usize,
    /// Maximum duration that a container may claim, in seconds (a year). A longer duration counts as unknown.
    pub claimed_duration_max: f64,
    /// Maximum number of letters of a displayed title, artist or other name. Further letters are cut off.
    pub name_letters_max: usize,
    /// Maximum size of a cover image, in bytes. Larger images are ignored.
    pub cover_bytes_max: usize,
    /// Maximum number of files of a folder that are examined for a cover.
    pub cover_folder_files_max: usize,
    /// Maximum number of files whose tags are kept, in memory and in the cache file.
    pub tags_kept_max: usize,
    /// Maximum number of files of a folder whose tags are read in advance. Further tags are read when they are shown.
    pub folder_tags_max: usize,
    /// Maximum size of the cache file of tags, in bytes. The rest of a larger file is ignored.
    pub tag_cache_bytes_max: u64,
    /// Maximum number of edits of a list that can be undone.
    pub undo_steps_max: usize,
    /// Maximum number of entries in all earlier states of a list that are kept for undo.
    pub undo_entries_max: usize,
    /// Maximum size of lyrics, in bytes.
    pub lyrics_bytes_max: u64,
    /// Maximum number of lines of lyrics. A line that is sung several times counts each time; later lines are ignored.
    pub lyrics_lines_max: usize,
    /// Maximum number of bytes of one line of lyrics. The rest of a longer line is not shown.
    pub lyrics_line_bytes_max: usize,
    /// Maximum number of files of a folder that are examined for stems.
    pub stem_files_max: usize,
    /// Maximum time, in seconds, that ffmpeg may take to deliver the next data of a file.
    pub ffmpeg_wait_seconds: f64,
    /// Maximum width and height of a frame of a decoded video or camera, in pixels. Larger frames are scaled down.
    pub video_size_max: (u32, u32),
    /// Maximum width and height of a video, in pixels. Larger videos are refused: decoding them takes too much memory.
    pub video_side_max: u32,
    /// Maximum number of frames per second of a decoded video; further frames are left out.
    pub video_rate_max: u32,
    /// Maximum length of a track, in seconds, for which a loudness shape is measured.
    pub shape_seconds_max: f64,
    /// Maximum shift of the image against the sound, in milliseconds, in either direction.
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
    cover_folder_files_max: 10_000,
    tags_kept_max: 60_000,
    folder_tags_max: 2_000,
    tag_cache_bytes_max: 1 << 26,
    undo_steps_max: 50,
    undo_entries_max: 100_000,
    lyrics_bytes_max: 1 << 20,
    lyrics_lines_max: 20_000,
    lyrics_line_bytes_max: 1_000,
    stem_files_max: 10_000,
    ffmpeg_wait_seconds: 10.0,
    video_size_max: (1_920, 1_080),
    video_side_max: 8_192,
    video_rate_max: 60,
    shape_seconds_max: 3.0 * 3_600.0,
    latency_ms_max: 5_000.0,
};
