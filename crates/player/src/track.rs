//! Tracks, and the interface between a player and its list of tracks.

use std::path::PathBuf;
use std::sync::Arc;

use mariana_music::StereoFrame;

use super::listed::{Edit, Edited, SharedListing};
use super::playlist::{Cut, Excerpt};
use super::song::Song;
use super::source::{FrameSource, SourceError};

const SILENCE_RATE: u32 = 48_000;
const SILENCE_BLOCK: usize = 1024;

/// Metadata of a track.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackInfo {
    /// The id of its list entry, which stays the same when the list is edited.
    pub id: u64,
    /// The entry's index in the list when the track was opened. [`crate::Player::status`] reports the current index.
    pub entry: usize,
    /// The length of the list when the track was opened.
    pub count: usize,
    /// Display name: artist and title, or the file name.
    pub name: String,
    /// Title, if the file has one.
    pub title: Option<String>,
    /// Artist, if the file has one.
    pub artist: Option<String>,
    /// Length in seconds, if known.
    pub duration: Option<f64>,
    /// A factor for the samples before analysis, so that quiet and loud tracks drive a scene in the same way.
    pub scene_gain: f32,
    /// The location of the frames, by which the track can be opened again; `None` for silence.
    pub content: Option<Content>,
}

/// The location of a track's frames: a song, or a part of a song. Tracks with equal contents have equal frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Content {
    /// The whole song.
    pub song: Song,
    /// The part of the song that is played; `None` for the whole song.
    pub cut: Option<Cut>,
}

impl Content {
    /// Opens the frames from their start. This may block.
    ///
    /// # Errors
    /// Fails if the song cannot be opened, or cannot be decoded at the start of its part.
    pub fn open(&self) -> Result<Box<dyn FrameSource>, SourceError> {
        let source = Box::new(self.song.open()?);
        Ok(match self.cut {
            Some(cut) => Box::new(Excerpt::new(source, cut)?),
            None => source,
        })
    }
}

/// An open track at its start.
pub struct Track {
    /// The track's frames.
    pub source: Box<dyn FrameSource>,
    /// The track's metadata.
    pub info: Arc<TrackInfo>,
}

impl Track {
    /// Wraps a source that belongs to no list.
    pub fn alone(source: Box<dyn FrameSource>) -> Self {
        let duration = source.duration();
        let info = TrackInfo { count: 1, duration, scene_gain: 1.0, ..TrackInfo::default() };
        Self { source, info: Arc::new(info) }
    }

    /// Endless silence as entry `entry` of `count`, for a list without a playable track. The id equals `entry`.
    pub fn silence(entry: usize, count: usize) -> Self {
        let mut track = Self::alone(Box::new(Silence));
        let info = Arc::make_mut(&mut track.info);
        (info.entry, info.count, info.name) = (entry, count, "nothing to play".into());
        track.with_id(entry as u64)
    }

    /// Replaces the entry's id.
    pub fn with_id(mut self, id: u64) -> Self {
        Arc::make_mut(&mut self.info).id = id;
        self
    }
}

/// Multiplies frames before analysis, live and offline; see [`TrackInfo::scene_gain`].
pub fn scale(frames: &mut [StereoFrame], gain: f32) {
    for frame in frames {
        *frame = frame.map(|sample| sample * gain);
    }
}

struct Silence;

impl FrameSource for Silence {
    fn sample_rate(&self) -> u32 {
        SILENCE_RATE
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        out.extend([[0.0; 2]; SILENCE_BLOCK]);
        Ok(SILENCE_BLOCK)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        Ok((seconds.max(0.0) * f64::from(SILENCE_RATE)).round() / f64::from(SILENCE_RATE))
    }
}

/// The repeat mode of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repeat {
    /// After the last track, starts again with the first track.
    #[default]
    All,
    /// Repeats the current track.
    One,
    /// Stops after the last track.
    Off,
}

/// A request to a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wanted {
    /// The track that follows when an entry has played to its end.
    Following {
        /// The entry's id.
        after: u64,
        /// True if the entry must be opened again to repeat, because its open track cannot restart.
        anew: bool,
    },
    /// The track that is `steps` entries after `from`.
    Skip {
        /// The entry's id.
        from: u64,
        /// Positive values go forward.
        steps: i32,
    },
    /// The track at this index, or the next playable track.
    Entry(usize),
    /// The successor of the removed entry with this id. If the entry has no successor, silence with the same id.
    InPlaceOf(u64),
    /// The first track of these files, which replace the list.
    Files {
        /// Files, folders and playlists.
        files: Vec<PathBuf>,
        /// The id of the entry that plays, to which an undo returns.
        playing: u64,
    },
}

/// The result of a request to a list.
pub enum Found {
    /// An opened track.
    Track(Track),
    /// The same track again. It is open already.
    Again,
    /// The end of the list.
    End,
    /// A list without any playable track.
    Nothing,
}

/// A list of tracks. The player calls it on a separate thread, so it may block.
pub trait TrackList: Send {
    /// Finds and opens a track. Reports each skipped entry to `tell` in one sentence.
    fn find(&mut self, wanted: &Wanted, tell: &mut dyn FnMut(String)) -> Found;

    /// Changes the repeat mode and the order. A new random order begins with the entry whose id is `current`.
    fn set_order(&mut self, repeat: Repeat, shuffled: bool, current: u64);

    /// Keeps `listing` up to date with the list from now on. The default implementation lists only the first track.
    fn fill_listing(&mut self, _listing: SharedListing) {}

    /// Edits the list while the entry with id `playing` plays, and reports failures to `tell`. The default
    /// implementation changes nothing.
    fn edit(&mut self, _edit: &Edit, _playing: u64, _tell: &mut dyn FnMut(String)) -> Edited {
        Edited::default()
    }
}
