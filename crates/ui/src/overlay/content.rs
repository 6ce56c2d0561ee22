//! What the overlay is asked to show, and for how long a notice stays.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::{Duration, Instant};

use super::bar::Bar;
use super::tracks::Tracks;
use super::welcome::Welcome;
use crate::controllers_panel::ControllersPanel;
use crate::corner_handles::CornerHandles;
use crate::editor::Editor;
use crate::file_browser::FileBrowser;
use crate::overlay::NextScene;
use crate::scene_browser::SceneBrowser;
use crate::settings_panel::SettingsPanel;
use mariana_control::Slider;
use mariana_render::placement::Area;

/// What is shown over the picture; every part is optional, and by default there is none.
#[derive(Debug, Default)]
pub struct OverlayContent<'a> {
    /// A line in the lower left corner, such as "speakers · interpreted · 230 clauses".
    pub corner: Option<&'a str>,
    /// What is wrong; stays for as long as it is given.
    pub problem: Option<Problem<'a>>,
    /// A short line that fades.
    pub notice: Option<Notice<'a>>,
    /// Sliders of the scene's parameters, which the user moves.
    pub params: Option<&'a mut [Slider]>,
    /// The table of keys.
    pub help: bool,
    /// A line that stays for as long as it is given.
    pub hint: Option<&'a str>,
    /// What can be listened to.
    pub sources: Option<SourceList>,
    /// The words at the start.
    pub welcome: Option<Welcome<'a>>,
    /// The bar with the buttons.
    pub bar: Option<Bar<'a>>,
    /// The list of tracks.
    pub tracks: Option<Tracks<'a>>,
    /// The list of scenes.
    pub scenes: Option<&'a SceneBrowser>,
    /// The list of files.
    pub files: Option<&'a FileBrowser>,
    /// The settings.
    pub settings: Option<&'a SettingsPanel>,
    /// The editor.
    pub editor: Option<&'a Editor>,
    /// Knobs from outside.
    pub controllers: Option<&'a ControllersPanel>,
    /// The parameter that a knob is being learned for.
    pub learning: Option<&'a str>,
    /// The corners of the picture, while they are moved.
    pub corners: Option<CornerHandles>,
    /// The part of the window in which the picture lies small, if the window is the desk of an output.
    pub picture: Option<Area>,
    /// The scene that comes next.
    pub next: Option<&'a NextScene>,
    /// Whether the pointer is hidden while it is over the picture.
    pub hides_pointer: bool,
}

/// What can be listened to.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct SourceList {
    /// In the order of the key.
    pub names: Vec<String>,
    /// The index of the present one.
    pub present: Option<usize>,
}

/// A compiler's messages.
#[derive(Debug, Clone, Copy, Hash)]
pub struct Problem<'a> {
    /// One line, such as "spheres.scene has mistakes; the last good scene stays".
    pub heading: &'a str,
    /// The diagnostics as plain text for a terminal, as [`mariana_field::lang::render_all`] gives it without colours.
    pub text: &'a str,
}

/// A short line that fades. The same text with a later `since` starts anew.
#[derive(Debug, Clone, Copy)]
pub struct Notice<'a> {
    /// Such as "compiled".
    pub text: &'a str,
    /// A share that is drawn below the text, 0..1: of a track, or of the full volume.
    pub fraction: Option<f32>,
    /// When it came up.
    pub since: Instant,
}

/// How long a notice stays before it fades, at least, and for each of its characters.
const NOTICE_STANDS: Duration = Duration::from_millis(1_600);
/// See [`NOTICE_STANDS`].
const CHARACTER_STANDS: Duration = Duration::from_millis(55);
/// How long even the longest notice stays.
const NOTICE_STANDS_MAX: Duration = Duration::from_secs(9);
/// How long it takes to fade.
const NOTICE_FADES: Duration = Duration::from_millis(500);

impl Notice<'_> {
    /// Its opacity, 0..1.
    pub(super) fn opacity(&self, now: Instant) -> f32 {
        let fading = now.saturating_duration_since(self.since).saturating_sub(self.stands());
        1.0 - (fading.as_secs_f32() / NOTICE_FADES.as_secs_f32()).min(1.0)
    }

    /// When it will look different; never once it is gone.
    pub(super) fn next_change(&self, now: Instant) -> Option<Instant> {
        (self.opacity(now) > 0.0).then(|| now.max(self.since + self.stands()))
    }

    /// How long it stays: long enough to be read.
    fn stands(&self) -> Duration {
        let characters = u32::try_from(self.text.chars().count()).unwrap_or(u32::MAX);
        CHARACTER_STANDS.saturating_mul(characters).clamp(NOTICE_STANDS, NOTICE_STANDS_MAX)
    }

    /// Whether it no longer shows.
    pub fn is_gone(&self, now: Instant) -> bool {
        self.opacity(now) <= 0.0
    }
}

impl<'a> OverlayContent<'a> {
    /// Adds another notice: the newer one shows.
    pub fn add(&mut self, notice: Option<Notice<'a>>) {
        let newer = notice.filter(|notice| self.notice.is_none_or(|other| other.since <= notice.since));
        self.notice = newer.or(self.notice);
    }
}

