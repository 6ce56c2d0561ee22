//! What the show reports of itself to whoever displays it: phones, controllers, media keys.

/// The state of everything that a named command can change. A plain copy, made when somebody asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShowState {
    /// The user wants the sound paused.
    pub paused: bool,
    /// The song is muted.
    pub muted: bool,
    /// Tracks play in random order.
    pub shuffled: bool,
    /// Scenes follow the song.
    pub follows: bool,
    /// The scene stays although scenes follow the song.
    pub kept: bool,
    /// A recording is running.
    pub recording: bool,
    /// Scenes that are changed by hand are cut, not faded.
    pub cuts: bool,
    /// The picture is black, or fading to black.
    pub black: bool,
    /// The picture is held.
    pub frozen: bool,
    /// No words and panels are shown.
    pub clean: bool,
    /// The window fills its screen.
    pub fullscreen: bool,
    /// The share of their light that pictures keep, 0..1.
    pub brightness: f32,
    /// The place in the track, 0..1; `None` without a track of known length.
    pub position: Option<f32>,
    /// The volume of the song, 0..1; `None` while an input is listened to.
    pub volume: Option<f32>,
}
