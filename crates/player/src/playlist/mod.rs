//! Playlists: expand files, folders and lists to entries, order the entries, and open one entry after another.
//!
//! | module | what it does |
//! |---|---|
//! | [`gather`](mod@gather) | expands files, folders and lists to entries, within the limits; compares names |
//! | [`lists`], [`cue`], [`text`] | parse the formats and encodings of lists |
//! | [`excerpt`] | plays a part of a file as a track |
//! | [`order`] | orders entries: shuffle and repeat |
//! | [`editing`] | moves, removes and appends entries while the list plays; keeps earlier states for undo |
//!
//! **Unplayable entries never stop the show.** Every failure becomes a message (`TrackErrors`), and the list thread
//! continues with the next playable track. If no track is playable, or after 64 tracks without a frame, silence plays.
//! The window does not open if the user gave only a single unplayable file, or only lists without any entry.

mod cue;
mod editing;
mod error;
mod excerpt;
mod gather;
mod lists;
mod order;
pub(crate) mod text;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use editing::History;
pub use error::PlaylistError;
pub(crate) use excerpt::Excerpt;
pub(crate) use gather::is_audio;
pub use gather::{AUDIO_EXTENSIONS, compare as compare_names};
use gather::{PlaylistEntry, gather, is_many};
pub use lists::{Cut, Item, Kind};
use order::Order;
pub use text::Reference;

use super::decode::StreamInfo;
use super::listed::{Edit, Edited, ListedTrack, SharedListing};
use super::one_line::one_line;
use super::song::{Song, track_name};
use super::source::{FrameSource, SourceError};
use super::track::{Found, Repeat, Track, TrackInfo, TrackList, Wanted};

const TRACK_ERRORS_KEPT: usize = 20;

/// A list of entries and their order.
#[derive(Default)]
pub struct Playlist {
    slots: Vec<Arc<Slot>>,
    /// The id of the next entry. Ids are never reused.
    next_id: u64,
    order: Order,
    /// The last message about each entry, kept so that the message is not repeated.
    reported: HashMap<u64, String>,
    listing: SharedListing,
    history: History,
    /// The entry that follows when the playing track must be replaced; set by an undo.
    resume_with: Option<u64>,
}

#[derive(Clone)]
struct Slot {
    id: u64,
    entry: PlaylistEntry,
    listed: ListedTrack,
}

/// A playlist with its first track, and the errors of entries before this track.
pub struct Opened {
    /// The list.
    pub list: Playlist,
    /// The first playable track, or silence if no track is playable.
    pub first: Track,
    /// The first error messages and the last error message.
    pub track_errors: Vec<String>,
    /// True if a track can be played.
    pub playable: bool,
    /// The repeat mode.
    pub repeat: Repeat,
    /// True if the order is random.
    pub shuffled: bool,
}

impl Playlist {
    /// Opens the list of the tracks in `paths`. If the list has several tracks and all of them are unplayable, the
    /// first track is silence.
    ///
    /// # Errors
    /// Fails if the only file cannot be played, or if there are no tracks at all.
    pub fn open(paths: &[PathBuf], repeat: Repeat, shuffled: bool) -> Result<Opened, PlaylistError> {
        Self::open_at(paths, repeat, shuffled, None)
    }

    /// Opens the list like [`Playlist::open`], but starts with the entry at index `place`.
    pub fn open_at(
        paths: &[PathBuf],
        repeat: Repeat,
        shuffled: bool,
        place: Option<usize>,
    ) -> Result<Opened, PlaylistError> {
        if let [path] = paths
            && (!is_many(path) || !path.exists())
        {
            Song::File(path.clone()).open().map_err(|error| PlaylistError(error.to_string()))?;
        }
        let gathered = gather(paths);
        let track_errors = gathered.track_errors.iter().map(ToString::to_string).collect();
        let mut list = Self::new(gathered.entries);
        let wanted = place.and_then(|place| Some(list.slots.get(place)?.id));
        list.arrange(repeat, shuffled, wanted);
        let Some(first) = wanted.or_else(|| list.order.first()) else {
            let name = paths.first().map(|path| error::name_of(path)).unwrap_or_default();
            return Err(gathered
                .track_errors
                .into_iter()
                .next()
                .unwrap_or_else(|| PlaylistError::empty(&name)));
        };
        Ok(list.opened(first, track_errors, repeat, shuffled))
    }

