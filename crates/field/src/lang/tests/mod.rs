//! Tests of the language: values of expressions, and messages about mistakes.

#[cfg(test)]
mod about;
mod bad_input;
#[cfg(test)]
mod cameras;
#[cfg(test)]
mod dialects;
#[cfg(test)]
mod fuzz;
#[cfg(test)]
mod glsl;
#[cfg(test)]
mod meaning;
#[cfg(test)]
mod messages;
#[cfg(test)]
mod misleading;
#[cfg(test)]
mod motions;
#[cfg(test)]
mod parts;
#[cfg(test)]
mod pixels;
#[cfg(test)]
mod shapes;
#[cfg(test)]
mod slopes;
#[cfg(test)]
mod statements;
#[cfg(test)]
mod swarms;
#[cfg(test)]
mod warnings;

#[cfg(test)]
pub(in crate::lang) use fuzz::mutated;
pub(crate) use shapes::SHAPES;

use super::{Compiled, Scene, compile, no_includes};
use crate::graph::{FrameInputs, PartInput, Point};
use crate::graph::{LevelList, Levels, SoundInput, SoundInputs};

pub(super) fn scene(text: &str) -> Scene {
    let compiled = compile("test.scene", text, &mut no_includes);
    match compiled.scene {
        Some(scene) => scene,
        None => panic!("{}\n{text}", compiled.render(false)),
    }
}

pub(super) fn broken(text: &str) -> Compiled {
    let compiled = compile("test.scene", text, &mut no_includes);
    assert!(compiled.scene.is_none() && !compiled.diagnostics.is_empty(), "no mistake found in: {text}");
    compiled
}

/// Returns the inputs of a frame. Each number of the sound that tests read has a different value: band i and note i are
/// i / 100.
pub(super) fn frame(scene: &Scene) -> FrameInputs {
    FrameInputs {
        time: 2.0,
        sound: SoundInputs::with(&[
            (SoundInput::VolumeLeft, 0.25),
            (SoundInput::VolumeRight, 0.5),
            (SoundInput::Energy, 0.75),
        ]),
        levels: Levels::each(|list, number| match list {
            LevelList::Chroma => [0.1, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0][number],
            LevelList::Pan => -0.01 * number as f32,
            _ => number as f32 / 100.0,
        }),
        // Each number of a part is its index / 1000.
        parts: (0..PartInput::COUNT).map(|index| index as f32 / 1000.0).collect(),
        params: scene.params.iter().map(|param| param.default).collect(),
        ..FrameInputs::default()
    }
}

pub(super) fn distance(scene: &Scene, at: [f32; 3]) -> f32 {
    scene.graph.evaluate(&[scene.distance], &Point::at(at[0], at[1], at[2]), &frame(scene))[0]
}

pub(super) fn value(text: &str, at: [f32; 3]) -> f32 {
    distance(&scene(text), at)
}
