//! Every scene that can be drawn or soon can be, by its place: the one that shows, the one that comes, those that go,
//! and those that come next.

use super::ahead::PreparedAhead;
use super::prepared_scene::PreparedScene;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::picture::Picture;
use crate::scenes::SceneSource;
use mariana_control::Slider;
use mariana_music::Features;

/// See the module.
pub(crate) struct PreparedScenes {
    /// The one that shows.
    pub(super) shown: Option<PreparedScene>,
    /// The one that takes its place as soon as a program can draw it.
    pub(super) coming: Option<PreparedScene>,
    /// The one that showed before, until the first picture of the present one is finished.
    pub(super) before: Option<PreparedScene>,
    /// The one that fades out, once it is neither shown nor the one before.
    pub(super) fading_out: Option<PreparedScene>,
    /// The next and the previous one.
    pub(super) ahead: PreparedAhead,
}

/// Where a scene is found that fades out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// It is the one that shows, seen in another way.
    Shown,
    /// It has just gone.
    Before,
    /// It was kept for the fade.
    FadingOut,
}

impl PreparedScenes {
    /// None yet but those that `ahead` prepares.
    pub(super) fn with(ahead: PreparedAhead) -> Self {
        Self { shown: None, coming: None, before: None, fading_out: None, ahead }
    }

    /// Every scene that is there.
    pub(super) fn all(&self) -> impl Iterator<Item = &PreparedScene> {
        let staged = [&self.shown, &self.coming, &self.before, &self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes())
    }

    /// The scene with this number, unless it has just gone.
    pub(super) fn get(&self, id: u64) -> Option<&PreparedScene> {
        let staged = [&self.shown, &self.coming, &self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes()).find(|scene| scene.id == id)
    }

    /// The same, to be changed.
    pub(super) fn get_mut(&mut self, id: u64) -> Option<&mut PreparedScene> {
        let staged = [&mut self.shown, &mut self.coming, &mut self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes_mut()).find(|scene| scene.id == id)
    }

    /// The numbers of all that are there.
    pub(super) fn ids(&self) -> Vec<u64> {
        self.all().map(|scene| scene.id).collect()
    }

    /// The one that shows and the one that comes.
    pub(super) fn present(&self) -> impl Iterator<Item = &PreparedScene> {
        [&self.shown, &self.coming].into_iter().flatten()
    }

    /// The same, to be changed.
    pub(super) fn present_mut(&mut self) -> impl Iterator<Item = &mut PreparedScene> {
        [&mut self.shown, &mut self.coming].into_iter().flatten()
    }

    /// Whether there is something to draw.
    pub(crate) fn is_any_shown(&self) -> bool {
        self.shown.is_some()
    }

    /// The name of the one that shows.
    pub(crate) fn name(&self) -> Option<String> {
        self.shown.as_ref().map(PreparedScene::title)
    }

    /// The number of the one that shows: another one for each version of its text.
    pub(crate) fn shown_id(&self) -> Option<u64> {
        self.shown.as_ref().map(|scene| scene.id)
    }

    /// The parameters of the one that shows, in their order.
    pub(crate) fn sliders(&self) -> &[Slider] {
        self.shown.as_ref().map_or(&[], |scene| scene.knobs.sliders())
    }

    /// How pictures of the one are made that is coming; none if there is none.
    pub(crate) fn coming_picture(&self) -> Option<Picture> {
        let world = self.coming.as_ref()?.resources.world();
        Some(Frame::new(world, 0.0, Features::SILENCE, (16, 16)).picture)
    }

    /// The title of the one that comes next, once it is known.
    pub(crate) fn next_title(&self) -> Option<String> {
        let mut sources = self.ahead.next_sources();
        sources.find(|source| !matches!(source, SceneSource::Blend(_))).map(SceneSource::title)
    }

    /// Where the one that shows comes from.
    pub(crate) fn shown_source(&self) -> Option<&SceneSource> {
        self.shown.as_ref().map(|scene| &scene.source)
    }

    /// The scene at that place.
    pub(super) fn at(&self, place: Place) -> Option<&PreparedScene> {
        match place {
            Place::Shown => self.shown.as_ref(),
            Place::Before => self.before.as_ref(),
            Place::FadingOut => self.fading_out.as_ref(),
        }
    }

    /// Where a scene is found that can be drawn.
    pub(super) fn place_of(&self, source: &SceneSource, sdf: SdfChoice) -> Option<Place> {
        let places = [Place::Shown, Place::Before, Place::FadingOut];
        places.into_iter().find(|place| {
            let scene = self.at(*place).filter(|scene| scene.source == *source);
            scene.is_some_and(|scene| scene.mode(sdf).is_some())
        })
    }

    /// Whether a scene is another version of the text that shows.
    pub(super) fn is_version_of_shown(&self, scene: &PreparedScene) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.source == scene.source)
    }

    /// Whether what is drawn reads curves of the sound; true as long as nothing shows.
    pub(crate) fn hear_curves(&self) -> bool {
        let drawn = [&self.shown, &self.before, &self.fading_out];
        self.shown.is_none() || drawn.into_iter().flatten().any(|scene| scene.hears_curves)
    }

    /// Keeps a scene until it has faded out, in place of the one that did so before.
    pub(super) fn fade_out(&mut self, scene: PreparedScene) {
        self.end_fade();
        self.fading_out = Some(scene);
    }

    /// The scene that fades out is needed no longer: it is kept if it is a neighbour.
    pub(super) fn end_fade(&mut self) {
        if let Some(gone) = self.fading_out.take() {
            self.ahead.keep(gone);
        }
    }
}
