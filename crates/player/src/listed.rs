//! The list of tracks as a window shows it: what the list thread tells, and any thread reads.
//!
//! An entry has a number of its own, its **id**, as long as the list lives: its index changes when entries are moved
//! or removed. Threads speak of entries by their ids, and only who looks at the list needs indices.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::track::TrackInfo;

/// A list of tracks at a moment, in the list's own order, however it is played.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ListedTracks {
    /// Grows with every change; the same revision is the same list.
    pub revision: u64,
    /// The tracks.
    pub entries: Vec<ListedTrack>,
}

/// What a list tells about a track without opening its file, or knows because it has been opened.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedTrack {
    /// Artist and title, or the file's name.
    pub name: String,
    /// Length in seconds, if known.
    pub duration: Option<f64>,
    /// The file; none for a track inside the program.
    pub file: Option<PathBuf>,
    /// Where in the file it begins, in seconds, if it is a part of it.
    pub start: Option<f64>,
}

/// A change of a list. Indices are those of the list after all changes before; others than those are ignored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Edit {
    /// Move the entry at `from` so that it is at `to`.
    Move {
        /// Its index.
        from: usize,
        /// Its index afterwards.
        to: usize,
    },
    /// Remove the entry with this index.
    Remove(usize),
    /// Append what these files, folders and lists hold.
    Append(Vec<PathBuf>),
}

/// What a change of a list means for what plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Edited {
    /// The id of the entry that was removed.
    pub removed: Option<u64>,
    /// Whether there are entries more than before.
    pub appended: bool,
    /// Whether what plays is no entry any more, but something can play in its place now.
    pub resume: bool,
}

/// The list that is shared with whoever looks at it; see the module.
#[derive(Debug, Clone, Default)]
pub struct SharedListing(Arc<Mutex<Listing>>);

#[derive(Debug, Default)]
struct Listing {
    tracks: Arc<ListedTracks>,
    /// The index of each entry, by its id.
    places: HashMap<u64, usize>,
}

impl SharedListing {
    /// Tells another list: the ids of its entries, and what is known about them.
    pub fn tell(&self, entries: impl Iterator<Item = (u64, ListedTrack)>) {
        // Made before the list is locked, because there may be very many.
        let mut places = HashMap::new();
        let entries: Vec<ListedTrack> = entries
            .enumerate()
            .map(|(index, (id, track))| {
                places.insert(id, index);
                track
            })
            .collect();
        let mut listing = self.lock();
        let revision = listing.tracks.revision + 1;
        let before = std::mem::replace(
            &mut *listing,
            Listing { tracks: Arc::new(ListedTracks { revision, entries }), places },
        );
        drop(listing);
        drop(before);
    }

    /// Tells what is known about entry `id` now. Only one thread may tell.
    pub fn tell_entry(&self, id: u64, track: &ListedTrack) {
        let Some((index, _)) = self.place(id) else { return };
        // Copied while nobody has to wait for it.
        let mut tracks = self.tracks().as_ref().clone();
        match tracks.entries.get_mut(index) {
            Some(entry) if entry != track => entry.clone_from(track),
            _ => return,
        }
        tracks.revision += 1;
        self.lock().tracks = Arc::new(tracks);
    }

    /// The list.
    pub fn tracks(&self) -> Arc<ListedTracks> {
        self.lock().tracks.clone()
    }

    /// The index of entry `id`, and how many entries there are; none if it is no entry of the list.
    pub fn place(&self, id: u64) -> Option<(usize, usize)> {
        let listing = self.lock();
        Some((*listing.places.get(&id)?, listing.tracks.entries.len()))
    }

    fn lock(&self) -> MutexGuard<'_, Listing> {
        // A thread that failed while it held the list leaves it usable.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl From<&TrackInfo> for ListedTrack {
    fn from(info: &TrackInfo) -> Self {
        Self { name: info.name.clone(), duration: info.duration, file: None, start: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> ListedTrack {
        ListedTrack { name: name.into(), duration: None, file: None, start: None }
    }

    #[test]
    fn a_list_that_somebody_holds_stays_as_it_was() {
        let shared = SharedListing::default();
        shared.tell([(7, named("a")), (3, named("b"))].into_iter());
        let held = shared.tracks();
        shared.tell_entry(3, &ListedTrack { duration: Some(5.0), ..named("B") });
        assert_eq!((held.revision, held.entries[1].name.as_str()), (1, "b"));
        let now = shared.tracks();
        assert_eq!((now.revision, now.entries[1].name.as_str()), (2, "B"));
        assert_eq!(now.entries[1].duration, Some(5.0));
        // What is known already, and what is no entry, change nothing.
        shared.tell_entry(3, &now.entries[1]);
        shared.tell_entry(8, &named("c"));
        assert!(Arc::ptr_eq(&now, &shared.tracks()));
        assert_eq!([7, 3, 8].map(|id| shared.place(id)), [Some((0, 2)), Some((1, 2)), None]);
    }
}
