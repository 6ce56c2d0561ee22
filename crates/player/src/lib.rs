//! Audio playback and input: decodes files, plays them, listens to devices, and reports the features of the audible
//! moment.
//!
//! ```text
//! FrameSource ─► decoding thread ─┬─ resampler ─► ring of frames ─► OutputCallback ─► device or silent clock
//!                                 │                                    │ spans: which frames are audible (lock-free)
//!                                 └─ analysis thread ─► AudibleSegments ◄┴── Player::now: song time and features
//! ```
//!
//! | module | what it does | runs on |
//! |---|---|---|
//! | [`decode`], [`resample`] | produce frames | decoding thread |
//! | [`ffmpeg`] | command lines of ffmpeg and ffprobe, with a demuxer for each input | caller |
//! | [`playlist`], [`track`] | choose tracks and their order, and open them ahead of time | list thread |
//! | [`tags`] | reads the tags of whole lists and folders ahead, with a cache | thread of low priority |
//! | [`covers`] | finds the cover of a song | caller |
//! | [`lyrics`] | reads lyrics with times | caller |
//! | [`stems`] | finds and opens the stems of a song | caller |
//! | [`video`] | decodes the frames of videos and cameras | caller, who waits |
//! | [`listed`] | the list as a window shows it | shared, locked briefly |
//! | [`player`] | the handle for the window; the decoding and analysis threads | |
//! | [`audible_segments`] | map frames of a segment to song time and features | shared, locked briefly |
//! | [`clock`] | maps the callback's timestamps to the audible frame, across device changes | written by the callback |
//! | [`output`] | the callback, devices, the silent clock, the supervisor | |
//! | [`devices`] | the list of devices | caller |
//!
//! A **segment** is an unbroken run of frames in one ring. A segment starts at the beginning of playback, at a seek or
//! at a device change, and ends at the next seek or device change. The callback fades out the old segment, takes the
//! new segment, and returns the old segment so that another thread frees it. All features and positions are stored
//! under the segment's number, so data from before a seek is never used after it.
//!
//! A **passage** is one track within a segment. A loop or the next track continues the segment without a gap.

pub mod audible_segments;
pub mod clock;
pub mod covers;
pub mod decode;
mod device;
pub mod device_list;
pub mod devices;
mod encoding;
mod error;
pub mod ffmpeg;
mod gain_switch;
pub mod input;
pub mod limits;
pub mod listed;
pub mod lyrics;
mod one_line;
pub mod output;
pub mod player;
pub mod playlist;
mod priority;
#[cfg(target_os = "linux")]
mod pulse_cookie;
#[cfg(target_os = "linux")]
mod quiet_stderr;
pub mod resample;
#[cfg(target_os = "linux")]
mod server_connection;
#[cfg(not(target_os = "linux"))]
#[path = "no_server_connection.rs"]
mod server_connection;
mod shape;
pub mod song;
pub mod source;
pub mod stems;
mod supervisor;
pub mod tags;
pub mod track;
pub mod video;

pub use device::Target;
pub use error::{DeviceError, Direction, PlayerError};
pub use listed::{Edit, ListedTrack, ListedTracks};
pub use player::{
    MissedAudio, Moment, Player, PlayerOptions, PlayerStatus, Position, SilenceEnd, TrackErrors,
};
pub use priority::lower_priority;
pub use shape::LoudnessShape;
