//! All limits of this crate. Errors that report a limit and tests that reach it use these numbers.

/// Maximum number of channels that are mixed down to stereo. Files with more channels are rejected.
pub const CHANNELS_MAX: u16 = 32;
/// Number of consecutive undecodable packets after which a file counts as damaged.
pub const BAD_PACKETS_IN_A_ROW: u32 = 256;
/// Maximum number of sample frames in one decoded packet.
pub const PACKET_FRAMES_MAX: usize = 1 << 20;
/// Maximum number of tracks of a playlist. Further tracks are left out.
pub const PLAYLIST_TRACKS_MAX: usize = 20_000;
/// Maximum size of a playlist file, in bytes.
pub const PLAYLIST_BYTES_MAX: usize = 1 << 22;
/// Maximum number of list files that are read for one playlist, including nested lists.
pub const PLAYLIST_LISTS_MAX: usize = 64;
/// Maximum depth of nested lists and folders.
pub const PLAYLIST_DEPTH_MAX: usize = 16;
/// Maximum number of entries of lists and folders that are examined for one playlist.
pub const PLAYLIST_LOOKS_MAX: usize = 200_000;
/// Maximum duration that a container may claim, in seconds (a year). A longer duration counts as unknown.
pub const CLAIMED_DURATION_MAX: f64 = 31_536_000.0;
/// Maximum number of letters of a displayed title, artist or other name. Further letters are cut off.
pub const NAME_LETTERS_MAX: usize = 300;
/// Maximum size of a cover image, in bytes. Larger images are ignored.
pub const COVER_BYTES_MAX: usize = 1 << 24;
/// Maximum number of files of a folder that are examined for a cover.
pub const COVER_FOLDER_FILES_MAX: usize = 10_000;
/// Maximum number of files whose tags are kept, in memory and in the cache file.
pub const TAGS_KEPT_MAX: usize = 60_000;
/// Maximum number of files of a folder whose tags are read in advance. Further tags are read when they are shown.
pub const FOLDER_TAGS_MAX: usize = 2_000;
/// Maximum size of the cache file of tags, in bytes. A larger file is ignored.
pub const TAG_CACHE_BYTES_MAX: usize = 1 << 26;
/// Maximum number of edits of a list that can be undone.
pub const UNDO_STEPS_MAX: usize = 50;
/// Maximum number of entries in all earlier states of a list that are kept for undo.
pub const UNDO_ENTRIES_MAX: usize = 100_000;
/// Maximum size of lyrics, in bytes.
pub const LYRICS_BYTES_MAX: u64 = 1 << 20;
/// Maximum number of lines of lyrics. A line that is sung several times counts each time; later lines are ignored.
pub const LYRICS_LINES_MAX: usize = 20_000;
/// Maximum number of bytes of one line of lyrics. The rest of a longer line is not shown.
pub const LYRICS_LINE_BYTES_MAX: usize = 1_000;
/// Maximum number of files of a folder that are examined for stems.
pub const STEM_FILES_MAX: usize = 10_000;
/// Maximum time, in seconds, that ffmpeg may take to deliver the next data of a file.
pub const FFMPEG_WAIT_SECONDS: f64 = 10.0;
/// Maximum width and height of a frame of a decoded video or camera, in pixels. Larger frames are scaled down.
pub const VIDEO_SIZE_MAX: (u32, u32) = (1_920, 1_080);
/// Maximum width and height of a video, in pixels. Larger videos are refused: decoding them takes too much memory.
pub const VIDEO_SIDE_MAX: u32 = 8_192;
/// Maximum number of frames per second of a decoded video; further frames are left out.
pub const VIDEO_RATE_MAX: u32 = 60;
/// Maximum length of a track, in seconds, for which a loudness shape is measured.
pub const SHAPE_SECONDS_MAX: f64 = 3.0 * 3_600.0;
/// Maximum shift of the image against the sound, in milliseconds, in either direction.
pub const LATENCY_MS_MAX: f64 = 5_000.0;
