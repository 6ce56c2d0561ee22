//! The content of the overlay, and the timing of notices.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::bar::Bar;
use super::ray::RayView;
use super::welcome::Welcome;
use crate::editor::Editor;
use crate::help_panel::HelpPanel;
use crate::open_panel::OpenPanel;
use crate::overlay::NextScene;
use mariana_commands::SnapshotKeys;
use mariana_control::Slider;
use mariana_render::placement::Area;

/// Everything over the frame. Every part is optional, and the default is empty.
#[derive(Default)]
pub struct OverlayContent<'a> {
    /// A line in the lower left corner, such as "speakers · interpreted · 230 clauses".
    pub corner: Option<&'a str>,
    /// An error that stays visible as long as this field contains it.
    pub problem: Option<Problem<'a>>,
    /// A short message that fades.
    pub notice: Option<Notice<'a>>,
    /// The scene's parameters, which the user can move.
    pub params: Option<&'a [Slider]>,
    /// The snapshots of the parameters.
    pub snapshots: SnapshotRow,
    /// The table of keys.
    pub help: Option<&'a HelpPanel>,
    /// A line that stays visible as long as this field contains it.
    pub hint: Option<&'a str>,
    /// The sound sources.
    pub sources: Option<SourceList>,
    /// The welcome text after the start.
    pub welcome: Option<Welcome<'a>>,
    /// The player bar.
    pub bar: Option<Bar<'a>>,
    /// The open panel, except those below.
    pub panel: Option<&'a OpenPanel>,
    /// The scene editor.
    pub editor: Option<&'a Editor>,
    /// The parameter for which a control is being learned.
    pub learning: Option<&'a str>,
    /// The entries of the show.
    pub cues: Option<CueSheet>,
    /// The strip of two decks.
    pub decks: Option<DeckStrip>,
    /// The area of the small frame in a control window; `None` in other windows.
    pub picture: Option<Area>,
    /// The next scene of the show.
    pub next: Option<&'a NextScene>,
    /// The diagram of the ray under the pointer.
    pub ray: Option<&'a RayView>,
    /// Fills the window with a calm background, while there is no frame.
    pub calm: bool,
    /// Heights of the sound's bands on the calm background, 0..1.
    pub bands: &'a [f32],
    /// True if the pointer is hidden over the frame.
    pub hides_pointer: bool,
}

/// The snapshots of a scene's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct SnapshotRow {
    /// For each number, from 1, whether its snapshot has been taken.
    pub taken: [bool; SNAPSHOTS],
    /// The effect of the numbers.
    pub keys: SnapshotKeys,
}

/// Number of snapshots of a scene.
pub const SNAPSHOTS: usize = 8;

/// The sound sources.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct SourceList {
    /// Names of the sources, in the order in which the key steps through them.
    pub names: Vec<String>,
    /// The index of the present source.
    pub present: Option<usize>,
}

/// The entries of a show.
#[derive(Debug, Clone, PartialEq)]
pub struct CueSheet {
    /// The entries, in the order of the show file.
    pub rows: Arc<Vec<CueRow>>,
    /// Index of the entry that is shown.
    pub current: Option<usize>,
}

/// An entry of a show.
#[derive(Debug, Clone, PartialEq)]
pub struct CueRow {
    /// The moment as a show file has it, such as `section B + 2 bars`.
    pub moment: String,
    /// The start in seconds of the song; `None` while the entry waits, or if the song lacks its moment.
    pub start: Option<f64>,
    /// True if the entry waits for a press of the cue key.
    pub waits: bool,
    /// The scene and its camera.
    pub scene: String,
}

/// Two decks with a crossfader.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckStrip {
    /// The decks.
    pub decks: [Deck; 2],
    /// Position of the crossfader: 0 shows the first deck, 1 the second.
    pub crossfade: f32,
    /// Names of the ways to mix.
    pub mixes: Vec<&'static str>,
    /// Index of the present way to mix.
    pub mix: usize,
}

