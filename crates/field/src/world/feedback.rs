//! Feedback: the last frame, which scenes read by `previous` and show as trails (`decay`, `warp` and `blur`).
//!
//! A frame depends on earlier frames, but not on the moment at which drawing began: see `mariana-render`, `gpu::feedback`.
//! The CPU computes `warp` on a coarse grid, as MilkDrop does, so that no shader depends on the scene, and both modes
//! warp alike.

use std::sync::Arc;

use super::World;
use crate::graph::{FrameInputs, Graph, NodeId, Point, Screen, ScreenInput, SoundInputs, TextureReader};
use crate::lang::{Diagnostic, Picture, Scene};
use crate::limits::{FEEDBACK_DECAY_MAX, FEEDBACK_FRAMES_MAX, FEEDBACK_RATE, LAST_LIGHT_MAX};
use crate::tape::{Batch, Points, Tape, TapeError, TapeOptions};

/// Columns and rows of the cells of the grid.
pub const WARP_CELLS: (usize, usize) = (64, 36);
/// Light is forgotten when less than this fraction is left.
const FORGOTTEN: f32 = 1.0 / 255.0;
/// Frames that a scene without `memory` remembers if it calls `previous`.
const REMEMBERED: u32 = 2 * FEEDBACK_RATE;

/// How the frames of a scene depend on earlier frames.
#[derive(Debug, Clone)]
pub struct Feedback {
    /// Number of earlier frames that count.
    pub frames: u32,
    /// True if the scene calls `previous`.
    pub is_read: bool,
    /// True if the scene has trails.
    pub has_trails: bool,
    /// `warp`; `None` if trails stay in place.
    warp: Option<Tape>,
}

impl Feedback {
    pub(super) fn of(scene: &Scene) -> Result<Option<Self>, TapeError> {
        let is_read = scene.textures.iter().any(|texture| texture.is_last_frame());
        let any = FrameInputs::any(scene.params.iter().map(|param| (param.min, param.max)), &scene.atlas);
        let decay = scene.picture.largest_decay(&scene.graph, &any).clamp(0.0, FEEDBACK_DECAY_MAX);
        let has_trails = decay > 0.0;
        if !is_read && !has_trails {
            return Ok(None);
        }
        let warp = scene.picture.warp;
        let stays = warp.iter().any(|part| scene.graph.as_constant(*part).is_some_and(f32::is_infinite));
        let warp = (has_trails && !stays)
            .then(|| Tape::build(&scene.graph, &warp, &TapeOptions::default()))
            .transpose()?;
        let frames = frames_of(&scene.picture, &scene.graph, decay, is_read);
        Ok(Some(Self { frames, is_read, has_trails, warp }))
    }

    /// The seconds of earlier frames that count.
    pub fn seconds(&self) -> f64 {
        f64::from(self.frames) / f64::from(FEEDBACK_RATE)
    }

    /// Returns the places in the last frame from which the trails at the corners of the grid's cells come: row by row
    /// from below, 0..1 in the frame. Places that are not finite are outside.
    pub fn warped(&self, inputs: &FrameInputs) -> Vec<[f32; 2]> {
        let (columns, rows) = WARP_CELLS;
        let corners = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
        let corners = corners.map(|(x, y)| [x as f32 / columns as f32, y as f32 / rows as f32]);
        let Some(warp) = &self.warp else { return corners.collect() };
        let size = [ScreenInput::Width, ScreenInput::Height].map(|side| inputs.screen.value(side));
        let (x, y): (Vec<f32>, Vec<f32>) = corners.map(|[u, v]| (u * size[0], v * size[1])).unzip();
        let z = vec![0.0; x.len()];
        let places = Batch::new(warp, inputs).run(Points { position: [&x, &y, &z], normal: None });
        let [u, v] = [0, 1].map(|part| places.get(part).map_or(&[][..], Vec::as_slice));
        // Interpolation between finite places gives no NaN.
        let place = |(u, v): (&f32, &f32)| [*u, *v].map(|part| if part.abs() < 1e6 { part } else { OUTSIDE });
        u.iter().zip(v).map(place).collect()
    }
}

