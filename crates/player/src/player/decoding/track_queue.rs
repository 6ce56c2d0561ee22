//! The queue of tracks: the decoding thread's requests to the list thread, and the answers.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;

use super::passages::Passages;
use crate::listed::{Edit, Edited};
use crate::player::listing::{Request, SharedTrackErrors};
use crate::track::{Found, Repeat, Track, TrackInfo, Wanted};

/// Number of successive empty tracks after which silence is played.
const EMPTY_TRACKS_MAX: u32 = 64;

enum Next {
    Unasked,
    Asked(u64),
    Known(Found),
}

pub(super) struct TrackQueue {
    pub(super) passages: Passages,
    next: Next,
    /// The id of the pending request for a skip.
    pub(super) skipping: Option<u64>,
    /// The number of skips since this request, which are requested next; negative for skips back.
    steps: i32,
    empty_tracks: u32,
    list: Sender<Request>,
    last_request: u64,
    track_errors: SharedTrackErrors,
}

impl TrackQueue {
    pub(super) fn new(first: Track, list: Sender<Request>, track_errors: SharedTrackErrors) -> Self {
        Self {
            passages: Passages::new(first),
            next: Next::Unasked,
            skipping: None,
            steps: 0,
            empty_tracks: 0,
            list,
            last_request: 0,
            track_errors,
        }
    }

    pub(super) fn opened_ahead(&self) -> Option<&Arc<TrackInfo>> {
        match &self.next {
            Next::Known(Found::Track(track)) => Some(&track.info),
            _ => None,
        }
    }

    pub(super) fn skip(&mut self, forward: bool) {
        self.steps += if forward { 1 } else { -1 };
    }

    /// Requests the track to which the pending skips lead from passage `audible`. Does nothing during such a request.
    pub(super) fn request_skips(&mut self, audible: u64) {
        if self.steps != 0 && self.skipping.is_none() {
            let steps = std::mem::take(&mut self.steps);
            let from = self.passages.entry_in(audible);
            self.skipping = self.request(Wanted::Skip { from, steps });
        }
    }

    /// Requests the first of these files, which replace the list. Pending skips of the old list are dropped.
    pub(super) fn request_files(&mut self, files: Vec<PathBuf>, audible: u64) {
        let playing = self.passages.entry_in(audible);
        (self.skipping, self.steps) = (self.request(Wanted::Files { files, playing }), 0);
    }

    /// Requests the track at this index of the list. Older skips that are still pending are dropped.
    pub(super) fn request_entry(&mut self, entry: usize) {
        (self.skipping, self.steps) = (self.request(Wanted::Entry(entry)), 0);
    }

    pub(super) fn edit(&mut self, edit: Edit, audible: u64) {
        let playing = self.passages.entry_in(audible);
        // If the list thread has ended, the list stays unchanged.
        let _ = self.list.send(Request::Edit { edit, playing });
    }

    /// Handles an answer to an edit while passage `audible` is heard. `ended` is true if the segment is fully decoded.
    /// Returns true if a track that had begun was removed. Then a new segment must begin at the audible position.
    pub(super) fn apply_edit(&mut self, edited: Edited, audible: u64, ended: bool) -> bool {
        let playing = self.passages.entry_in(audible);
        if edited.removed.contains(&playing) || edited.resume {
            self.skipping = self.request(Wanted::InPlaceOf(playing));
            return false;
        }
        let ahead = edited.removed.iter().any(|removed| self.passages.has_begun(*removed, audible));
        if ahead {
            self.return_to(audible);
        }
        // The track opened ahead may no longer be next. A change of order does not restart a list that has ended. But
        // the list continues if tracks were appended or a request for the next track is not answered yet.
        let goes_on = !ended || edited.appended || matches!(self.next, Next::Asked(_));
        self.next = Next::Unasked;
        if goes_on {
            self.request_following(false);
        }
        ahead
    }

    pub(super) fn set_order(&mut self, repeat: Repeat, shuffled: bool) {
        let current = self.passages.track().info.id;
        // If the list thread has ended, no further track follows.
        let _ = self.list.send(Request::Order { repeat, shuffled, current });
        self.request_following(false);
    }

    pub(super) fn request_ahead(&mut self) {
        if matches!(self.next, Next::Unasked) {
            self.request_following(false);
        }
    }