/// One of two decks.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Deck {
    /// The letter of the deck.
    pub letter: char,
    /// Title of the scene.
    pub title: String,
    /// True if sliders and controllers change this deck's scene.
    pub is_in_hand: bool,
    /// True if the next frame can show the scene.
    pub is_ready: bool,
}

/// A compiler's messages.
#[derive(Debug, Clone, Copy, Hash)]
pub struct Problem<'a> {
    /// One line, such as "spheres.scene has mistakes; the last good scene stays".
    pub heading: &'a str,
    /// The diagnostics as plain text for a terminal, from [`mariana_field::lang::render_all`] without colours.
    pub text: &'a str,
}

/// A short message that fades. The same text with a later `since` appears again.
#[derive(Debug, Clone, Copy)]
pub struct Notice<'a> {
    /// The text, such as "compiled".
    pub text: &'a str,
    /// A value, 0..1, shown as a bar below the text: the position in the track, or the volume.
    pub fraction: Option<f32>,
    /// The time at which the message appeared.
    pub since: Instant,
}

const NOTICE_STANDS: Duration = Duration::from_millis(1_600);
/// Reading time for each character.
const CHARACTER_STANDS: Duration = Duration::from_millis(55);
const NOTICE_STANDS_MAX: Duration = Duration::from_secs(9);
const NOTICE_FADES: Duration = Duration::from_millis(500);

impl Notice<'_> {
    pub(super) fn opacity(&self, now: Instant) -> f32 {
        let fading = now.saturating_duration_since(self.since).saturating_sub(self.stands());
        1.0 - (fading.as_secs_f32() / NOTICE_FADES.as_secs_f32()).min(1.0)
    }

    pub(super) fn next_change(&self, now: Instant) -> Option<Instant> {
        (self.opacity(now) > 0.0).then(|| now.max(self.since + self.stands()))
    }

    fn stands(&self) -> Duration {
        let characters = u32::try_from(self.text.chars().count()).unwrap_or(u32::MAX);
        CHARACTER_STANDS.saturating_mul(characters).clamp(NOTICE_STANDS, NOTICE_STANDS_MAX)
    }

    /// True once the notice has faded.
    pub fn is_gone(&self, now: Instant) -> bool {
        self.opacity(now) <= 0.0
    }
}

impl<'a> OverlayContent<'a> {
    /// Adds a notice. Of two notices, only the newer notice is shown.
    pub fn add(&mut self, notice: Option<Notice<'a>>) {
        let newer = notice.filter(|notice| self.notice.is_none_or(|other| other.since <= notice.since));
        self.notice = newer.or(self.notice);
    }
}

