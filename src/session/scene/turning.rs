//! A number of the scene's text that a hand turns: its value goes into the frame, and nothing is read or compiled.

use std::path::{Path, PathBuf};

use super::{Cast, SceneStage};
use crate::scenes::SceneSource;

/// Numbers of a file's text, by where their digits begin in the text that was loaded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TurnedNumbers {
    file: PathBuf,
    values: Vec<(usize, f32)>,
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

    /// Notes whether somebody writes the scene's text.
    pub(crate) fn set_written(&mut self, written: bool) {
        self.is_written = written;
    }

    /// Gives numbers of a text values, in a scene in which they have a range.
    pub(crate) fn turn_numbers(&mut self, file: &Path, values: Vec<(usize, f32)>) {
        self.turned = Some(TurnedNumbers { file: file.to_owned(), values });
        self.revision += 1;
    }

    /// Puts the values of the numbers that a hand turns among the parameters of a scene, if they are some of them.
    pub(super) fn turn_in(&self, cast: &Cast, numbers: &mut [f32]) {
        let world = cast.resources.world();
        let Some(turned) = &self.turned else { return };
        if world.blended.is_some() || cast.source.file() != Some(&turned.file) {
            return;
        }
        // Once the hand has let go, the numbers have no range.
        for (digits, value) in &turned.values {
            let place = world.scene.params.iter().position(|param| {
                param.is_number && param.span.start as usize == *digits && param.min < param.max
            });
            if let Some(number) = place.and_then(|place| numbers.get_mut(place)) {
                *number = *value;
            }
        }
    }
}