impl OverlayContent<'_> {
    /// Whether nothing shows.
    pub(super) fn is_empty(&self, now: Instant) -> bool {
        self.corner.is_none()
            && self.problem.is_none()
            && !self.has_params()
            && !self.help
            && self.hint.is_none()
            && self.sources.is_none()
            && self.bar.is_none()
            && self.tracks.is_none()
            && self.scenes.is_none()
            && self.files.is_none()
            && self.settings.is_none()
            && self.editor.is_none()
            && self.controllers.is_none()
            && self.corners.is_none()
            && self.next.is_none()
            && self.welcome.is_none_or(|welcome| welcome.is_gone(now))
            && self.notice.is_none_or(|notice| notice.is_gone(now))
    }

    /// Whether there are sliders.
    pub(super) fn has_params(&self) -> bool {
        self.params.as_ref().is_some_and(|sliders| !sliders.is_empty())
    }

    /// Whether the pointer can move or press something.
    pub(super) fn is_interactive(&self) -> bool {
        self.has_params()
            || self.bar.is_some_and(|bar| bar.seen)
            || self.tracks.is_some()
            || self.sources.is_some()
            || self.scenes.is_some()
            || self.files.is_some()
            || self.settings.is_some()
            || self.editor.is_some()
            || self.controllers.is_some()
            || self.corners.is_some()
    }

    /// A number that changes when something else shows. A notice counts for as long as it shows, faded or not.
    pub(super) fn fingerprint(&self, now: Instant) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.corner, self.problem, self.help).hash(&mut hasher);
        (self.hint, &self.sources).hash(&mut hasher);
        let notice = self.notice.filter(|notice| !notice.is_gone(now));
        notice.map(|notice| (notice.text, notice.since)).hash(&mut hasher);
        notice.and_then(|notice| notice.fraction).map(f32::to_bits).hash(&mut hasher);
        self.welcome.filter(|welcome| !welcome.is_gone(now)).hash(&mut hasher);
        (self.bar, self.hides_pointer).hash(&mut hasher);
        self.scenes.map(SceneBrowser::revision).hash(&mut hasher);
        self.files.map(FileBrowser::revision).hash(&mut hasher);
        self.settings.map(SettingsPanel::revision).hash(&mut hasher);
        self.editor.map(Editor::revision).hash(&mut hasher);
        (self.controllers.map(ControllersPanel::revision), self.learning).hash(&mut hasher);
        self.corners.map(|corners| corners.fingerprint()).hash(&mut hasher);
        self.next.map(|next| next.revision).hash(&mut hasher);
        self.picture.map(|area| area.map(f64::to_bits)).hash(&mut hasher);
        self.tracks.map(|tracks| (tracks.list.revision, tracks.present)).hash(&mut hasher);
        for slider in self.params.iter().flat_map(|sliders| sliders.iter()) {
            let numbers = [slider.value, slider.min, slider.max, slider.default].map(f32::to_bits);
            (&slider.name, numbers, slider.changed_by).hash(&mut hasher);
        }
        hasher.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::ChangedBy;

    #[test]
    fn a_notice_stands_then_fades_then_is_gone() {
        let since = Instant::now();
        let notice = Notice { text: "compiled", fraction: None, since };
        let at = |ms| since + Duration::from_millis(ms);
        assert_eq!([0, 1_600].map(|ms| notice.opacity(at(ms))), [1.0, 1.0]);
        assert!((notice.opacity(at(1_850)) - 0.5).abs() < 0.01);
        assert_eq!([2_100, 9_000].map(|ms| notice.opacity(at(ms))), [0.0, 0.0]);
        // It stays unchanged, then changes all the time while it fades, and never again when it is gone.
        assert_eq!(notice.next_change(at(100)), Some(at(1_600)));
        assert_eq!(notice.next_change(at(1_700)), Some(at(1_700)));
        assert_eq!(notice.next_change(at(2_100)), None);
        let content = || OverlayContent { notice: Some(notice), ..Default::default() };
        assert!(!content().is_empty(at(2_099)) && content().is_empty(at(2_100)));
        // A longer sentence stays longer, but not for ever.
        for (length, ms) in [(100, 5_500), (10_000, 9_000)] {
            let text = "a".repeat(length);
            let sentence = Notice { text: &text, fraction: None, since };
            assert_eq!((sentence.opacity(at(ms)), sentence.opacity(at(ms + 500))), (1.0, 0.0));
        }
    }

    #[test]
    fn what_shows_has_another_fingerprint_than_what_showed() {
        let now = Instant::now();
        let mut sliders = [Slider {
            name: "size".into(),
            value: 1.0,
            min: 0.0,
            max: 2.0,
            default: 1.0,
            changed_by: ChangedBy::Text,
        }];
        let mut seen = std::collections::BTreeSet::new();
        let list = |present| SourceList { names: vec!["a".into(), "b".into()], present };
        let contents: [OverlayContent<'_>; 10] = [
            OverlayContent::default(),
            OverlayContent { corner: Some("a"), ..Default::default() },
            OverlayContent { corner: Some("b"), ..Default::default() },
            OverlayContent { problem: Some(Problem { heading: "a", text: "b" }), ..Default::default() },
            OverlayContent {
                notice: Some(Notice { text: "a", fraction: None, since: now }),
                ..Default::default()
            },
            OverlayContent { help: true, ..Default::default() },
            OverlayContent { picture: Some([0.5, 0.0, 1.0, 0.5]), ..Default::default() },
            OverlayContent { hint: Some("a"), ..Default::default() },
            OverlayContent { sources: Some(list(None)), ..Default::default() },
            OverlayContent { sources: Some(list(Some(1))), ..Default::default() },
        ];
        for content in &contents {
            assert!(seen.insert(content.fingerprint(now)), "{content:?} is taken for another");
        }
        for value in [0.5, 1.0] {
            sliders[0].value = value;
            let content = OverlayContent { params: Some(&mut sliders), ..Default::default() };
            assert!(seen.insert(content.fingerprint(now)), "{content:?} is taken for another");
        }
        // The same words again count as new, and a notice that is gone does not count.
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