/// Any last frame with the same light everywhere, as a fraction of the brightest light.
#[derive(Debug)]
struct EvenLight(f32);

impl TextureReader for EvenLight {
    fn read(&self, _texture: u16, _channel: u8, _u: f32, _v: f32) -> f32 {
        self.0
    }
}

/// A scene keeps the light of its last frame if it reads it at least this bright.
const GAIN: f32 = 1.001;
/// Columns and rows of the pixels that are tried.
const TRIED: (u16, u16) = (7, 5);

impl World {
    /// Returns a warning if the sky or a shining material is brighter than the last frame that it reads, so that light
    /// grows up to its limit: tried at some pixels, in silence and in the loudest sound.
    pub fn feedback_warning(&self) -> Option<Diagnostic> {
        let texture = self.scene.textures.iter().find(|texture| texture.is_last_frame())?;
        let emissions = self.scene.materials.iter().flat_map(|material| material.emission);
        let roots: Vec<NodeId> = self.scene.sky.color.into_iter().chain(emissions).collect();
        let screen = Screen::of_size((160, 90));
        let (fractions, silence) = ([0.25, 0.5], SoundInputs::SILENCE);
        let loud = SoundInputs::each(|input| input.range().1.min(1.0));
        let mut gain: f32 = 0.0;
        for sound in [silence, loud] {
            let of = |fraction| FrameInputs {
                textures: Some(Arc::new(EvenLight(fraction))),
                params: self.scene.params.iter().map(|param| param.default).collect(),
                shapes: self.scene.atlas.clone(),
                sound,
                screen,
                time: 1.0,
                ..FrameInputs::default()
            };
            let frames = fractions.map(of);
            for at in 0..TRIED.0 * TRIED.1 {
                let [column, row] = [at % TRIED.0, at / TRIED.0].map(|at| f32::from(at) + 0.5);
                let position = [column / f32::from(TRIED.0) * 160.0, row / f32::from(TRIED.1) * 90.0, 0.0];
                let point = Point { position, normal: [0.0, 0.6, 0.8] };
                let light = |frame: &FrameInputs| self.scene.graph.evaluate(&roots, &point, frame).ok();
                let (dim, bright) = (light(&frames[0])?, light(&frames[1])?);
                let more = (fractions[1] - fractions[0]) * LAST_LIGHT_MAX;
                let gains = dim.iter().zip(bright).map(|(dim, bright)| (bright - dim) / more);
                gain = gains.fold(gain, f32::max);
            }
        }
        let message = format!("the last frame gains light: it is shown {gain:.2} times as bright as it was");
        let hint = format!("multiply `previous` by less than 1; light is limited to {LAST_LIGHT_MAX}");
        (gain > GAIN).then(|| Diagnostic::warning(texture.span, message).hint(hint))
    }
}

/// A place far outside the frame.
const OUTSIDE: f32 = -1e6;

