//! What there is to report about the tracks: sentences that appear over the picture, one after the other.

use std::collections::VecDeque;
use std::time::Instant;

use super::overlay::Notice;
use crate::export::print::tell;
use mariana_player::track::{Repeat, TrackInfo};
use mariana_player::{PlayerStatus, Troubles, Unheard};

/// Most sentences that wait; if there are more, the oldest are dropped.
const WAITING_MAX: usize = 3;

/// See the module.
#[derive(Default)]
pub(super) struct Announcer {
    waiting: VecDeque<String>,
    shown: Option<(String, Instant)>,
    troubles: u64,
    unheard: u64,
    track: Option<(usize, String)>,
}

impl Announcer {
    /// Shows `text` as soon as the present sentence is gone.
    pub(super) fn say(&mut self, text: String) {
        if self.waiting.len() == WAITING_MAX {
            self.waiting.pop_front();
        }
        self.waiting.push_back(text);
    }

    /// Shows `text` at once.
    pub(super) fn answer(&mut self, text: String) {
        self.shown = Some((text, Instant::now()));
    }

    /// Reports what is new: problems and what was not heard (on the terminal too), and a change of track.
    pub(super) fn look(&mut self, status: &PlayerStatus) {
        self.look_at_troubles(&status.troubles);
        self.look_at_unheard(status.unheard);
        let track = (status.track.entry, status.track.name.clone());
        if self.track.as_ref() != Some(&track) {
            // The track that plays at the start is in the title, and was asked for.
            if self.track.is_some() || status.track.count > 1 {
                self.say(described(&status.track));
            }
            self.track = Some(track);
        }
    }

    fn look_at_troubles(&mut self, troubles: &Troubles) {
        let new = troubles.count - self.troubles.min(troubles.count);
        let Some(last) = troubles.last.as_ref().filter(|_| new > 0) else { return };
        self.troubles = troubles.count;
        let text = match new {
            1 => last.clone(),
            _ => format!("{new} problems with tracks, the last one: {last}"),
        };
        tell(&text);
        self.say(text);
    }

    fn look_at_unheard(&mut self, unheard: Unheard) {
        if unheard.count != self.unheard {
            self.unheard = unheard.count;
            let text = format!("{unheard}: the sound device changed");
            tell(&text);
            self.say(text);
        }
    }

    /// Makes room for the sentences that wait.
    pub(super) fn update(&mut self, now: Instant) {
        if self.notice().is_none_or(|notice| notice.is_gone(now)) {
            self.shown = self.waiting.pop_front().map(|text| (text, now));
        }
    }

    /// What shows.
    pub(super) fn notice(&self) -> Option<Notice<'_>> {
        self.shown.as_ref().map(|(text, since)| Notice { text, since: *since })
    }
}

/// A track in words: its name, and its place among several.
fn described(track: &TrackInfo) -> String {
    match track.count {
        0 | 1 => track.name.clone(),
        count => format!("{} · {} of {count}", track.name, track.entry + 1),
    }
}

/// The next repeat mode.
pub(super) fn next_repeat(repeat: Repeat) -> Repeat {
    match repeat {
        Repeat::All => Repeat::One,
        Repeat::One => Repeat::Off,
        Repeat::Off => Repeat::All,
    }
}

/// In which order tracks play.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TrackOrder {
    /// What follows the last track, and each one.
    pub repeat: Repeat,
    /// Whether the order is random.
    pub shuffled: bool,
}

/// A change of order in words: the repeat mode or the random order, whichever is new.
pub(super) fn words_of(before: TrackOrder, after: TrackOrder) -> &'static str {
    match (before.shuffled, after.shuffled) {
        (false, true) => "tracks in random order",
        (true, false) => "tracks in list order",
        _ => match after.repeat {
            Repeat::All => "repeat all tracks",
            Repeat::One => "repeat this track",
            Repeat::Off => "end after the last track",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn text(announcer: &Announcer) -> Option<&str> {
        announcer.shown.as_ref().map(|(text, _)| text.as_str())
    }

    #[test]
    fn what_was_not_heard_is_told_once() {
        let mut announcer = Announcer::default();
        let unheard = |count, seconds| Unheard { count, seconds };
        announcer.look_at_unheard(unheard(0, 0.0));
        assert_eq!(announcer.waiting, [""; 0]);
        announcer.look_at_unheard(unheard(1, 0.42));
        announcer.look_at_unheard(unheard(1, 0.42));
        assert_eq!(announcer.waiting, ["0.42 s of the song were not heard: the sound device changed"]);
    }

    #[test]
    fn sentences_wait_for_each_other_and_floods_are_counted() {
        let mut announcer = Announcer::default();
        let troubles = |count| Troubles { count, last: Some("x is gone".into()) };
        announcer.look_at_troubles(&troubles(1));
        announcer.look_at_troubles(&troubles(1));
        announcer.look_at_troubles(&troubles(400));
        let mut now = Instant::now();
        announcer.update(now);
        assert_eq!(text(&announcer), Some("x is gone"));
        announcer.update(now + Duration::from_millis(100));
        assert_eq!(text(&announcer), Some("x is gone"));
        now += Duration::from_secs(10);
        announcer.update(now);
        assert_eq!(text(&announcer), Some("399 problems with tracks, the last one: x is gone"));
        (0..9).for_each(|n| announcer.say(n.to_string()));
        now += Duration::from_secs(10);
        announcer.update(now);
        assert_eq!(text(&announcer), Some("6"));
        announcer.answer("now".into());
        assert_eq!(text(&announcer), Some("now"));
    }
}