impl OverlayContent<'_> {
    pub(super) fn is_empty(&self, now: Instant) -> bool {
        !self.calm
            && self.corner.is_none()
            && self.problem.is_none()
            && !self.has_panels()
            && self.hint.is_none()
            && self.bar.is_none()
            && self.next.is_none()
            && self.ray.is_none()
            && self.welcome.is_none_or(|welcome| welcome.is_gone(now))
            && self.notice.is_none_or(|notice| notice.is_gone(now))
    }

    pub(super) fn is_interactive(&self) -> bool {
        self.has_panels() || self.bar.is_some_and(|bar| bar.seen)
    }

    fn has_panels(&self) -> bool {
        self.params.is_some_and(|sliders| !sliders.is_empty())
            || self.panel.is_some()
            || self.help.is_some()
            || self.sources.is_some()
            || self.editor.is_some()
            || self.cues.is_some()
            || self.decks.is_some()
    }

    /// A number that changes with the content. A notice is included until it is gone, even while it fades.
    pub(super) fn fingerprint(&self, now: Instant) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.corner, self.problem, self.help.map(|panel| (panel.query(), panel.selected))).hash(&mut hasher);
        (self.hint, &self.sources, self.calm).hash(&mut hasher);
        self.welcome.filter(|welcome| !welcome.is_gone(now)).hash(&mut hasher);
        (self.bar, self.hides_pointer, self.panel, self.learning).hash(&mut hasher);
        self.editor.map(|panel| panel.revision).hash(&mut hasher);
        // Numbers with a fraction have no hash, but a text.
        let notice = self.notice.filter(|notice| !notice.is_gone(now));
        format!("{:?}", (notice, &self.cues, &self.decks, self.params, self.picture)).hash(&mut hasher);
        let preview = |next: &NextScene| next.picture.as_ref().map(Arc::as_ptr);
        let next =
            self.next.map(|next| (&next.title, preview(next), [next.level, next.beat].map(f32::to_bits)));
        (next, self.ray.map(|ray| Arc::as_ptr(&ray.diagram))).hash(&mut hasher);
        self.params.is_some().then_some(self.snapshots).hash(&mut hasher);
        hasher.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::ChangedBy;

    #[test]
    fn a_notice_stays_then_fades_then_is_gone() {
        let since = Instant::now();
        let notice = Notice { text: "compiled", fraction: None, since };
        let at = |ms| since + Duration::from_millis(ms);
        assert_eq!([0, 1_600].map(|ms| notice.opacity(at(ms))), [1.0, 1.0]);
        assert!((notice.opacity(at(1_850)) - 0.5).abs() < 0.01);
        assert_eq!([2_100, 9_000].map(|ms| notice.opacity(at(ms))), [0.0, 0.0]);
        assert_eq!(notice.next_change(at(100)), Some(at(1_600)));
        assert_eq!(notice.next_change(at(1_700)), Some(at(1_700)));
        assert_eq!(notice.next_change(at(2_100)), None);
        let content = || OverlayContent { notice: Some(notice), ..Default::default() };
        assert!(!content().is_empty(at(2_099)) && content().is_empty(at(2_100)));
        for (length, ms) in [(100, 5_500), (10_000, 9_000)] {
            let text = "a".repeat(length);
            let sentence = Notice { text: &text, fraction: None, since };
            assert_eq!((sentence.opacity(at(ms)), sentence.opacity(at(ms + 500))), (1.0, 0.0));
        }
    }

    #[test]
    fn different_content_has_different_fingerprints() {
        let now = Instant::now();
        let mut sliders = [Slider {
            name: "size".into(),
            value: 1.0,
            min: 0.0,
            max: 2.0,
            default: 1.0,
            changed_by: ChangedBy::Text,
            bound: None,
        }];
        let mut seen = std::collections::BTreeSet::new();
        let list = |present| SourceList { names: vec!["a".into(), "b".into()], present };
        let help = HelpPanel::default();
        let contents: [OverlayContent<'_>; 11] = [
            OverlayContent::default(),
            OverlayContent { corner: Some("a"), ..Default::default() },
            OverlayContent { corner: Some("b"), ..Default::default() },
            OverlayContent { problem: Some(Problem { heading: "a", text: "b" }), ..Default::default() },
            OverlayContent {
                notice: Some(Notice { text: "a", fraction: None, since: now }),
                ..Default::default()
            },
            OverlayContent { help: Some(&help), ..Default::default() },
            OverlayContent { picture: Some([0.5, 0.0, 1.0, 0.5]), ..Default::default() },
            OverlayContent { hint: Some("a"), ..Default::default() },
            OverlayContent { calm: true, ..Default::default() },
            OverlayContent { sources: Some(list(None)), ..Default::default() },
            OverlayContent { sources: Some(list(Some(1))), ..Default::default() },
        ];
        for (place, content) in contents.iter().enumerate() {
            assert!(
                seen.insert(content.fingerprint(now)),
                "the fingerprint of content {place} is not unique"
            );
        }
        for value in [0.5, 1.0] {
            sliders[0].value = value;
            let content = OverlayContent { params: Some(&sliders), ..Default::default() };
            assert!(
                seen.insert(content.fingerprint(now)),
                "the fingerprint of the value {value} is not unique"
            );
        }
        let later = now + Duration::from_secs(1);
        let again = OverlayContent {
            notice: Some(Notice { text: "a", fraction: None, since: later }),
            ..Default::default()
        };
        assert!(seen.insert(again.fingerprint(later)));
        assert_eq!(
            again.fingerprint(later + Duration::from_secs(5)),
            OverlayContent::default().fingerprint(now)
        );
    }
}
