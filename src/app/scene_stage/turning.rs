//! A number of the scene's text that a hand turns: its value goes into the frame, and nothing is read or compiled.

use std::path::{Path, PathBuf};

use super::{Cast, SceneStage};
use crate::scenes::SceneSource;

/// A number of a file's text, by where its digits begin in the text that was loaded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TurnedNumber {
    file: PathBuf,
    digits: usize,
    value: f32,
}

impl SceneStage {
    /// What was asked for last: shown, or on its way.
    pub(crate) fn wanted_source(&self) -> &SceneSource {
        &self.source
    }

    /// The number of the scene on the stage: another one for each version of its text.
    pub(crate) fn shown_id(&self) -> Option<u64> {
        self.on_stage.as_ref().map(|cast| cast.id)
    }

    /// Loads the scene again, because its text has changed without its file.
    pub(crate) fn load_again(&mut self) {
        tracing::debug!("{} is loaded again for its draft", self.source.title());
        self.loader.load_again();
    }

    /// Notes whether somebody writes the scene's text.
    pub(crate) fn set_written(&mut self, written: bool) {
        self.is_written = written;
    }

    /// Gives a number of a text a value, in a scene in which it has a range.
    pub(crate) fn turn_number(&mut self, file: &Path, digits: usize, value: f32) {
        self.turned = Some(TurnedNumber { file: file.to_owned(), digits, value });
        self.revision += 1;
    }

    /// The parameters of a scene that no show moves: as the sliders stand, and the hand that turns a number.
    pub(super) fn unmoved(&self, cast: &Cast) -> Vec<f32> {
        let world = cast.resources.world();
        let turned = self
            .turned
            .as_ref()
            .filter(|turned| world.blended.is_none() && cast.source.file() == Some(&turned.file));
        let mut sliders = cast.sliders.iter();
        let mut slider = |default| sliders.next().map_or(default, |one| one.value);
        let params = world.scene.params.iter();
        let value = |param: &mariana_field::lang::Param| match (param.is_number, turned) {
            (false, _) => slider(param.default),
            // Once the hand has let go, the number has no range.
            (true, Some(turned)) if param.span.start as usize == turned.digits && param.min < param.max => {
                turned.value
            }
            (true, _) => param.default,
        };
        params.map(value).collect()
    }
}