    /// Creates a list of one song.
    pub fn of_song(song: Song, repeat: Repeat) -> Opened {
        let mut list = Self::new(vec![song.into()]);
        list.arrange(repeat, false, None);
        list.opened(0, Vec::new(), repeat, false)
    }

    /// Searches for the first playable track, starting at `first`. If no track is playable, the result is silence.
    fn opened(mut self, first: u64, mut track_errors: Vec<String>, repeat: Repeat, shuffled: bool) -> Opened {
        let kept = track_errors.len().max(TRACK_ERRORS_KEPT);
        let found = self.search(first, true, None, &mut |trouble| track_errors.push(trouble));
        // Of too many errors, the last one stays: it is the reason why no track plays.
        let more = track_errors.len().saturating_sub(kept + 1);
        if more > 1 {
            let more_in_words = format!("{more} more tracks cannot be played; check the list");
            track_errors.splice(kept..kept + more, [more_in_words]);
        }
        let (first, playable) = match found {
            Found::Track(track) => (track, true),
            _ => (Track::silence(self.index(first).unwrap_or(0), self.slots.len()).with_id(first), false),
        };
        Opened { list: self, first, track_errors, playable, repeat, shuffled }
    }

    fn new(entries: Vec<PlaylistEntry>) -> Self {
        let mut list = Self::default();
        list.append_entries(entries);
        list.order = Order::new(list.ids());
        list
    }

    fn ids(&self) -> impl Iterator<Item = u64> + use<> {
        self.slots.iter().map(|slot| slot.id).collect::<Vec<_>>().into_iter()
    }

    fn index(&self, id: u64) -> Option<usize> {
        self.slots.iter().position(|slot| slot.id == id)
    }

    fn arrange(&mut self, repeat: Repeat, shuffled: bool, first: Option<u64>) {
        self.order.set(repeat, shuffled, first, self.ids());
    }

    fn open_entry(&mut self, id: u64) -> Result<Track, SourceError> {
        let index = self.index(id).ok_or("there is no such track")?;
        let count = self.slots.len();
        let slot = self.slots.get_mut(index).ok_or("there is no such track")?;
        let track = slot.entry.open(index, count)?.with_id(id);
        let slot = Arc::make_mut(slot);
        slot.listed.name.clone_from(&track.info.name);
        slot.listed.title.clone_from(&track.info.title);
        slot.listed.artist.clone_from(&track.info.artist);
        slot.listed.duration = track.info.duration.or(slot.listed.duration);
        self.listing.publish_entry(id, &slot.listed);
        Ok(track)
    }

    /// Opens the first playable entry from `first`, forward or back, up to entry `open`. Wraps if the list repeats.
    fn search(
        &mut self,
        first: u64,
        forward: bool,
        open: Option<u64>,
        tell: &mut dyn FnMut(String),
    ) -> Found {
        let around = self.order.repeat != Repeat::Off;
        let count = self.slots.len();
        let mut next = Some(first);
        let mut failed = Vec::new();
        for _ in 0..count {
            let Some(entry) = next else { break };
            if Some(entry) == open {
                return Found::Again;
            }
            match self.open_entry(entry) {
                Ok(track) => return Found::Track(track),
                Err(error) => {
                    let error = error.to_string();
                    if self.reported.insert(entry, error.clone()).as_ref() != Some(&error) {
                        tell(error.clone());
                    }
                    failed.push(error);
                }
            }
            next = self.order.beside(entry, forward, around);
        }
        if failed.len() > 1 && failed.len() == count {
            let last = failed.pop().unwrap_or_default();
            tell(format!(
                "none of the {count} tracks can be played; check their paths; the last error was: {last}"
            ));
        }
        if next.is_none() && open.is_some() { Found::End } else { Found::Nothing }
    }

    /// Returns the entry `steps` after `from` (`from` may be removed); `None` if no step is possible without repeat.
    fn entry_after(&self, from: u64, steps: i32) -> Option<u64> {
        let around = self.order.repeat != Repeat::Off;
        let mut entry = from;
        for _ in 0..steps.unsigned_abs() {
            match self.order.beside(entry, steps > 0, around) {
                Some(beside) => entry = beside,
                None if entry == from => return None,
                None => break,
            }
        }
        Some(entry)
    }

