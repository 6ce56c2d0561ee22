//! Which scene a video shows when.

use std::collections::VecDeque;

use super::VideoRequest;
use crate::export::alpha::require_no_sky;
use crate::export::error::ExportError;
use crate::export::painter::{Painter, SceneChoice, require_inputs};
use crate::scenes::ReadyScene;

/// A scene from a moment of the song on.
#[derive(Debug, Clone)]
pub struct TimedScene {
    /// The moment, in seconds.
    pub from: f64,
    /// The scene.
    pub scene: SceneChoice,
}

/// The scenes of a video in their order. All are read at the start, so that none is refused in the middle; only one at
/// a time is on the GPU.
pub(super) struct Timeline<'a> {
    request: &'a VideoRequest,
    /// None while one scene takes another's place.
    painter: Option<Painter>,
    /// Whether one of them reads numbers of the whole song.
    read_song: bool,
    coming: VecDeque<(&'a TimedScene, ReadyScene)>,
}

impl<'a> Timeline<'a> {
    /// Reads the scenes, and opens the one with which the video starts.
    pub(super) fn open(request: &'a VideoRequest) -> Result<Self, ExportError> {
        let mut scenes: Vec<&TimedScene> = request.scenes.iter().collect();
        scenes.sort_by(|a, b| a.from.total_cmp(&b.from));
        if let Some(first) = scenes.first().filter(|first| first.from > request.start) {
            return Err(ExportError::NothingAtFirst { from: first.from, start: request.start });
        }
        let mut coming = VecDeque::new();
        for scene in scenes {
            let ready = scene.scene.source.ready()?;
            if scene.scene.alpha {
                require_no_sky(&ready, &scene.scene.source.name())?;
            }
            coming.push_back((scene, ready));
        }
        let read_song = coming.iter().any(|(_, ready)| ready.world.scene.graph.reads_song());
        let known: Vec<_> = coming.iter().map(|(_, ready)| &ready.world.scene).collect();
        require_inputs(&known, &request.set)?;
        let mut timeline = Self { request, painter: None, read_song, coming };
        timeline.advance(request.start)?;
        Ok(timeline)
    }

    /// Whether one of the scenes reads numbers of the whole song.
    pub(super) fn read_song(&self) -> bool {
        self.read_song
    }

    /// The painter of the scene that is shown at `time` seconds, which never steps back; none if there is no scene.
    pub(super) fn painter_at(&mut self, time: f64) -> Result<Option<&mut Painter>, ExportError> {
        self.advance(time)?;
        Ok(self.painter.as_mut())
    }

    fn advance(&mut self, time: f64) -> Result<(), ExportError> {
        let mut next = None;
        while self.coming.front().is_some_and(|(scene, _)| scene.from <= time) {
            next = self.coming.pop_front();
        }
        let Some((TimedScene { scene, .. }, ready)) = next else { return Ok(()) };
        // First: what it holds belongs to its own context, which the new one takes the place of.
        self.painter = None;
        let mut painter = Painter::of_ready(scene, ready)?;
        painter.hold(&self.request.set)?;
        if self.request.limit_flashes {
            painter.add_flash_limiter(&scene.shaders)?;
        }
        self.painter = Some(painter);
        Ok(())
    }
}
