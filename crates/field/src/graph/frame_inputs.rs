//! The inputs that are the same at every point of a frame: time, sound, the scene's parameters, tables and textures.

use std::sync::{Arc, LazyLock};

use super::interval::Interval;
use super::node::Input;
use super::screen_input::Screen;
use super::shape_atlas::ShapeAtlas;
use super::table::{TableData, unit};
use super::{LevelList, Levels, PartInput, SoundInputs};

/// Reads a scene's textures on the CPU.
pub trait TextureReader: std::fmt::Debug + Send + Sync {
    /// Returns a channel (0 red .. 3 alpha) of a texture at (u, v). The result is in 0..1.
    fn read(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32;
}

/// A placeholder that constant folding passes to operators that do not read the frame.
pub(crate) static SILENT: LazyLock<FrameInputs> = LazyLock::new(FrameInputs::default);

/// The inputs of a frame. The default is silence at time 0.
#[derive(Debug, Clone, Default)]
pub struct FrameInputs {
    /// Time in seconds.
    pub time: f32,
    /// The sound's numbers.
    pub sound: SoundInputs,
    /// The levels that scenes read by number.
    pub levels: Levels,
    /// The numbers of the song's parts, in the order of [`PartInput::index`]; missing numbers are 0.
    pub parts: Vec<f32>,
    /// Position of the eye.
    pub eye: [f32; 3],
    /// The size of the picture and the pointer over it.
    pub screen: Screen,
    /// The scene's parameters by number; missing parameters are 0.
    pub params: Vec<f32>,
    /// The values of the graph's motions, by number; missing values are 0.
    pub motions: Vec<f32>,
    /// The values that were computed once for this frame, by number; missing values are 0.
    pub hoisted: Vec<f32>,
    /// The spectrum, from low to high frequencies.
    pub spectrum: TableData,
    /// The waveform, from old to new samples.
    pub waveform: TableData,
    /// The history of the spectrum, one row per age, the newest first.
    pub history: TableData,
    /// The scene's textures. Without a reader, every texture is 0.
    pub textures: Option<Arc<dyn TextureReader>>,
    /// The scene's texts and pictures as shapes.
    pub shapes: ShapeAtlas,
    /// The ranges of numbers that a scene declares; set only by [`FrameInputs::any`].
    pub ranges: Option<Arc<OwnRanges>>,
}

/// The ranges of numbers that a scene declares itself.
#[derive(Debug, Clone, Default)]
pub struct OwnRanges {
    /// Of its parameters, by number.
    pub params: Vec<Interval>,
    /// Of its motions, by number.
    pub motions: Vec<Interval>,
}

/// Largest time in seconds that [`FrameInputs::any`] covers: a day.
const TIME_MAX: f32 = 86_400.0;

impl FrameInputs {
    /// Returns the inputs of all frames of a scene at once: any sound, any time, parameters within their ranges. Bounds
    /// computed with these inputs hold for every frame. Values computed with them belong to a silent frame.
    ///
    /// `shapes` are the scene's texts and pictures. Texts that change may have any content.
    pub fn any(ranges: OwnRanges, shapes: &ShapeAtlas) -> Self {
        Self {
            shapes: shapes.clone(),
            spectrum: TableData::within(0.0, 1.0),
            waveform: TableData::within(-1.0, 1.0),
            history: TableData::within(0.0, 1.0),
            ranges: Some(Arc::new(ranges)),
            ..Self::default()
        }
    }

    /// Returns bounds of an input: a single value, unless these are the inputs of all frames ([`FrameInputs::any`]).
    pub fn bounds(&self, input: Input) -> Interval {
        let Some(own) = &self.ranges else { return Interval::point(self.value(input)) };
        let within = |(lo, hi)| Interval { lo, hi };
        match input {
            Input::T => Interval { lo: 0.0, hi: TIME_MAX },
            Input::Sound(input) => within(input.range()),
            Input::Level(level) => within(level.range()),
            Input::Param(i) => own.params.get(usize::from(i)).copied().unwrap_or(Interval::ANY),
            Input::Motion(i) => own.motions.get(usize::from(i)).copied().unwrap_or(Interval::ANY),
            Input::X | Input::Y | Input::Z | Input::NX | Input::NY | Input::NZ => Interval::ANY,
            Input::EyeX | Input::EyeY | Input::EyeZ | Input::Screen(_) | Input::Hoisted(_) => Interval::ANY,
        }
    }

    /// Returns the value of an input that is the same at all points of the frame; 0 for inputs of a point.
    pub fn value(&self, input: Input) -> f32 {
        match input {
            Input::X | Input::Y | Input::Z | Input::NX | Input::NY | Input::NZ => 0.0,
            Input::T => self.time,
            Input::Sound(input) => self.sound[input],
            Input::Level(level) => self.levels[level],
            Input::EyeX => self.eye[0],
            Input::EyeY => self.eye[1],
            Input::EyeZ => self.eye[2],
            Input::Screen(input) => self.screen.value(input),
            Input::Param(i) => self.params.get(usize::from(i)).copied().unwrap_or(0.0),
            Input::Motion(i) => self.motions.get(usize::from(i)).copied().unwrap_or(0.0),
            Input::Hoisted(i) => self.hoisted.get(usize::from(i)).copied().unwrap_or(0.0),
        }
    }

    /// Returns a level of a list ([`LevelList::nearest`]).
    pub fn level(&self, list: LevelList, index: f32) -> f32 {
        self.levels[list.nearest(index)]
    }

    /// Returns bounds of [`FrameInputs::level`].
    pub fn level_bounds(&self, list: LevelList, index: Interval) -> Interval {
        let (least, most) = list.range();
        if self.ranges.is_some() {
            return Interval { lo: least, hi: most };
        }
        let index = if index.is_any() { Interval { lo: 0.0, hi: f32::INFINITY } } else { index };
        self.levels.bounds(list.nearest(index.lo), list.nearest(index.hi))
    }

    /// Returns the number of the song's parts with the index floor(index), clamped to the existing numbers.
    pub fn part(&self, index: f32) -> f32 {
        self.parts.get(PartInput::clamped(index)).copied().unwrap_or(0.0)
    }

    /// Returns bounds of [`FrameInputs::part`].
    pub fn part_bounds(&self, index: Interval) -> Interval {
        let (first, last) = if index.is_any() {
            (0, PartInput::COUNT - 1)
        } else {
            (PartInput::clamped(index.lo), PartInput::clamped(index.hi))
        };
        let value = |at: usize| match (&self.ranges, PartInput::at(at)) {
            (Some(_), Some(input)) => Interval { lo: input.range().0, hi: input.range().1 },
            _ => Interval::point(self.parts.get(at).copied().unwrap_or(0.0)),
        };
        (first..=last).fold(value(first), |bounds, at| bounds.hull(value(at)))
    }

    /// Returns bounds of the distance to the scene's texts and pictures over columns and rows of their grid.
    #[inline]
    pub fn shape_bounds(&self, column: Interval, row: Interval) -> Interval {
        self.shapes.bounds(column, row, self.ranges.is_some())
    }

    /// Reads a channel of a texture, clamped to 0..1. Returns 0 without a reader.
    pub fn texture(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32 {
        let value = self.textures.as_ref().map_or(0.0, |reader| reader.read(texture, channel, u, v));
        unit(value)
    }
}
