//! What plays and what comes next: the decoding thread's side of its talk with the list thread.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;

use super::passages::Passages;
use crate::listed::{Edit, Edited};
use crate::player::listing::{Request, SharedTrackErrors};
use crate::track::{Found, Repeat, Track, TrackInfo, Wanted};

/// After this many tracks in a row without a frame, silence is played.
const EMPTY_TRACKS_MAX: u32 = 64;

/// What comes after the track that is being decoded.
enum Next {
    Unasked,
    /// The list thread is looking for it, as this request.
    Asked(u64),
    Again,
    Track(Track),
    End,
}

/// How it goes on where a track has ended.
pub(super) enum Following {
    /// The list thread has not said yet.
    Unknown,
    /// With the same track, which stands at its start again.
    Again,
    /// With this one, which stands at its start.
    Track(Track),
    /// Not at all.
    End,
}

/// See the module.
pub(super) struct TrackQueue {
    /// The tracks that have begun.
    pub(super) passages: Passages,
    next: Next,
    /// A skip for which the list thread is searching, as this request.
    skipping: Option<u64>,
    /// Steps of further skips that were asked for meanwhile.
    steps: i32,
    /// Tracks without a frame, in a row.
    empty_tracks: u32,
    list: Sender<Request>,
    last_request: u64,
    track_errors: SharedTrackErrors,
}

impl TrackQueue {
    /// Begins with `first`; what follows is asked of `list`, and what is wrong is told to `track_errors`.
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

    /// What is known about the track that was opened to follow the current one.
    pub(super) fn opened_ahead(&self) -> Option<&Arc<TrackInfo>> {
        match &self.next {
            Next::Track(track) => Some(&track.info),
            _ => None,
        }
    }

    /// Whether the list thread is searching for another track than the one that would follow.
    pub(super) fn is_skipping(&self) -> bool {
        self.skipping.is_some()
    }

    /// Notes that the next track was asked for, or the one before.
    pub(super) fn skip(&mut self, forward: bool) {
        self.steps += if forward { 1 } else { -1 };
    }

    /// Asks for the track to which the skips lead from the one in passage `audible`, unless another is searched for.
    pub(super) fn ask_for_skips(&mut self, audible: u64) {
        if self.steps != 0 && self.skipping.is_none() {
            let steps = std::mem::take(&mut self.steps);
            let from = self.passages.entry_in(audible);
            self.skipping = self.request(Wanted::Skip { from, steps });
        }
    }

    /// Asks for the first of these files, which become the list. Skips that were not carried out were of the old one.
    pub(super) fn ask_for_files(&mut self, files: Vec<PathBuf>) {
        (self.skipping, self.steps) = (self.request(Wanted::Files(files)), 0);
    }

    /// Asks for the track at that index of the list; skips that were not carried out were meant before.
    pub(super) fn ask_for_entry(&mut self, entry: usize) {
        (self.skipping, self.steps) = (self.request(Wanted::Entry(entry)), 0);
    }

    /// Changes the list; passage `audible` is heard.
    pub(super) fn edit(&mut self, edit: Edit, audible: u64) {
        let playing = self.passages.entry_in(audible);
        // If the list thread has ended, the list stays as it is.
        let _ = self.list.send(Request::Edit { edit, playing });
    }

    /// Takes the list thread's answer to a change of the list, while passage `audible` is heard; `ended` if nothing of
    /// the segment is left to decode. True if a track that was begun ahead is gone: a new segment must begin where the
    /// audible track is.
    pub(super) fn take_edit(&mut self, edited: Edited, audible: u64, ended: bool) -> bool {
        let playing = self.passages.entry_in(audible);
        if edited.removed == Some(playing) || edited.resume {
            self.skipping = self.request(Wanted::InPlaceOf(playing));
            return false;
        }
        let ahead = edited.removed.is_some_and(|removed| self.passages.has_begun(removed, audible));
        if ahead {
            self.go_back_to(audible);
        }
        // What was opened ahead may follow no more. A list that has ended is not begun again because its order changed.
        // One that is to go on, because an earlier change was asked about, still is.
        let goes_on = !ended || edited.appended || matches!(self.next, Next::Asked(_));
        self.next = Next::Unasked;
        if goes_on {
            self.ask(false);
        }
        ahead
    }

    /// Changes the order and the repeating of tracks.
    pub(super) fn set_order(&mut self, repeat: Repeat, shuffled: bool) {
        let current = self.passages.track().info.id;
        // If the list thread has ended, no track follows this one.
        let _ = self.list.send(Request::Order { repeat, shuffled, current });
        self.ask(false);
    }

