//! Tracks, and what a player asks of the list that they come from.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::decode::Decoder;
use super::listed::{Edit, Edited, SharedListing};
use super::playlist::Cut;
use super::song::{Song, display_name};
use super::source::{FrameSource, SourceError};
use mariana_music::StereoFrame;

/// Rate of [`Track::silence`], in hertz.
const SILENCE_RATE: u32 = 48_000;
/// Frames of silence per block.
const SILENCE_BLOCK: usize = 1024;

/// What is known about a track.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackInfo {
    /// The number of its entry, which stays the same when the list is edited.
    pub id: u64,
    /// Its index in the list that it comes from, when it was opened; [`crate::Player::status`] tells the present one.
    pub entry: usize,
    /// How many tracks that list has, likewise.
    pub count: usize,
    /// Its name: artist and title, or the file's name.
    pub name: String,
    /// Title, if the file gives one.
    pub title: Option<String>,
    /// Who made it, if the file says.
    pub artist: Option<String>,
    /// Length in seconds, if known.
    pub duration: Option<f64>,
    /// The factor for its samples before they are analysed, so that quiet and loud tracks drive a scene alike.
    pub scene_gain: f32,
    /// How its frames come a second time, from its start, for who wants to know it before it is heard.
    pub reopen: Reopen,
}

type Opening = dyn Fn() -> Result<Box<dyn FrameSource>, SourceError> + Send + Sync;

/// Where a track's frames are: all of a song or a part of it. The same bytes and the same part are the same frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Content {
    /// The song.
    pub song: Song,
    /// The part of it that is played; none is all of it.
    pub cut: Option<Cut>,
}

/// A way to open a track again, if there is one.
#[derive(Clone, Default)]
pub struct Reopen {
    open: Option<Arc<Opening>>,
    content: Option<Arc<Content>>,
}

impl Reopen {
    /// By calling this.
    pub fn by(open: impl Fn() -> Result<Box<dyn FrameSource>, SourceError> + Send + Sync + 'static) -> Self {
        Self { open: Some(Arc::new(open)), content: None }
    }

    /// The same for a track whose frames are those of `content`.
    pub(super) fn of(self, content: Content) -> Self {
        Self { content: Some(Arc::new(content)), ..self }
    }

    /// Opens the track; none if there is no way. This may take its time.
    pub fn open(&self) -> Option<Result<Box<dyn FrameSource>, SourceError>> {
        self.open.as_ref().map(|open| open())
    }

    /// Whether there is a way.
    pub fn is_possible(&self) -> bool {
        self.open.is_some()
    }

    /// Where the frames are, if that is known.
    pub fn content(&self) -> Option<&Content> {
        self.content.as_deref()
    }
}

impl PartialEq for Reopen {
    fn eq(&self, other: &Self) -> bool {
        match (&self.open, &other.open) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        }
    }
}

impl fmt::Debug for Reopen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_possible() { "Reopen(by a function)" } else { "Reopen(not at all)" })
    }
}

/// A track that is open and stands at its start.
pub struct Track {
    /// Its frames.
    pub source: Box<dyn FrameSource>,
    /// What is known about it.
    pub info: Arc<TrackInfo>,
}

impl Track {
    /// The track that a decoder yields, as entry `entry` of `count`, with the id of that number.
    pub fn of_decoder(decoder: Decoder, entry: usize, count: usize) -> Self {
        let about = decoder.info();
        let info = TrackInfo {
            id: entry as u64,
            entry,
            count,
            name: display_name(&decoder),
            title: about.title.clone(),
            artist: about.artist.clone(),
            duration: about.duration,
            scene_gain: about.scene_gain,
            reopen: Reopen::default(),
        };
        Self { source: Box::new(decoder), info: Arc::new(info) }
    }

    /// A source without a list.
    pub fn alone(source: Box<dyn FrameSource>) -> Self {
        let info = TrackInfo {
            id: 0,
            entry: 0,
            count: 1,
            name: String::new(),
            title: None,
            artist: None,
            duration: source.duration(),
            scene_gain: 1.0,
            reopen: Reopen::default(),
        };
        Self { source, info: Arc::new(info) }
    }