    /// Handles the list thread's answer to request `id`. `ended` is true if the segment is fully decoded. Returns true
    /// if the current track must begin in a new segment; the answer may have changed the current track.
    pub(super) fn receive(&mut self, id: u64, found: Found, ended: bool) -> bool {
        if self.skipping == Some(id) {
            self.skipping = None;
            match found {
                Found::Track(track) => self.replace_with(track),
                Found::Again => {}
                Found::End => {
                    self.track_errors.report("the list ends here; turn on repeat to play it again".into());
                    return false;
                }
                // The list has reported the errors already.
                Found::Nothing => return false,
            }
            return true;
        }
        if !matches!(self.next, Next::Asked(asked) if asked == id) {
            return false;
        }
        self.next = match found {
            // The list had ended, but continues because repeat was turned on.
            Found::Track(track) if ended => {
                self.replace_with(track);
                return true;
            }
            Found::Nothing => Next::Known(Found::Track(self.silence())),
            found => Next::Known(found),
        };
        // The track repeats from now on, each time it ends.
        ended && matches!(self.next, Next::Known(Found::Again))
    }

    /// Returns what follows the current track, if it is known already. A track that follows itself is at its start.
    pub(super) fn following(&mut self, empty: bool) -> Option<Found> {
        match std::mem::replace(&mut self.next, Next::Unasked) {
            Next::Unasked => self.request_following(false),
            Next::Asked(id) => self.next = Next::Asked(id),
            Next::Known(Found::Again) if empty => self.request_following(true),
            Next::Known(Found::Again) => match self.passages.source().seek(0.0) {
                Ok(_) => {
                    self.next = Next::Known(Found::Again);
                    return Some(Found::Again);
                }
                Err(error) => {
                    self.track_errors.report(error.to_string());
                    self.request_following(true);
                }
            },
            Next::Known(Found::Track(track)) => {
                self.empty_tracks = if empty { self.empty_tracks + 1 } else { 0 };
                if self.empty_tracks > EMPTY_TRACKS_MAX {
                    self.track_errors.report("these tracks contain no sound; choose other tracks".into());
                    return Some(Found::Track(self.silence()));
                }
                return Some(Found::Track(track));
            }
            Next::Known(Found::End | Found::Nothing) => {
                self.next = Next::Known(Found::End);
                return Some(Found::End);
            }
        }
        None
    }

    /// Goes back to the track of `passage` if a later track has begun. The caller must begin a new segment.
    pub(super) fn return_to(&mut self, passage: u64) {
        if let Some(mut later) = self.passages.return_to(passage) {
            let is_usable = later.source.seek(0.0).is_ok();
            self.next = if is_usable { Next::Known(Found::Track(later)) } else { Next::Unasked };
        }
    }

    fn replace_with(&mut self, track: Track) {
        self.passages.replace_with(track);
        self.empty_tracks = 0;
        self.request_following(false);
    }

    fn silence(&self) -> Track {
        let info = &self.passages.track().info;
        Track::silence(info.entry, info.count).with_id(info.id)
    }

    /// Requests the track after the current track. `anew` is true if the current track must be opened again to repeat.
    fn request_following(&mut self, anew: bool) {
        let after = self.passages.track().info.id;
        let asked = self.request(Wanted::Following { after, anew });
        self.next = asked.map_or(Next::Known(Found::End), Next::Asked);
    }

