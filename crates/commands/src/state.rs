//! The show's state, for phones, controllers and media keys.

/// The state of everything that a named command can change, copied from the show at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShowState {
    /// Playback is paused by the user.
    pub paused: bool,
    /// The song is muted.
    pub muted: bool,
    /// Tracks play in random order.
    pub shuffled: bool,
    /// The program changes scenes to suit the song.
    pub follows: bool,
    /// The current scene stays, even while `follows` is true.
    pub kept: bool,
    /// A recording is running.
    pub recording: bool,
    /// Manual scene changes are cuts, not fades.
    pub cuts: bool,
    /// Two decks are mixed by the crossfader.
    pub decks: bool,
    /// The position of the crossfader, 0..1; `None` without decks.
    pub crossfade: Option<f32>,
    /// The effect of the snapshot keys.
    pub snapshots: SnapshotKeys,
    /// The image is black, or fading to black.
    pub black: bool,
    /// The image is frozen.
    pub frozen: bool,
    /// Text and panels are hidden.
    pub clean: bool,
    /// The window fills its screen.
    pub fullscreen: bool,
    /// The brightness of the image, 0..1.
    pub brightness: f32,
    /// The position in the track, 0..1; `None` without a track of known length.
    pub position: Option<f32>,
    /// The volume of the song, 0..1; `None` while an input is the source.
    pub volume: Option<f32>,
}

/// The effect of the snapshot keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SnapshotKeys {
    /// The next key takes its snapshot, even if there is one.
    pub takes: bool,
    /// Snapshots are recalled over some beats, not at once.
    pub morphs: bool,
    /// The number of beats.
    pub beats: u16,
}

impl Default for SnapshotKeys {
    fn default() -> Self {
        Self { takes: false, morphs: false, beats: 4 }
    }
}