    /// Asks for what follows the current track, unless that is known or asked for already.
    pub(super) fn ask_ahead(&mut self) {
        if matches!(self.next, Next::Unasked) {
            self.ask(false);
        }
    }

    /// Takes the list thread's answer to request `id`; `ended` if nothing of the segment is left to decode. True if
    /// the current track, which may be another now, is to begin in a new segment.
    pub(super) fn take(&mut self, id: u64, found: Found, ended: bool) -> bool {
        if self.skipping == Some(id) {
            self.skipping = None;
            match found {
                Found::Track(track) => self.replace_with(track),
                Found::Again => {}
                Found::End => {
                    self.track_errors.tell("the list ends here; switch repeating on to play it again".into());
                    return false;
                }
                // What is wrong has been reported already.
                Found::Nothing => return false,
            }
            return true;
        }
        if !matches!(self.next, Next::Asked(asked) if asked == id) {
            // The answer is no longer wanted.
            return false;
        }
        self.next = match found {
            // The list had ended but goes on after all, because repeating was asked for.
            Found::Track(track) if ended => {
                self.replace_with(track);
                return true;
            }
            Found::Again if ended => {
                // So it goes on at each of the track's ends.
                self.next = Next::Again;
                return true;
            }
            Found::Track(track) => Next::Track(track),
            Found::Again => Next::Again,
            Found::End => Next::End,
            Found::Nothing => Next::Track(self.silence()),
        };
        false
    }

    /// What follows now that the current track has ended; `empty` if it had not a single frame.
    pub(super) fn following(&mut self, empty: bool) -> Following {
        match std::mem::replace(&mut self.next, Next::Unasked) {
            Next::Unasked => self.ask(false),
            Next::Asked(id) => self.next = Next::Asked(id),
            Next::Again if empty => self.ask(true),
            Next::Again => match self.passages.source().seek(0.0) {
                Ok(_) => {
                    self.next = Next::Again;
                    return Following::Again;
                }
                Err(error) => {
                    self.track_errors.tell(error.to_string());
                    self.ask(true);
                }
            },
            Next::Track(track) => {
                self.empty_tracks = if empty { self.empty_tracks + 1 } else { 0 };
                if self.empty_tracks > EMPTY_TRACKS_MAX {
                    self.track_errors.tell("there is no sound in these tracks; choose others".into());
                    return Following::Track(self.silence());
                }
                return Following::Track(track);
            }
            Next::End => {
                self.next = Next::End;
                return Following::End;
            }
        }
        Following::Unknown
    }

    /// Makes the track of `passage` the current one again, if the next one was begun ahead. A new segment must follow.
    pub(super) fn go_back_to(&mut self, passage: u64) {
        if let Some(mut later) = self.passages.go_back_to(passage) {
            self.next = if later.source.seek(0.0).is_ok() { Next::Track(later) } else { Next::Unasked };
        }
    }

    fn replace_with(&mut self, track: Track) {
        self.passages.replace_with(track);
        self.empty_tracks = 0;
        self.ask(false);
    }

    fn silence(&self) -> Track {
        let info = &self.passages.track().info;
        Track::silence(info.entry, info.count).with_id(info.id)
    }

    /// Asks the list thread for what follows the current track; `anew` if that track would have to be opened again to
    /// repeat.
    fn ask(&mut self, anew: bool) {
        let after = self.passages.track().info.id;
        self.next = self.request(Wanted::Following { after, anew }).map_or(Next::End, Next::Asked);
    }

    /// Asks the list thread; none if that has ended.
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

    /// What was last asked for, and as which request.
    fn asked(requests: &Receiver<Request>) -> (u64, Wanted) {
        let find = |request| match request {
            Request::Find { id, wanted } => Some((id, wanted)),
            Request::Order { .. } | Request::Edit { .. } => None,
        };
        requests.try_iter().filter_map(find).last().expect("something was asked for")
    }

    #[test]
    fn skips_that_come_during_a_search_are_taken_together_after_it() {
        let (mut queue, requests) = queue();
        queue.skip(true);
        queue.ask_for_skips(0);
        let (first, wanted) = asked(&requests);
        assert_eq!(wanted, Wanted::Skip { from: 0, steps: 1 });
        for forward in [true, true, true, false] {
            queue.skip(forward);
            queue.ask_for_skips(0);
        }
        assert!(requests.try_iter().next().is_none(), "it is searched already");
        assert!(queue.take(first, Found::Track(Track::silence(1, 9)), false));
        queue.ask_for_skips(queue.passages.current());
        assert_eq!(asked(&requests).1, Wanted::Skip { from: 1, steps: 2 });
    }