    fn request(&mut self, wanted: Wanted) -> Option<u64> {
        self.last_request += 1;
        let id = self.last_request;
        self.list.send(Request::Find { id, wanted }).ok().map(|()| id)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;

    fn queue() -> (TrackQueue, Receiver<Request>) {
        let (list, requests) = channel();
        (TrackQueue::new(Track::silence(0, 9), list, SharedTrackErrors::default()), requests)
    }

    fn asked(requests: &Receiver<Request>) -> (u64, Wanted) {
        let find = |request| match request {
            Request::Find { id, wanted } => Some((id, wanted)),
            Request::Order { .. } | Request::Edit { .. } => None,
        };
        requests.try_iter().filter_map(find).last().expect("a request")
    }

    #[test]
    fn skips_during_a_search_are_merged() {
        let (mut queue, requests) = queue();
        queue.skip(true);
        queue.request_skips(0);
        let (first, wanted) = asked(&requests);
        assert_eq!(wanted, Wanted::Skip { from: 0, steps: 1 });
        for forward in [true, true, true, false] {
            queue.skip(forward);
            queue.request_skips(0);
        }
        assert!(requests.try_iter().next().is_none(), "a search is running already");
        assert!(queue.receive(first, Found::Track(Track::silence(1, 9)), false));
        queue.request_skips(queue.passages.current());
        assert_eq!(asked(&requests).1, Wanted::Skip { from: 1, steps: 2 });
    }

    #[test]
    fn an_outdated_answer_changes_nothing() {
        let (mut queue, requests) = queue();
        queue.request_ahead();
        let (old, _) = asked(&requests);
        queue.set_order(Repeat::Off, false);
        let (new, _) = asked(&requests);
        assert!(!queue.receive(old, Found::Track(Track::silence(5, 9)), false));
        assert!(queue.following(false).is_none());
        assert!(!queue.receive(new, Found::Track(Track::silence(3, 9)), false));
        let Some(Found::Track(track)) = queue.following(false) else { panic!("a track follows") };
        assert_eq!(track.info.entry, 3);
    }

    #[test]
    fn an_ended_list_continues_when_repeat_is_turned_on() {
        let (mut queue, requests) = queue();
        queue.request_ahead();
        assert!(!queue.receive(asked(&requests).0, Found::End, false));
        assert!(matches!(queue.following(false), Some(Found::End)));
        assert!(matches!(queue.following(false), Some(Found::End)), "the end stays the end");
        queue.set_order(Repeat::All, false);
        assert!(queue.receive(asked(&requests).0, Found::Track(Track::silence(4, 9)), true));
        assert_eq!(queue.passages.track().info.entry, 4);
    }

    #[test]
    fn an_ended_list_continues_after_an_append_despite_other_edits() {
        let (mut queue, requests) = queue();
        queue.request_ahead();
        queue.receive(asked(&requests).0, Found::End, false);
        assert!(matches!(queue.following(false), Some(Found::End)));
        let removed = |id| Edited { removed: vec![id], ..Edited::default() };
        assert!(!queue.apply_edit(removed(7), 0, true));
        assert!(requests.try_iter().next().is_none(), "the removal of an entry restarts the list");
        assert!(!queue.apply_edit(Edited { appended: true, ..Edited::default() }, 0, true));
        let early = asked(&requests).0;
        assert!(!queue.apply_edit(removed(8), 0, true));
        assert!(!queue.receive(early, Found::Track(Track::silence(8, 9)), true), "that one was removed");
        assert!(queue.receive(asked(&requests).0, Found::Track(Track::silence(5, 9)), true));
        assert_eq!(queue.passages.track().info.entry, 5);
    }

    #[test]
    fn an_ended_song_repeats_more_than_once() {
        let (mut queue, requests) = queue();
        queue.request_ahead();
        queue.receive(asked(&requests).0, Found::End, false);
        assert!(matches!(queue.following(false), Some(Found::End)));
        queue.set_order(Repeat::One, false);
        assert!(queue.receive(asked(&requests).0, Found::Again, true));
        assert!(matches!(queue.following(false), Some(Found::Again)));
        assert!(matches!(queue.following(false), Some(Found::Again)));
    }

    #[test]
    fn tracks_without_sound_are_given_up_and_reported() {
        let (mut queue, requests) = queue();
        let next = |queue: &mut TrackQueue| {
            queue.request_ahead();
            queue.receive(asked(&requests).0, Found::Track(Track::silence(8, 9)), false);
            let Some(Found::Track(track)) = queue.following(true) else { panic!("a track follows") };
            queue.passages.follow_with(track);
        };
        (0..EMPTY_TRACKS_MAX).for_each(|_| next(&mut queue));
        assert_eq!(queue.track_errors.get().count, 0);
        next(&mut queue);
        assert_eq!(queue.track_errors.get().count, 1);
        assert_eq!(queue.passages.track().info.name, "nothing to play");
    }

    #[test]
    fn a_skip_past_the_end_is_reported_and_changes_nothing() {
        let (mut queue, requests) = queue();
        queue.skip(true);
        queue.request_skips(0);
        assert!(!queue.receive(asked(&requests).0, Found::End, false));
        assert!(queue.skipping.is_none());
        assert!(queue.track_errors.get().last.expect("an error").contains("ends here"));
    }

    #[test]
    fn without_a_list_thread_no_track_follows() {
        let (mut queue, requests) = queue();
        drop(requests);
        queue.request_ahead();
        assert!(matches!(queue.following(false), Some(Found::End)));
    }
}
