//! `Frame`: everything the GPU needs for one picture of a world, from time, sound and camera.
//!
//! Plain numbers, no OpenGL: a frame is the same for a window, a still and a video.

pub mod block;
pub mod camera;
pub mod picture;
pub mod sound_tables;

pub use crate::dsp::Sound;
use crate::dsp::{HISTORY_POINTS, spectrum_place};
use crate::graph::{FrameInputs, TableData};
use crate::world::{FrameValues, World};
use camera::Camera;
use picture::Picture;

/// What one picture shows.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Width and height of the picture in pixels, each at least 1.
    pub size: (u32, u32),
    /// What the scene's expressions read: time, sound, parameters. Every number is finite.
    pub inputs: FrameInputs,
    /// Where the picture is seen from.
    pub camera: Camera,
    /// What the picture may cost beside its number of pixels, 0..1: the shaders' `frame_quality`.
    pub quality: f32,
    /// Lights and planes.
    pub values: FrameValues,
    /// What happens to the scene's light on its way to the screen.
    pub picture: Picture,
}

impl Frame {
    /// The frame of a world at `time` seconds with the sound that is audible then, its parameters as the scene's text
    /// sets them.
    pub fn new(world: &World, time: f64, sound: impl Into<Sound>, size: (u32, u32)) -> Self {
        let params: Vec<f32> = world.scene.params.iter().map(|param| param.default).collect();
        Self::with_params(world, time, sound, size, &params)
    }

    /// The same with other parameters; missing ones are as the scene's text sets them.
    pub fn with_params(
        world: &World,
        time: f64,
        sound: impl Into<Sound>,
        size: (u32, u32),
        params: &[f32],
    ) -> Self {
        let Sound { features, tables } = sound.into();
        let size = (size.0.max(1), size.1.max(1));
        let declared = world.scene.params.iter().enumerate();
        let mut inputs = FrameInputs {
            time: finite(time as f32),
            volume: features.volume.map(unit),
            bands: features.bands.map(unit),
            bass: unit(features.bass),
            mid: unit(features.mid),
            treble: unit(features.treble),
            beat: unit(features.beat),
            tempo: finite(features.tempo).max(0.0),
            phase: unit(features.phase),
            volume_mid: unit(features.volume_mid),
            volume_side: unit(features.volume_side),
            bass_drive: finite(features.bass_drive).clamp(0.0, 4.0),
            pitch: finite(spectrum_place(f64::from(features.peak_hz)) as f32),
            spectrum: tables.spectrum.map_or(TableData::EMPTY, TableData::row),
            waveform: tables.waveform.map_or(TableData::EMPTY, TableData::row),
            history: tables.history.map_or(TableData::EMPTY, |rows| {
                TableData::scrolling(rows, HISTORY_POINTS, tables.history_offset, tables.history_span)
            }),
            params: declared
                .map(|(index, param)| {
                    let value = params.get(index).copied().filter(|value| value.is_finite());
                    value.unwrap_or(param.default).clamp(param.min, param.max)
                })
                .collect(),
            ..FrameInputs::default()
        };
        inputs.hoisted = world.hoisted.values(&inputs);
        let values = world.frame_tape.values(&inputs);
        let camera = Camera::of(&values, f64::from(size.0) / f64::from(size.1));
        let picture = Picture::of(&values, &camera, world.traits.lens);
        Self { size, inputs, camera, values, quality: 1.0, picture }
    }
}

impl Frame {
    /// The same as it is drawn for a window of that width over height, whatever the number of its pixels, in a quality.
    pub fn in_window(self, aspect: f64, quality: f32) -> Self {
        let camera = Camera::of(&self.values, aspect);
        Self { camera, quality, ..self }
    }

    /// The same moment in a picture of another size.
    pub fn resized(self, size: (u32, u32)) -> Self {
        let size = (size.0.max(1), size.1.max(1));
        let camera = Camera::of(&self.values, f64::from(size.0) / f64::from(size.1));
        let picture = Picture::of(&self.values, &camera, self.picture.lens.is_some());
        Self { size, camera, picture, ..self }
    }
}

/// Nothing non-finite reaches a scene's inputs.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

/// The language promises levels of 0..1; samples beyond full scale measure more.
fn unit(value: f32) -> f32 {
    finite(value).clamp(0.0, 1.0)
}
