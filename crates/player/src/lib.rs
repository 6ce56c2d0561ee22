//! Sound: decoding, playback, and what is audible now.
//!
//! ```text
//! FrameSource ─► decoding thread ─┬─ resampler ─► ring of frames ─► OutputCallback (the callback) ─► device or silent clock
//!                                 │                                    │ spans: what sounds when (lock-free)
//!                                 └─ analysis thread ─► Timeline ◄─────┴── Player::now: song time and features
//! ```
//!
//! | module | what it does | runs on |
//! |---|---|---|
//! | [`source`], [`decode`], [`resample`] | where frames come from | decoding thread |
//! | [`ffmpeg`] | command lines of ffmpeg and ffprobe, each input with its demuxer | caller |
//! | [`playlist`], [`track`] | which tracks, in which order; each is opened ahead | list thread |
//! | [`listed`] | the list as a window shows it | shared, locked briefly |
//! | [`player`] | the handle of the window, and the decoding and analysis threads | |
//! | [`audible_segments`] | from frames of a segment to song time and features | shared, locked briefly |
//! | [`clock`] | from the callback's timestamps to the frame that is audible now, through changes of device, too | written by the callback |
//! | [`output`] | the callback itself, devices, the silent clock, the supervisor | |
//! | [`devices`] | the list of devices | caller |
//!
//! A **segment** is an unbroken run of frames in one ring: from the start or a seek until the next seek or change of
//! device. A loop does not end it, and neither does the track that follows: within a segment each track is a
//! **passage**.
//!
//! **Segments.** A seek, or another device, starts a new segment with its own ring; the callback fades the old one
//! out, takes the new one and hands the old one back to be freed elsewhere. Everything is keyed by the segment's
//! number, so features and positions from before a seek cannot be taken for those after it. A loop, or the track that
//! follows, stays in its segment and is gapless.

pub mod audible_segments;
pub mod clock;
pub mod decode;
mod device;
pub mod device_list;
pub mod devices;
mod error;
pub mod ffmpeg;
mod gain_switch;
mod hosts;
pub mod input;
pub mod limits;
pub mod listed;
mod one_line;
pub mod output;
pub mod player;
pub mod playlist;
#[cfg(target_os = "linux")]
mod quiet_stderr;
pub mod resample;
#[cfg(target_os = "linux")]
mod server_connection;
#[cfg(not(target_os = "linux"))]
#[path = "no_server_connection.rs"]
mod server_connection;
pub mod song;
pub mod source;
mod supervisor;
pub mod track;
mod worker;

pub use device::Target;
pub use error::{DeviceError, Direction, PlayerError};
pub use listed::{ListedTrack, ListedTracks};
pub use player::{
    LoudnessShape, MissedAudio, Moment, OutputChoice, Player, PlayerOptions, PlayerStatus, Position,
    SilenceEnd, TrackErrors,
};
