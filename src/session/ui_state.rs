//! What the window shows over the picture beside what the scene has to say: first words, the bar, the lists.

use std::sync::Arc;
use std::time::Instant;

use crate::commands::Panel;
use crate::placement::Area;
use crate::scenes::SceneSource;
use crate::session::controllers::Controllers;
use crate::session::listening::Listening;
use crate::session::reports::Reports;
use crate::session::scene::{SceneSession, SceneWords};
use crate::ui::controllers_panel::ControllersPanel;
use crate::ui::corner_handles::CornerHandles;
use crate::ui::editor::Editor;
use crate::ui::file_browser::FileBrowser;
use crate::ui::overlay::{Bar, Notice, OverlayContent, PanelSwitches, Problem, Tracks, Welcome};
use crate::ui::scene_browser::SceneBrowser;
use crate::ui::settings_panel::SettingsPanel;
use mariana_music::SongStructure;
use mariana_player::{ListedTracks, LoudnessShape};

/// See the module.
pub(crate) struct UiState {
    /// What the user has turned on.
    pub(crate) panels: PanelSwitches,
    /// The scene on the stage, with its place among the others in words.
    pub(super) placed_scene: Option<(SceneSource, String)>,
    /// When the words at the start came up.
    pub(super) welcomed: Option<Instant>,
    /// The list of scenes, while it is open.
    pub(super) browser: Option<SceneBrowser>,
    /// The list of files, while it is open.
    pub(super) files: Option<FileBrowser>,
    /// The settings, while they are open.
    pub(super) settings: Option<SettingsPanel>,
    /// The editor, once it was opened.
    pub(super) editor: Option<Editor>,
    /// Knobs from outside, while they are open.
    pub(super) controllers: Option<ControllersPanel>,
    /// The corners of the picture, while they are moved.
    pub(super) corners: Option<CornerHandles>,
    /// The part of the window in which the picture lies small, beside the panels, if an output shows it.
    pub(super) picture: Option<Area>,
    /// Whether nothing shows over the picture but what was asked for and what is wrong.
    pub(super) clean: bool,
    /// Whether only panels show that were opened since.
    pub(super) bare: bool,
}

/// The pointer and the track at a moment.
pub(super) struct Seen {
    /// Whether the pointer has moved lately or does something with a panel.
    pub(super) awake: bool,
    /// Whether screen readers are told what there is.
    pub(super) assisted: bool,
    /// `true` in full screen.
    pub(super) fullscreen: bool,
    /// The list of tracks, if it shows.
    pub(super) tracks: Option<Arc<ListedTracks>>,
    /// How loud the track is from its start to its end, if the bar shows.
    pub(super) shape: Option<Arc<LoudnessShape>>,
    /// A show is on.
    pub(super) follows: bool,
    /// What the track is made of, if the bar shows and that is known.
    pub(super) song: Option<Arc<SongStructure>>,
}

/// What is shown over the picture of the scene: its messages, its sliders, and what the window adds.
pub(super) fn content_of<'a>(
    scene: &'a mut SceneSession,
    corner: Option<&'a str>,
    panels: PanelSwitches,
) -> OverlayContent<'a> {
    let SceneWords { problem, notice, hint, sliders } = scene.words();
    OverlayContent {
        corner,
        problem: problem.map(|(heading, text)| Problem { heading, text }),
        notice: notice.map(|(text, since)| Notice { text, fraction: None, since }),
        params: Some(sliders).filter(|sliders| panels.sliders() && !sliders.is_empty()),
        help: panels.help(),
        hint,
        ..OverlayContent::default()
    }
}

impl UiState {
    /// Nothing is open yet.
    pub(super) fn new(clean: bool) -> Self {
        Self {
            panels: PanelSwitches::default(),
            placed_scene: None,
            welcomed: None,
            browser: None,
            files: None,
            settings: None,
            editor: None,
            controllers: None,
            corners: None,
            picture: None,
            clean,
            bare: false,
        }
    }

    /// Whether nothing shows that was not asked for.
    pub(super) fn is_quiet(&self) -> bool {
        self.clean || self.bare
    }

    /// Adds to `content` what is to be shown now.
    pub(super) fn add_to<'a>(
        &'a self,
        content: &mut OverlayContent<'a>,
        seen: &'a Seen,
        controllers: &'a Controllers,
        listening: &'a Listening,
        reports: &'a Reports,
        now: Instant,
    ) {
        let (open, playing) = (self.panels.open(), reports.playing());
        let scene = self.placed_scene.as_ref().map_or("", |(_, words)| words);
        content.add(reports.notice());
        listening.show_in(content, open == Some(Panel::Sources), now);
        content.scenes = self.browser.as_ref();
        content.files = self.files.as_ref();
        content.settings = self.settings.as_ref();
        content.editor = self.editor.as_ref().filter(|_| open == Some(Panel::Editor));
        if content.editor.is_some_and(Editor::tells_mistakes) {
            content.problem = None;
        }
        content.controllers = self.controllers.as_ref();
        content.learning = controllers.learning_param(self.placed_scene.as_ref().map(|(scene, _)| scene));
        content.tracks = seen.tracks.as_deref().map(|list| Tracks { list, present: playing.place.0 });
        content.corners = self.corners;
        content.picture = self.picture;
        content.hides_pointer =
            (self.is_quiet() || !seen.awake) && open.is_none() && content.params.is_none();
        if self.bare {
            (content.notice, content.problem, content.hint) = (None, None, None);
        } else if self.clean {
            content.notice = None;
        } else if let Some(since) = self
            .welcomed
            .filter(|_| !seen.awake && open.is_none() && content.problem.is_none() && !content.help)
        {
            let (title, artist) = (&*playing.title, playing.artist.as_deref());
            content.welcome = Some(Welcome { title, artist, scene, since });
        }
        // Screen readers find its buttons at any time.
        let shows_bar = seen.awake && !self.is_quiet();
        if seen.assisted || shows_bar {
            content.bar = Some(Bar {
                now: playing,
                shape: seen.shape.as_deref(),
                song: seen.song.as_deref(),
                // Unseen, it need not be laid out anew for each sound.
                level: if shows_bar { listening.level() } else { 0.0 },
                scene,
                open,
                help: self.panels.help(),
                sliders: self.panels.sliders(),
                fullscreen: seen.fullscreen,
                follows: seen.follows,
                seen: shows_bar,
            });
        }
    }
}