    #[test]
    fn an_answer_that_is_no_longer_wanted_changes_nothing() {
        let (mut queue, requests) = queue();
        queue.ask_ahead();
        let (old, _) = asked(&requests);
        queue.set_order(Repeat::Off, false);
        let (new, _) = asked(&requests);
        assert!(!queue.take(old, Found::Track(Track::silence(5, 9)), false));
        assert!(matches!(queue.following(false), Following::Unknown));
        assert!(!queue.take(new, Found::Track(Track::silence(3, 9)), false));
        let Following::Track(track) = queue.following(false) else { panic!("a track follows") };
        assert_eq!(track.info.entry, 3);
    }

    #[test]
    fn a_list_that_has_ended_goes_on_when_it_is_to_repeat() {
        let (mut queue, requests) = queue();
        queue.ask_ahead();
        assert!(!queue.take(asked(&requests).0, Found::End, false));
        assert!(matches!(queue.following(false), Following::End));
        assert!(matches!(queue.following(false), Following::End), "the end stays the end");
        queue.set_order(Repeat::All, false);
        assert!(queue.take(asked(&requests).0, Found::Track(Track::silence(4, 9)), true));
        assert_eq!(queue.passages.track().info.entry, 4);
    }

    #[test]
    fn a_list_that_has_ended_goes_on_after_an_append_whatever_is_changed_besides() {
        let (mut queue, requests) = queue();
        queue.ask_ahead();
        queue.take(asked(&requests).0, Found::End, false);
        assert!(matches!(queue.following(false), Following::End));
        let removed = |id| Edited { removed: Some(id), ..Edited::default() };
        assert!(!queue.take_edit(removed(7), 0, true));
        assert!(requests.try_iter().next().is_none(), "it begins again because an entry was removed");
        assert!(!queue.take_edit(Edited { appended: true, ..Edited::default() }, 0, true));
        let early = asked(&requests).0;
        assert!(!queue.take_edit(removed(8), 0, true));
        assert!(!queue.take(early, Found::Track(Track::silence(8, 9)), true), "that one was removed");
        assert!(queue.take(asked(&requests).0, Found::Track(Track::silence(5, 9)), true));
        assert_eq!(queue.passages.track().info.entry, 5);
    }

    #[test]
    fn a_song_that_had_ended_was_repeated_only_once() {
        let (mut queue, requests) = queue();
        queue.ask_ahead();
        queue.take(asked(&requests).0, Found::End, false);
        assert!(matches!(queue.following(false), Following::End));
        queue.set_order(Repeat::One, false);
        assert!(queue.take(asked(&requests).0, Found::Again, true));
        assert!(matches!(queue.following(false), Following::Again));
        assert!(matches!(queue.following(false), Following::Again));
    }

    #[test]
    fn tracks_without_sound_are_given_up_and_that_is_told() {
        let (mut queue, requests) = queue();
        let next = |queue: &mut TrackQueue| {
            queue.ask_ahead();
            queue.take(asked(&requests).0, Found::Track(Track::silence(8, 9)), false);
            let Following::Track(track) = queue.following(true) else { panic!("a track follows") };
            queue.passages.follow_with(track);
        };
        (0..EMPTY_TRACKS_MAX).for_each(|_| next(&mut queue));
        assert_eq!(queue.track_errors.get().count, 0);
        next(&mut queue);
        assert_eq!(queue.track_errors.get().count, 1);
        assert_eq!(queue.passages.track().info.name, "nothing to play");
    }

    #[test]
    fn a_skip_past_the_end_stays_and_is_told() {
        let (mut queue, requests) = queue();
        queue.skip(true);
        queue.ask_for_skips(0);
        assert!(!queue.take(asked(&requests).0, Found::End, false));
        assert!(!queue.is_skipping());
        assert!(queue.track_errors.get().last.expect("it is told").contains("ends here"));
    }

    #[test]
    fn without_a_list_thread_the_track_is_the_last() {
        let (mut queue, requests) = queue();
        drop(requests);
        queue.ask_ahead();
        assert!(matches!(queue.following(false), Following::End));
    }
}