    /// Endless silence in place of entry `entry` of `count`, with the id of that number, played when nothing else can
    /// be.
    pub fn silence(entry: usize, count: usize) -> Self {
        let mut track = Self::alone(Box::new(Silence { position: 0 }));
        let info = Arc::make_mut(&mut track.info);
        (info.entry, info.count, info.name) = (entry, count, "nothing to play".into());
        track.with_id(entry as u64)
    }

    /// The track as the entry with that id.
    pub fn with_id(mut self, id: u64) -> Self {
        Arc::make_mut(&mut self.info).id = id;
        self
    }
}

/// Multiplies frames before they are analysed, live and offline alike; see [`TrackInfo::scene_gain`].
pub fn scale(frames: &mut [StereoFrame], gain: f32) {
    for frame in frames {
        *frame = frame.map(|sample| sample * gain);
    }
}

struct Silence {
    position: u64,
}

impl FrameSource for Silence {
    fn sample_rate(&self) -> u32 {
        SILENCE_RATE
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        out.extend([[0.0; 2]; SILENCE_BLOCK]);
        self.position += SILENCE_BLOCK as u64;
        Ok(SILENCE_BLOCK)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        self.position = (seconds.max(0.0) * f64::from(SILENCE_RATE)).round() as u64;
        Ok(self.position as f64 / f64::from(SILENCE_RATE))
    }
}

/// What follows the last track, and each track.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repeat {
    /// After the last track the first one.
    #[default]
    All,
    /// After each track the same again.
    One,
    /// After the last track nothing.
    Off,
}

impl Repeat {
    /// All of them with their names.
    const NAMES: [(Self, &'static str); 3] = [(Self::All, "all"), (Self::One, "one"), (Self::Off, "off")];

    /// What it is called.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(repeat, _)| *repeat == self).map_or("", |(_, name)| name)
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(_, known)| *known == name).map(|(repeat, _)| repeat)
    }
}

/// What is asked of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wanted {
    /// What comes when an entry has played to its end. `anew`: the open track cannot begin again as it is.
    Following {
        /// The entry's id.
        after: u64,
        /// Whether the entry itself would have to be opened again.
        anew: bool,
    },
    /// This many tracks forward from an entry, or back.
    Skip {
        /// The entry's id.
        from: u64,
        /// More than 0 is forward.
        steps: i32,
    },
    /// The track at this index of the list, or else the next one that can be played.
    Entry(usize),
    /// What plays now that the entry with this id, which was playing, was removed. Where nothing follows, that is
    /// silence with the same id.
    InPlaceOf(u64),
    /// The first track of these files, which become the list.
    Files(Vec<PathBuf>),
}

/// What a list has found.
pub enum Found {
    /// This track.
    Track(Track),
    /// The same track once more; it is open already.
    Again,
    /// Nothing follows: it was the last track.
    End,
    /// There are tracks, but none of them can be played.
    Nothing,
}

/// A list of tracks. It is asked on a thread of its own, so it may take its time.
pub trait TrackList: Send {
    /// Finds and opens a track. Every entry that had to be skipped is reported to `tell`, one sentence each.
    fn find(&mut self, wanted: &Wanted, tell: &mut dyn FnMut(String)) -> Found;

    /// Changes the order and the repeating of tracks. A new random order begins with the entry whose id is `current`.
    fn set_order(&mut self, repeat: Repeat, shuffled: bool, current: u64);

    /// Keeps `listing` true to the list from now on. A list without this shows as the track that was first.
    fn fraction(&mut self, _listing: SharedListing) {}

    /// Changes the list, while the entry with id `playing` plays, and tells `tell` what could not be done. A list
    /// without this stays as it is.
    fn edit(&mut self, _edit: &Edit, _playing: u64, _tell: &mut dyn FnMut(String)) -> Edited {
        Edited::default()
    }
}

/// A list of the one open track, which repeats in every mode but [`Repeat::Off`].
pub struct OneTrack(pub Repeat);

impl TrackList for OneTrack {
    fn find(&mut self, wanted: &Wanted, _: &mut dyn FnMut(String)) -> Found {
        match wanted {
            Wanted::Following { anew: false, .. } if self.0 != Repeat::Off => Found::Again,
            Wanted::Following { anew: false, .. } => Found::End,
            Wanted::Skip { .. } | Wanted::Entry(0) => Found::Again,
            // Only its source is known.
            _ => Found::Nothing,
        }
    }

    fn set_order(&mut self, repeat: Repeat, _: bool, _: u64) {
        self.0 = repeat;
    }
}
