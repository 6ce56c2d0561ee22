//! Feedback: the last frame, which scenes read by `previous` and show as trails (`decay`, `warp` and `blur`).
//!
//! A frame depends on earlier frames, but not on the moment at which drawing began: see `mariana-render`, `gpu::feedback`.
//! The CPU computes `warp` on a coarse grid, as MilkDrop does, so that no shader depends on the scene, and both modes
//! warp alike.

use std::sync::Arc;

use super::World;
use crate::graph::{FrameInputs, Graph, Node, NodeId, Screen, ScreenInput, SoundInputs, TextureReader};
use crate::lang::{Diagnostic, FORGOTTEN, Picture, Scene, Span, VISIBLE, outlasting};
use crate::limits::{FEEDBACK_DECAY_MAX, FEEDBACK_FRAMES_MAX, FEEDBACK_RATE, LAST_LIGHT_MAX};
use crate::tape::{Batch, Points, Tape};

/// Columns and rows of the cells of the grid.
pub const WARP_CELLS: (usize, usize) = (64, 36);
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
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let is_read = scene.textures.iter().any(|texture| texture.is_last_frame());
        let any = super::any_frame(scene);
        let decay = scene.picture.largest_decay(&scene.graph, &any).clamp(0.0, FEEDBACK_DECAY_MAX);
        let has_trails = decay > 0.0;
        if !is_read && !has_trails {
            return None;
        }
        let warp = scene.picture.warp;
        let stays = warp.iter().any(|part| scene.graph.as_constant(*part).is_some_and(f32::is_infinite));
        let warp = (has_trails && !stays).then(|| Tape::new(&scene.graph, &warp));
        let frames = frames_of(&scene.picture, &scene.graph, decay, is_read);
        Some(Self { frames, is_read, has_trails, warp })
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

/// A last frame with the same light everywhere, as a fraction of the brightest light. Other textures are black.
#[derive(Debug)]
struct EvenLight {
    texture: u16,
    fraction: f32,
}

impl TextureReader for EvenLight {
    fn read(&self, texture: u16, _channel: u8, _u: f32, _v: f32) -> f32 {
        if texture == self.texture { self.fraction } else { 0.0 }
    }
}

/// A scene keeps the light of its last frame if it reads it at least this bright.
const GAIN: f32 = 1.001;
/// The light of the last frames that are tried, as fractions of the brightest light.
const BRIGHTNESSES: [f32; 2] = [0.25, 0.5];
/// Columns and rows of the pixels that are tried.
const TRIED: (u16, u16) = (7, 5);
/// The size of the picture in which they are.
const TRIED_SIZE: (u16, u16) = (160, 90);

/// Light that moves by less than this fraction of the picture is as bright as before, for this number of frames.
const STEP: f32 = 0.05;
const STEPS: u32 = 8;

/// A colour that reads the last frame.
struct FeedbackColor {
    colors: Tape,
    /// The texture coordinates of the colour's last read.
    place: Tape,
}

impl FeedbackColor {
    fn new(world: &World, texture: usize, colors: impl IntoIterator<Item = NodeId>) -> Option<Self> {
        let graph = &world.scene.graph;
        let roots: Vec<NodeId> = colors.into_iter().collect();
        let read = graph.order(&roots).into_iter().rev().find_map(|id| match graph.node(id) {
            Node::Texture { texture: number, u, v, .. } if usize::from(number) == texture => Some([u, v]),
            _ => None,
        });
        Some(Self { colors: Tape::new(graph, &roots), place: Tape::new(graph, &read?) })
    }

    /// Returns the factors by which the colour changes the light of even last frames of [`BRIGHTNESSES`], for points of
    /// the picture.
    fn gains(&self, frames: &[FrameInputs; 2], places: &[[f32; 2]]) -> Vec<f32> {
        let [dim, bright] = frames.each_ref().map(|inputs| run(&self.colors, inputs, places));
        let more = (BRIGHTNESSES[1] - BRIGHTNESSES[0]) * LAST_LIGHT_MAX;
        let mut gains = vec![0.0; places.len()];
        for (dim, bright) in dim.iter().zip(&bright) {
            for (gain, (dim, bright)) in gains.iter_mut().zip(dim.iter().zip(bright)) {
                *gain = ((bright - dim) / more).max(*gain);
            }
        }
        gains
    }

    /// Returns the texture coordinates that the colour reads, for points of the picture.
    fn read(&self, inputs: &FrameInputs, places: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let read = run(&self.place, inputs, places);
        let [u, v] = [0, 1].map(|part| read.get(part).map_or(&[][..], Vec::as_slice));
        u.iter().zip(v).map(|(u, v)| [*u, *v].map(|part| part.clamp(0.0, 1.0))).collect()
    }

