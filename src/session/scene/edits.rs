//! While a scene's text is being edited, its interpreter takes fewer samples of pixels at edges.
//!
//! Most of an interpreted frame are the further samples at edges, and who edits wants to see the change. Two of them in
//! place of four save half of that, and edges are still no stairs: against 64 samples two gain more than half of what
//! four gain over none, in dB (`docs/performance.md`). Fewer samples come with a changed picture and all come back once,
//! when the text rests, so nothing flickers. A compiled program always takes all of them.

use std::time::{Duration, Instant};

use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::scene_program::Mode;

/// Further samples of pixels at edges meanwhile.
pub(crate) const SAMPLES: EdgeSamples = EdgeSamples::Two;
/// A text rests when its last change has shown for this long.
const RESTS_AFTER: Duration = Duration::from_secs(2);

/// When the scene that shows was last edited.
#[derive(Debug, Default)]
pub(super) struct Edits {
    last: Option<Instant>,
}

impl Edits {
    /// Notes that a changed text of the scene that shows took its place at `now`.
    pub(super) fn note(&mut self, now: Instant) {
        self.last = Some(now);
    }

    /// Notes that another scene shows.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }

    /// Whether pictures in `mode` are drawn with [`SAMPLES`] at `now`.
    pub(super) fn save_samples(&self, mode: Option<Mode>, now: Instant) -> bool {
        let is_recent = |last: Instant| now.saturating_duration_since(last) < RESTS_AFTER;
        mode == Some(Mode::Interpreted) && self.last.is_some_and(is_recent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERPRETED: Option<Mode> = Some(Mode::Interpreted);

    #[test]
    fn an_interpreted_scene_saves_samples_from_an_edit_until_its_text_rests() {
        let start = Instant::now();
        let at = |milliseconds: u64| start + Duration::from_millis(milliseconds);
        let mut edits = Edits::default();
        assert!(!edits.save_samples(INTERPRETED, start), "a scene that was opened is not edited");
        edits.note(start);
        assert!(edits.save_samples(INTERPRETED, start) && edits.save_samples(INTERPRETED, at(1_999)));
        assert!(!edits.save_samples(INTERPRETED, at(2_000)));
        edits.note(at(1_500));
        assert!(edits.save_samples(INTERPRETED, at(3_400)), "each edit counts anew");
        edits.forget();
        assert!(!edits.save_samples(INTERPRETED, at(1_600)), "another scene is not edited");
    }

    #[test]
    fn a_compiled_program_takes_all_samples() {
        let now = Instant::now();
        let mut edits = Edits::default();
        edits.note(now);
        assert!(!edits.save_samples(Some(Mode::Compiled), now) && !edits.save_samples(None, now));
    }
}
