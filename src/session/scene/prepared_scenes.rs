//! All scenes that can be drawn now or soon: the shown, the coming, the outgoing and the neighbouring ones.

use super::ahead::PreparedAhead;
use super::prepared_scene::PreparedScene;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::picture::Picture;
use crate::gpu::Mode;
use crate::scenes::SceneSource;
use mariana_music::Features;

pub(crate) struct PreparedScenes {
    pub(crate) shown: Option<PreparedScene>,
    /// The scene that replaces the shown one as soon as a program can draw the new scene.
    pub(super) coming: Option<PreparedScene>,
    /// The previous scene, until the first frame of the current one is finished.
    pub(super) before: Option<PreparedScene>,
    /// The scene that fades out. It is no longer in `shown` or `before`.
    pub(super) fading_out: Option<PreparedScene>,
    pub(super) ahead: PreparedAhead,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// The outgoing scene is the shown scene itself, with another camera or other parameters.
    Shown,
    Before,
    FadingOut,
}

impl PreparedScenes {
    pub(super) fn with(ahead: PreparedAhead) -> Self {
        Self { shown: None, coming: None, before: None, fading_out: None, ahead }
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = &PreparedScene> {
        let staged = [&self.shown, &self.coming, &self.before, &self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes())
    }

    /// The scene with this id, except in `before`.
    pub(super) fn get(&self, id: u64) -> Option<&PreparedScene> {
        let staged = [&self.shown, &self.coming, &self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes()).find(|scene| scene.id == id)
    }

    pub(super) fn get_mut(&mut self, id: u64) -> Option<&mut PreparedScene> {
        let staged = [&mut self.shown, &mut self.coming, &mut self.fading_out].into_iter().flatten();
        staged.chain(self.ahead.scenes_mut()).find(|scene| scene.id == id)
    }

    pub(super) fn ids(&self) -> Vec<u64> {
        self.all().map(|scene| scene.id).collect()
    }

    pub(super) fn present(&self) -> impl Iterator<Item = &PreparedScene> {
        [&self.shown, &self.coming].into_iter().flatten()
    }

    pub(super) fn present_mut(&mut self) -> impl Iterator<Item = &mut PreparedScene> {
        [&mut self.shown, &mut self.coming].into_iter().flatten()
    }

    pub(crate) fn name(&self) -> Option<String> {
        self.shown.as_ref().map(PreparedScene::title)
    }

    pub(crate) fn shown_id(&self) -> Option<u64> {
        self.shown.as_ref().map(|scene| scene.id)
    }

    /// The shown scene, and the mode in which it is drawn now.
    pub(super) fn drawn(&self, sdf: SdfChoice) -> Option<(&PreparedScene, Mode)> {
        let scene = self.shown.as_ref()?;
        Some((scene, scene.mode(sdf)?))
    }

    /// The prepared scene with this source; the shown scene if there is none.
    pub(super) fn in_hand(&self, wanted: Option<&SceneSource>) -> Option<&PreparedScene> {
        let found = wanted.and_then(|wanted| self.all().find(|scene| scene.source == *wanted));
        found.or(self.shown.as_ref())
    }

    pub(super) fn in_hand_mut(&mut self, wanted: Option<&SceneSource>) -> Option<&mut PreparedScene> {
        let id = self.in_hand(wanted)?.id;
        self.get_mut(id)
    }

    pub(crate) fn coming_picture(&self) -> Option<Picture> {
        let world = self.coming.as_ref()?.resources.world();
        Some(Frame::new(world, 0.0, Features::SILENCE, (16, 16)).picture)
    }

    pub(crate) fn next_title(&self) -> Option<String> {
        let mut sources = self.ahead.next_sources();
        sources.find(|source| !matches!(source, SceneSource::Blend(_))).map(SceneSource::title)
    }

    pub(crate) fn shown_source(&self) -> Option<&SceneSource> {
        self.shown.as_ref().map(|scene| &scene.source)
    }

    pub(super) fn at(&self, place: Place) -> Option<&PreparedScene> {
        match place {
            Place::Shown => self.shown.as_ref(),
            Place::Before => self.before.as_ref(),
            Place::FadingOut => self.fading_out.as_ref(),
        }
    }

    pub(super) fn place_of(&self, source: &SceneSource, sdf: SdfChoice) -> Option<Place> {
        let places = [Place::Shown, Place::Before, Place::FadingOut];
        places.into_iter().find(|place| {
            let scene = self.at(*place).filter(|scene| scene.source == *source);
            scene.is_some_and(|scene| scene.mode(sdf).is_some())
        })
    }

    /// True if the next frame can show this scene.
    pub(super) fn has_ready(&self, source: &SceneSource, sdf: SdfChoice) -> bool {
        self.place_of(source, sdf).is_some() || self.ahead.has_rehearsed(source)
    }

    pub(super) fn is_version_of_shown(&self, scene: &PreparedScene) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.source == scene.source)
    }

    /// True if the shown scene follows the pointer.
    pub(crate) fn follow_pointer(&self) -> bool {
        self.shown.as_ref().is_some_and(|scene| scene.resources.world().follows_pointer())
    }

    /// True if a drawn scene reads curves of the sound, or if no scene is shown yet.
    pub(crate) fn read_curves(&self) -> bool {
        let drawn = [&self.shown, &self.before, &self.fading_out];
        self.shown.is_none() || drawn.into_iter().flatten().any(|scene| scene.hears_curves)
    }

    /// True if a drawn scene has numbers with inertia, which need the sound of the last seconds.
    pub(crate) fn remember(&self) -> bool {
        let drawn = [&self.shown, &self.before, &self.fading_out];
        drawn.into_iter().flatten().any(|scene| !scene.resources.world().frame_tape.motions.is_empty())
    }

    /// Keeps a scene until it has faded out. Replaces a scene that is still fading out.
    pub(super) fn fade_out(&mut self, scene: PreparedScene) {
        self.end_fade();
        self.fading_out = Some(scene);
    }

    /// Ends the fade: the outgoing scene is kept only as a neighbour.
    pub(super) fn end_fade(&mut self) {
        if let Some(gone) = self.fading_out.take() {
            self.ahead.keep(gone);
        }
    }
}