    /// Returns the largest fraction of light that is left after `count` frames at one of some places, whose light comes
    /// from other places from frame to frame. Ends as soon as no light is visible any more.
    fn left(&self, frames: &[FrameInputs; 2], places: &[[f32; 2]], count: u32) -> f32 {
        let (mut places, mut lefts) = (places.to_vec(), vec![1.0; places.len()]);
        let (mut still, mut frame) = (0.0_f32, 0);
        while frame < count && !places.is_empty() {
            let next = self.read(&frames[1], &places);
            let moved = places.iter().zip(&next).flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]);
            let most = moved.map(f32::abs).fold(0.0, f32::max);
            let steps = ((STEP / most) as u32).clamp(1, STEPS).min(count - frame);
            let gains = self.gains(frames, &places);
            let mut rays = Vec::new();
            for (((place, next), left), gain) in places.iter().zip(next).zip(&lefts).zip(gains) {
                if next == *place {
                    still = still.max(left * gain.powf((count - frame) as f32));
                } else if left * gain.powf(steps as f32) > VISIBLE.max(still) {
                    rays.push((next, left * gain.powf(steps as f32)));
                }
            }
            (places, lefts) = rays.into_iter().unzip();
            for _ in 1..steps {
                places = self.read(&frames[1], &places);
            }
            frame += steps;
        }
        lefts.into_iter().fold(still, f32::max)
    }
}

/// Runs a tape of the sky or of a surface for points of the picture, 0..1.
fn run(tape: &Tape, inputs: &FrameInputs, places: &[[f32; 2]]) -> Vec<Vec<f32>> {
    let side = |part: usize, size: u16| places.iter().map(|at| at[part] * f32::from(size)).collect();
    let (x, y): (Vec<f32>, Vec<f32>) = (side(0, TRIED_SIZE.0), side(1, TRIED_SIZE.1));
    let normal = [0.0, 0.6, 0.8].map(|part| vec![part; places.len()]);
    let [nx, ny, nz] = normal.each_ref().map(Vec::as_slice);
    Batch::new(tape, inputs).run(Points { position: [&x, &y, nx], normal: Some([nx, ny, nz]) })
}

impl World {
    /// Returns a warning if the sky or a shining material is brighter than the last frame that it reads, so that light
    /// grows up to its limit, or if light lasts longer than the scene's memory: tried at some pixels, in silence and in
    /// the loudest sound.
    pub fn feedback_warning(&self) -> Option<Diagnostic> {
        let textures = &self.scene.textures;
        let (number, texture) = textures.iter().enumerate().find(|(_, texture)| texture.is_last_frame())?;
        let count = self.frame_tape.feedback.as_ref()?.frames;
        let emitted = self.scene.materials.iter().flat_map(|material| material.emission);
        let emission = FeedbackColor::new(self, number, emitted);
        let sky = FeedbackColor::new(self, number, self.scene.sky.color);
        let middle = |number: u16, of: u16| (f32::from(number) + 0.5) / f32::from(of);
        let (columns, rows) = TRIED;
        let places: Vec<[f32; 2]> = (0..columns * rows)
            .map(|at| [middle(at % columns, columns), middle(at / columns, rows)])
            .collect();
        let (mut most, mut left): (f32, f32) = (0.0, 0.0);
        for sound in [SoundInputs::SILENCE, SoundInputs::each(|input| input.range().1.min(1.0))] {
            let frames = BRIGHTNESSES.map(|fraction| self.tried_inputs(number, fraction, sound));
            let gain = |color: &FeedbackColor| color.gains(&frames, &places).into_iter().fold(0.0, f32::max);
            if let Some(emission) = &emission {
                let gain = gain(emission);
                // Which pixel shows a surface is not known.
                (most, left) = (most.max(gain), left.max(gain.powf(count as f32)));
            }
            if let Some(sky) = &sky {
                let gain = gain(sky);
                most = most.max(gain);
                if gain.powf(count as f32) > left.max(VISIBLE) {
                    left = left.max(sky.left(&frames, &places, count));
                }
            }
        }
        if most > GAIN {
            let message =
                format!("the last frame gains light: it is shown {most:.2} times as bright as before");
            let hint = format!("multiply `previous` by less than 1; light is limited to {LAST_LIGHT_MAX}");
            return Some(Diagnostic::warning(texture.span, message).hint(hint));
        }
        (left > VISIBLE).then(|| outlasts(left.min(1.0), count, texture.span))
    }