    /// Replaces the entries by these files, if at least one of them can be played.
    fn replace(&mut self, paths: &[PathBuf], playing: u64, tell: &mut dyn FnMut(String)) -> Found {
        let gathered = gather(paths);
        gathered.track_errors.iter().for_each(|trouble| tell(trouble.to_string()));
        let mut list = Self::new(Vec::new());
        list.next_id = self.next_id;
        list.append_entries(gathered.entries);
        list.order = self.order.of(list.ids());
        let Some(first) = list.order.first() else { return Found::Nothing };
        let found = list.search(first, true, None, tell);
        if matches!(found, Found::Track(_)) {
            self.record_undo("open other tracks".to_owned(), playing);
            list.listing = self.listing.clone();
            list.history = std::mem::take(&mut self.history);
            *self = list;
            self.publish_listing();
        }
        found
    }
}

impl PlaylistEntry {
    fn open(&self, index: usize, count: usize) -> Result<Track, SourceError> {
        let decoder = self.content.song.open()?;
        let StreamInfo { name, mut title, mut artist, mut duration, scene_gain, .. } = decoder.info().clone();
        let mut source: Box<dyn FrameSource> = Box::new(decoder);
        if let Some(cut) = self.content.cut {
            source = Box::new(Excerpt::new(source, cut)?);
            title = self.tags.title.as_deref().map(one_line).or(title);
            artist = self.tags.artist.as_deref().map(one_line).or(artist);
            duration = source.duration();
        }
        let name = track_name(artist.as_deref(), title.as_deref(), &name);
        let (id, content) = (index as u64, Some(self.content.clone()));
        let info = TrackInfo { id, entry: index, count, name, title, artist, duration, scene_gain, content };
        Ok(Track { source, info: Arc::new(info) })
    }
}

impl TrackList for Playlist {
    fn find(&mut self, wanted: &Wanted, tell: &mut dyn FnMut(String)) -> Found {
        match *wanted {
            Wanted::Following { anew: false, .. } if self.order.repeat == Repeat::One => Found::Again,
            Wanted::Following { after, anew } => {
                let first = match self.order.repeat {
                    Repeat::One if self.index(after).is_some() => Some(after),
                    Repeat::One => self.order.beside(after, true, true),
                    repeat => self.order.beside(after, true, repeat == Repeat::All),
                };
                let open = (!anew).then_some(after);
                first.map_or(Found::End, |first| self.search(first, true, open, tell))
            }
            Wanted::Skip { from, steps } if !self.slots.is_empty() => {
                let entry = self.entry_after(from, steps);
                entry.map_or(Found::End, |entry| self.search(entry, steps > 0, None, tell))
            }
            Wanted::Skip { .. } => Found::Nothing,
            Wanted::Entry(index) => {
                let entry = self.slots.get(index).map(|slot| slot.id);
                entry.map_or(Found::Nothing, |entry| self.search(entry, true, None, tell))
            }
            Wanted::InPlaceOf(removed) => {
                let around = self.order.repeat != Repeat::Off;
                let resumed = self.resume_with.take().filter(|id| self.index(*id).is_some());
                let next = resumed.or_else(|| self.order.beside(removed, true, around));
                match next.map_or(Found::End, |next| self.search(next, true, None, tell)) {
                    Found::Track(track) => Found::Track(track),
                    _ => Found::Track(Track::silence(0, self.slots.len()).with_id(removed)),
                }
            }
            Wanted::Files { ref files, playing } => self.replace(files, playing, tell),
        }
    }

    fn set_order(&mut self, repeat: Repeat, shuffled: bool, current: u64) {
        self.arrange(repeat, shuffled, Some(current));
    }

    fn fill_listing(&mut self, listing: SharedListing) {
        self.listing = listing;
        self.publish_listing();
    }

    fn edit(&mut self, edit: &Edit, playing: u64, tell: &mut dyn FnMut(String)) -> Edited {
        match *edit {
            Edit::Move { from, to } => self.move_entry(from, to, playing),
            Edit::Remove(entry) => self.remove(entry, playing),
            Edit::Append(ref paths) => self.append(paths, playing, tell),
            Edit::Clear => self.clear(playing),
            Edit::Undo => self.undo(playing),
        }
    }
}

#[cfg(test)]
mod tests;
