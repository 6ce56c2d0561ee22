//! The list of tracks as a window shows it. The list thread writes it, and any thread may read it. Each entry has an
//! **id** that is unique as long as the list exists. An entry's index changes when entries are moved or removed, so
//! threads refer to entries by id. Only readers of the list need indices.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use super::track::TrackInfo;
use mariana_work::lock;

/// A snapshot of a list of tracks. It is in list order, even if the tracks play in another order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ListedTracks {
    /// A number that grows with every change. Lists with the same revision are the same.
    pub revision: u64,
    /// The tracks.
    pub entries: Vec<ListedTrack>,
    /// The edit that an undo would take back, such as "remove Intro"; `None` if there is none.
    pub undo: Option<Arc<str>>,
}

/// Data about a track, from the list or, once the file was opened, from the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ListedTrack {
    /// Artist and title, or the file name.
    pub name: String,
    /// Title, if the list or the opened file gives one.
    pub title: Option<String>,
    /// Artist, if the list or the opened file gives one.
    pub artist: Option<String>,
    /// Length in seconds, if known.
    pub duration: Option<f64>,
    /// The file; `None` for an embedded track.
    pub file: Option<PathBuf>,
    /// The start within the file in seconds, if the track is a part of it.
    pub start: Option<f64>,
}

/// A change of a list. Indices refer to the list after all earlier edits. Indices beyond the list are ignored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Edit {
    /// Moves the entry at index `from` to index `to`.
    Move {
        /// The old index.
        from: usize,
        /// The new index.
        to: usize,
    },
    /// Removes the entry at this index.
    Remove(usize),
    /// Appends the contents of these files, folders and playlists. If the list had ended, playback continues with them. A
    /// random order mixes them into the remaining tracks.
    Append(Vec<PathBuf>),
    /// Removes all entries.
    Clear,
    /// Takes back the last edit, or the last replacement of the list. Does nothing without an edit.
    Undo,
}

/// The effect of an edit on playback.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Edited {
    /// The ids of the removed entries.
    pub removed: Vec<u64>,
    /// True if entries were added.
    pub appended: bool,
    /// True if the playing track is not in the list, or was not before the edit, and a track of the list can replace
    /// it now.
    pub resume: bool,
}

/// A list that the list thread writes and other threads read.
#[derive(Debug, Clone, Default)]
pub struct SharedListing(Arc<Mutex<Listing>>);

#[derive(Debug, Default)]
struct Listing {
    tracks: Arc<ListedTracks>,
    /// The ids of the entries.
    ids: Vec<u64>,
}

impl SharedListing {
    /// Publishes a new list: the id and the data of each entry, and the edit that an undo would take back.
    pub fn publish(&self, entries: impl Iterator<Item = (u64, ListedTrack)>, undo: Option<Arc<str>>) {
        // Collect the entries before taking the lock, because the list may have many entries.
        let (ids, entries) = entries.unzip();
        let mut listing = lock(&self.0);
        let revision = listing.tracks.revision + 1;
        let tracks = Arc::new(ListedTracks { revision, entries, undo });
        let before = std::mem::replace(&mut *listing, Listing { tracks, ids });
        drop(listing);
        drop(before);
    }

    /// Publishes new data about entry `id`. Only one thread may publish.
    pub fn publish_entry(&self, id: u64, track: &ListedTrack) {
        let Some((index, _)) = self.place(id) else { return };
        // Copy the list before taking the lock, so that readers do not wait.
        let mut tracks = self.tracks().as_ref().clone();
        match tracks.entries.get_mut(index) {
            Some(entry) if entry != track => entry.clone_from(track),
            _ => return,
        }
        tracks.revision += 1;
        lock(&self.0).tracks = Arc::new(tracks);
    }

    /// The current list.
    pub fn tracks(&self) -> Arc<ListedTracks> {
        lock(&self.0).tracks.clone()
    }

    /// The index of entry `id` and the number of entries; `None` if the list has no such entry.
    pub fn place(&self, id: u64) -> Option<(usize, usize)> {
        let listing = lock(&self.0);
        Some((listing.ids.iter().position(|known| *known == id)?, listing.ids.len()))
    }
}

impl From<&TrackInfo> for ListedTrack {
    fn from(info: &TrackInfo) -> Self {
        let TrackInfo { name, title, artist, duration, .. } = info.clone();
        Self { name, title, artist, duration, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> ListedTrack {
        ListedTrack { name: name.into(), ..ListedTrack::default() }
    }

    #[test]
    fn a_snapshot_does_not_change() {
        let shared = SharedListing::default();
        shared.publish([(7, named("a")), (3, named("b"))].into_iter(), None);
        let held = shared.tracks();
        shared.publish_entry(3, &ListedTrack { duration: Some(5.0), ..named("B") });
        assert_eq!((held.revision, held.entries[1].name.as_str()), (1, "b"));
        let now = shared.tracks();
        assert_eq!((now.revision, now.entries[1].name.as_str()), (2, "B"));
        assert_eq!(now.entries[1].duration, Some(5.0));
        shared.publish_entry(3, &now.entries[1]);
        shared.publish_entry(8, &named("c"));
        assert!(Arc::ptr_eq(&now, &shared.tracks()));
        assert_eq!([7, 3, 8].map(|id| shared.place(id)), [Some((0, 2)), Some((1, 2)), None]);
    }
}
