//! From a key of the editor to the next picture: that picture waits a moment for the changed text, and the text comes
//! onto the stage without a trial.
//!
//! A picture that is begun while the text is read shows the old text, and takes the processors that read the new one on
//! a software renderer. So the wait makes edits show one picture earlier, and costs the show less than a picture. A
//! picture that is being drawn is given up for the same reason, but never two in turn.

use std::time::{Duration, Instant};

use super::{Cast, FirstTree, SceneStage};
use crate::faults::{self, Fault};

/// How long one go draws before the show looks whether anything has happened.
const GO: Duration = Duration::from_millis(100);
/// The same while a text is written: a key is answered at once, even if the picture takes long.
const GO_OF_EDITOR: Duration = Duration::from_millis(10);
/// How long a picture waits for a text. Most scenes are read in half of it.
const PATIENCE: Duration = Duration::from_millis(20);
/// A text that took longer than this is not waited for the next time. Drawing beside it may have doubled its time.
const SLOW: Duration = Duration::from_millis(60);
/// A scene whose last tree took longer is tried before it comes on: an edit can make a slow tree too slow.
const TREE_MAX: Duration = Duration::from_millis(50);
/// So does a distance with so many times the clauses that it had, and [`CLAUSES_MORE`].
const CLAUSES_TIMES: usize = 2;
/// See [`CLAUSES_TIMES`].
const CLAUSES_MORE: usize = 64;

/// What is known of the text that is being read.
#[derive(Debug, Default)]
pub(super) struct AwaitedEdit {
    /// When it was asked for; none if nothing is awaited.
    since: Option<Instant>,
    /// Whether the last one took long.
    is_slow: bool,
    /// Whether the last picture that was begun was given up for a changed text.
    has_interrupted: bool,
}

impl AwaitedEdit {
    fn ask(&mut self, now: Instant) {
        self.since = Some(now);
    }

    /// Notes a text that was read in so much time.
    pub(super) fn note_loaded(&mut self, took: Duration) {
        self.since = None;
        self.is_slow = took > SLOW;
    }

    /// Notes that a picture was given up for a changed text, or that one was finished.
    pub(super) fn note_picture(&mut self, was_given_up: bool) {
        self.has_interrupted = was_given_up;
    }

    /// Until when the next picture waits, if it does at `now`.
    fn until(&self, now: Instant) -> Option<Instant> {
        self.since.filter(|_| !self.is_slow).map(|since| since + PATIENCE).filter(|until| *until > now)
    }
}

impl SceneStage {
    /// Loads the scene again, because its text has changed without its file.
    pub(crate) fn load_again(&mut self) {
        tracing::debug!("{} is loaded again for its draft", self.source.title());
        self.loader.load_again();
        self.awaited_edit.ask(Instant::now());
    }

    /// Until when the next picture waits for a changed text, if it does at `now`; the present one as well, which will
    /// be given up.
    pub(crate) fn awaits_edit(&self, now: Instant) -> Option<Instant> {
        let must_be_finished = self.making.is_some() && self.awaited_edit.has_interrupted;
        self.awaited_edit.until(now).filter(|_| !must_be_finished)
    }

    /// Whether a scene waits for the picture that is being drawn, because it would be the second one in turn that a
    /// changed text breaks off: keys can come faster than pictures.
    pub(super) fn must_wait_for_the_picture(&self, coming: &Cast) -> bool {
        self.making.is_some() && self.awaited_edit.has_interrupted && self.is_version_of_shown(coming)
    }

    /// How long a picture is drawn before the show looks for keys.
    pub(super) fn length_of_go(&self) -> Duration {
        if self.is_written { GO_OF_EDITOR } else { GO }
    }

    fn is_version_of_shown(&self, cast: &Cast) -> bool {
        self.on_stage.as_ref().is_some_and(|shown| shown.source == cast.source)
    }

    /// The version of a scene that is on the stage, if the new one will be drawn as that one is, as far as can be
    /// foreseen. Where it turns out otherwise, the one before is taken back ([`SceneStage::take_back`]).
    pub(super) fn last_version(&self, cast: &Cast) -> Option<&Cast> {
        let last = self.on_stage.as_ref().filter(|_| self.is_version_of_shown(cast))?;
        let steep = |cast: &Cast| cast.resources.world().steep;
        let clauses = |cast: &Cast| cast.resources.buffers().cost.distance;
        let built = last.resources.regions();
        // A busy machine must not turn the test of this fault into one of something else.
        let is_quick = |time: Duration| time <= TREE_MAX || faults::is_wanted(Fault::SlowTree);
        let is_alike = last.tree != FirstTree::TooLong
            && built.is_some_and(|built| is_quick(built.time))
            && (steep(last) || !steep(cast))
            && clauses(cast) <= CLAUSES_TIMES * clauses(last) + CLAUSES_MORE;
        is_alike.then_some(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_waits_for_a_text_that_is_read_soon_and_for_no_other() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut edit = AwaitedEdit::default();
        assert_eq!(edit.until(start), None);
        edit.ask(start);
        assert_eq!(edit.until(at(3)), Some(at(20)));
        assert_eq!(edit.until(at(20)), None, "the show goes on");
        edit.note_loaded(Duration::from_millis(9));
        assert_eq!(edit.until(at(9)), None, "it is there");
        edit.ask(at(100));
        edit.note_loaded(Duration::from_millis(300));
        edit.ask(at(500));
        assert_eq!(edit.until(at(501)), None, "it would wait in vain");
        edit.note_loaded(Duration::from_millis(10));
        edit.ask(at(600));
        assert_eq!(edit.until(at(601)), Some(at(620)), "it has become shorter");
    }
}