fn frames_of(picture: &Picture, graph: &Graph, decay: f32, is_read: bool) -> u32 {
    let memory = graph.as_constant(picture.memory).filter(|memory| *memory > 0.0);
    let frames = match memory {
        Some(memory) => (memory * FEEDBACK_RATE as f32).ceil(),
        None if decay > 0.0 => (FORGOTTEN.ln() / decay.ln()).ceil(),
        None => 0.0,
    };
    let least = if is_read && memory.is_none() { REMEMBERED } else { 1 };
    (frames as u32).clamp(least, FEEDBACK_FRAMES_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::testing::world_of;

    fn of(text: &str) -> Option<Feedback> {
        world_of(&format!("sphere(p, 1)\n{text}")).frame_tape.feedback
    }

    fn frames(text: &str) -> u32 {
        of(text).expect("feedback").frames
    }

    #[test]
    fn a_scene_remembers_as_many_frames_as_still_count() {
        assert!(of("").is_none());
        assert_eq!(frames("picture { decay = 0.5 }"), 8);
        assert_eq!(frames("picture { decay = 0.9 + 0.05 * bass }"), frames("picture { decay = 0.95 }"));
        assert_eq!(frames("param d = 0 in 0 .. 0.5\npicture { decay = d }"), 8);
        assert_eq!(frames("sky { color = previous(vec2(0.5)) }"), REMEMBERED);
        assert_eq!(frames("picture { memory = 0.5 }\nsky { color = previous(vec2(0.5)) }"), 30);
        assert_eq!(frames("picture { decay = 0.95  memory = 1 }"), 60);
    }

    #[test]
    fn what_would_take_minutes_or_is_no_number_is_bounded() {
        for decay in ["1", "0.9999", "2", "t", "1 / t", "exp(100 * t) - exp(99 * t)"] {
            assert_eq!(frames(&format!("picture {{ decay = {decay} }}")), FEEDBACK_FRAMES_MAX, "{decay}");
        }
        assert!(of("picture { decay = -1 }").is_none());
        assert!(of("picture { decay = 0 }").is_none());
        assert_eq!(frames("picture { decay = 0.5  memory = 9999 }"), FEEDBACK_FRAMES_MAX);
    }

    #[test]
    fn warps_are_computed_on_a_grid_and_stay_finite() {
        let screen = Screen::of_size((200, 100));
        let inputs = FrameInputs { screen, time: 1.0, ..FrameInputs::default() };
        let corners = |warp: &str| {
            let all = of(&format!("picture {{ decay = 0.9  {warp} }}")).expect("feedback").warped(&inputs);
            assert_eq!(all.len(), (WARP_CELLS.0 + 1) * (WARP_CELLS.1 + 1));
            assert!(all.iter().flatten().all(|part| part.is_finite()), "{warp}");
            [all[0], all[WARP_CELLS.0], all[all.len() - 1]]
        };
        let unmoved = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert_eq!(corners(""), unmoved);
        assert_eq!(corners("warp = pixel / resolution"), unmoved);
        assert_eq!(corners("warp = pixel / resolution + vec2(0, t)"), [[0.0, 1.0], [1.0, 1.0], [1.0, 2.0]]);
        assert_eq!(corners("warp = exp(pixel * 100)")[1], [OUTSIDE, 1.0]);
        assert_eq!(corners("warp = exp(pixel * 100) - exp(pixel * 200)")[2], [OUTSIDE; 2]);
    }

    #[test]
    fn feedback_that_gains_light_is_warned_of() {
        let gain = |color: &str| {
            let world =
                world_of(&format!("param more = 1 in 0 .. 2\nsky {{ color = {color} }}\nsphere(p, more)"));
            world.feedback_warning().map(|warning| warning.message)
        };
        for color in [
            "vec3(0.5)",
            "0.99 * previous(vec2(0.5))",
            "bass + (0.9 - 0.2 * bass) * previous(vec2(pixel.x, 0))",
        ] {
            assert_eq!(gain(color), None, "{color}");
        }
        for color in [
            "1.1 * previous(vec2(0.5))",
            "(0.9 + 0.2 * bass) * previous(vec2(0))",
            "more * 1.1 * previous(vec2(t))",
        ] {
            let shown = "the last frame gains light: it is shown 1.10 times as bright as it was";
            assert_eq!(gain(color).as_deref(), Some(shown), "{color}");
        }
    }

    #[test]
    fn a_blend_of_scenes_with_feedback_is_refused() {
        use crate::world::{Alignment, BlendError, BlendKind};
        let (plain, trails) = (world_of("sphere(p, 1)"), world_of("sphere(p, 1)\npicture { decay = 0.9 }"));
        for (from, to) in [(&plain, &trails), (&trails, &plain)] {
            let blend = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.5);
            assert!(matches!(blend, Err(BlendError::Feedback { .. })));
        }
    }
}