    fn tried_inputs(&self, texture: usize, fraction: f32, sound: SoundInputs) -> FrameInputs {
        FrameInputs {
            textures: Some(Arc::new(EvenLight { texture: texture as u16, fraction })),
            params: self.scene.params.iter().map(|param| param.default).collect(),
            shapes: self.scene.atlas.clone(),
            sound,
            screen: Screen::of_size((TRIED_SIZE.0.into(), TRIED_SIZE.1.into())),
            time: 1.0,
            ..FrameInputs::default()
        }
    }
}

/// The warning about light of which a visible fraction is left after the frames that a scene remembers.
fn outlasts(left: f32, frames: u32, span: Span) -> Diagnostic {
    let most = FEEDBACK_FRAMES_MAX;
    let message = outlasting("light of `previous` lasts", left, frames);
    // Rounded down: light that is multiplied by it is forgotten in time.
    let allowed = |frames: u32| (100.0 * FORGOTTEN.powf((frames as f32).recip())).floor() / 100.0;
    let needed = frames as f32 * FORGOTTEN.ln().abs() / left.ln().abs();
    let less = format!("multiply `previous` by at most {}", allowed(frames));
    let hint = if needed <= most as f32 {
        format!("write `picture {{ memory = {} }}`, or {less}", (needed / FEEDBACK_RATE as f32).ceil())
    } else if frames < most {
        format!(
            "{less}, or by at most {} with `picture {{ memory = {} }}`",
            allowed(most),
            most / FEEDBACK_RATE
        )
    } else {
        less
    };
    Diagnostic::warning(span, message).hint(hint)
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
            "0.95 * previous(vec2(0.5))",
            "bass + (0.9 - 0.2 * bass) * previous(vec2(pixel.x, 0))",
        ] {
            assert_eq!(gain(color), None, "{color}");
        }
        for color in [
            "1.1 * previous(vec2(0.5))",
            "(0.9 + 0.2 * bass) * previous(vec2(0))",
            "more * 1.1 * previous(vec2(t))",
        ] {
            let shown = "the last frame gains light: it is shown 1.10 times as bright as before";
            assert_eq!(gain(color).as_deref(), Some(shown), "{color}");
        }
    }

    #[test]
    fn light_that_outlasts_the_memory_is_warned_of_because_it_pulses() {
        let warned = |text: &str| {
            let warning = world_of(text).feedback_warning()?;
            Some((warning.message, warning.hint.expect("a hint")))
        };
        let forgotten = [
            "sky { color = 0.05 + 0.95 * previous(pixel / resolution) }",
            "sky { color = 0.996 * previous(pixel / resolution) * 0.9 }",
            "sky { color = 0.05 + 0.98 * previous(pixel / resolution) }\npicture { memory = 6 }",
            // Light that moves on until new light covers it.
            "sky { let q = pixel / resolution\ncolor = if q.x < 0.1 then vec3(bass) else previous(q - vec2(0.01, 0)) }",
            // A texture is no last frame.
            "sky { color = 20 * texture(\"a.png\", pixel / resolution).rgb + 0.5 * previous(vec2(0)) }",
        ];
        for text in forgotten {
            assert_eq!(warned(text), None, "{text}");
        }
        let (message, hint) =
            warned("sky { color = 0.004 + 0.996 * previous(pixel / resolution) }").expect("a warning");
        assert_eq!(
            message,
            "light of `previous` lasts longer than the scene's memory of 2 s: 62 % is left when it ends, so the brightness \
             changes every 2 s"
        );
        let less = "multiply `previous` by at most 0.95";
        assert_eq!(hint, format!("{less}, or by at most 0.99 with `picture {{ memory = 10 }}`"));
        let of_surface = "material m { emission = 0.98 * previous(p.xy) }\nobject a { shape = sphere(p, 1)  material = m }";
        for (text, hint) in [
            (
                "sky { color = 0.98 * previous(pixel / resolution) }",
                format!("write `picture {{ memory = 5 }}`, or {less}"),
            ),
            (of_surface, format!("write `picture {{ memory = 5 }}`, or {less}")),
            (
                "sky { color = previous(0.9 * pixel / resolution) }\npicture { memory = 10 }",
                "multiply `previous` by at most 0.99".to_owned(),
            ),
        ] {
            assert_eq!(warned(text).map(|one| one.1), Some(hint), "{text}");
        }
    }

    #[test]
    fn a_blend_of_scenes_with_feedback_is_refused() {
        use crate::world::{Alignment, BlendError, BlendKind};
        let (plain, trails) = (world_of("sphere(p, 1)"), world_of("sphere(p, 1)\npicture { decay = 0.9 }"));
        for (from, to) in [(&plain, &trails), (&trails, &plain)] {
            let blend = World::blend(from, to, BlendKind::Melt, &Alignment::NONE, 0.5);
            assert!(matches!(blend, Err(BlendError::Feedback(_))));
        }
    }
}
