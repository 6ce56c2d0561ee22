//! The state of the user interface over the frame: welcome text, bar, panels.

use std::sync::Arc;
use std::time::Instant;

use image::RgbaImage;

use crate::commands::Panel;
use crate::placement::Area;
use crate::scenes::SceneSource;
use crate::session::controllers::Controllers;
use crate::session::listening::Listening;
use crate::session::reports::Reports;
use crate::session::scene::SceneSession;
use crate::ui::editor::Editor;
use crate::ui::help_panel::HelpPanel;
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::{Bar, Cover, CueSheet, OverlayContent, PanelSwitches, SnapshotRow, Welcome};
use mariana_music::SongStructure;
use mariana_player::LoudnessShape;

#[derive(Default)]
pub(crate) struct UiState {
    pub(crate) panels: PanelSwitches,
    pub(super) help: HelpPanel,
    /// The shown scene, and its position in the list as text.
    pub(super) placed_scene: Option<(SceneSource, String)>,
    /// When the first words appeared after the start.
    pub(super) welcomed: Option<Instant>,
    pub(super) panel: Option<OpenPanel>,
    /// The editor keeps its texts while it is closed.
    pub(super) editor: Option<Editor>,
    /// The ends of the marked part of the track, in seconds.
    pub(super) marks: Option<[f64; 2]>,
    pub(super) snapshots: SnapshotRow,
    /// The part of the window that shows a small frame beside the panels, while an output shows the frame.
    pub(super) picture: Option<Area>,
    pub(super) hidden: Hidden,
}

/// The reasons to hide texts over the frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Hidden {
    /// The setting: hide everything except requested panels and errors.
    pub(super) by_setting: bool,
    /// The key: hide everything except panels that are opened while this is set.
    pub(super) by_key: bool,
    /// A blackout in the only window hides as much as the key.
    pub(super) by_blackout: bool,
}

impl Hidden {
    /// True if even errors are hidden.
    pub(super) fn is_bare(self) -> bool {
        self.by_key || self.by_blackout
    }
}

pub(super) struct Seen {
    /// The status line, if it is shown.
    pub(super) corner: Option<String>,
    /// True if the pointer has moved recently or is in use in a panel.
    pub(super) awake: bool,
    pub(super) assisted: bool,
    pub(super) fullscreen: bool,
    pub(super) cues: Option<CueSheet>,
    /// The cover of the track, if the bar or the welcome text is visible.
    pub(super) cover: Option<Arc<RgbaImage>>,
    /// The loudness along the track, if the bar is visible.
    pub(super) shape: Option<Arc<LoudnessShape>>,
    pub(super) follows: bool,
    /// The analysis of the track, if known and the bar is visible.
    pub(super) song: Option<Arc<SongStructure>>,
}

impl UiState {
    pub(super) fn new(clean: bool) -> Self {
        Self { hidden: Hidden { by_setting: clean, ..Hidden::default() }, ..Self::default() }
    }

    pub(super) fn is_quiet(&self) -> bool {
        self.hidden.by_setting || self.hidden.is_bare()
    }

    /// Returns what the overlay shows.
    pub(super) fn content<'a>(
        &'a self,
        seen: &'a Seen,
        scene: &'a SceneSession,
        controllers: &'a Controllers,
        listening: &'a Listening,
        reports: &'a Reports,
        now: Instant,
    ) -> OverlayContent<'a> {
        let mut content = scene.content(seen.corner.as_deref(), self.panels);
        let (open, playing) = (self.panels.open, &reports.playing);
        let scene = self.placed_scene.as_ref().map_or("", |(_, words)| words);
        content.add(reports.notice());
        content.help = Some(&self.help).filter(|_| self.panels.help);
        listening.show_in(&mut content, open == Some(Panel::Sources), now);
        content.panel = self.panel.as_ref();
        content.editor = self.editor.as_ref().filter(|_| open == Some(Panel::Editor));
        if content.editor.is_some_and(Editor::tells_mistakes) {
            content.problem = None;
        }
        content.learning = controllers.learning_param(self.placed_scene.as_ref().map(|(scene, _)| scene));
        content.cues = seen.cues.clone();
        let cover = seen.cover.as_ref().map(Cover);
        content.snapshots = self.snapshots;
        content.picture = self.picture;
        content.hides_pointer =
            (self.is_quiet() || !seen.awake) && open.is_none() && content.params.is_none();
        if self.hidden.by_blackout && open != Some(Panel::Sources) {
            content.sources = None;
        }
        if self.hidden.is_bare() {
            (content.notice, content.problem, content.hint) = (None, None, None);
        } else if self.hidden.by_setting {
            content.notice = None;
        } else if let Some(since) = self
            .welcomed
            .filter(|_| !seen.awake && open.is_none() && content.problem.is_none() && content.help.is_none())
        {
            let (title, artist) = (&*playing.title, playing.artist.as_deref());
            content.welcome = Some(Welcome { title, artist, cover, scene, since });
        }
        let wants_decks = seen.awake || seen.assisted || self.panels.sliders || self.picture.is_some();
        let has_decks = content.decks.is_some();
        if self.is_quiet() || !wants_decks {
            content.decks = None;
        }
        // Screen readers must always find the buttons of the bar.
        let shows_bar = seen.awake && !self.is_quiet();
        if seen.assisted || shows_bar {
            content.bar = Some(Bar {
                now: playing,
                cover,
                shape: seen.shape.as_deref(),
                song: seen.song.as_deref(),
                marks: self.marks,
                // While the bar is hidden, a changing level must not cause a new layout.
                level: if shows_bar { listening.level } else { 0.0 },
                scene,
                panels: self.panels,
                fullscreen: seen.fullscreen,
                follows: seen.follows,
                decks: has_decks,
                seen: shows_bar,
            });
        }
        content
    }
}
