//! Feedback: the last frame, which scenes read by `previous` and show as trails (`decay`, `warp` and `blur`).
//!
//! A frame depends on earlier frames, but not on the moment at which drawing began: see `mariana-render`, `gpu::feedback`.
//! The CPU computes `warp` on a coarse grid, as MilkDrop does, so that no shader depends on the scene, and both modes
//! warp alike.

use std::sync::{Arc, Mutex};

use super::World;
use crate::graph::{
    FrameInputs, Graph, NodeId, Order, Point, Screen, ScreenInput, SoundInputs, TextureReader,
};
use crate::lang::{Diagnostic, Picture, Scene, Span};
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

/// A last frame with the same light everywhere, as a fraction of the brightest light. Other textures are black.
#[derive(Debug)]
struct EvenLight {
    texture: u16,
    fraction: f32,
    /// Position of the last read.
    place: Mutex<Option<[f32; 2]>>,
}

impl TextureReader for EvenLight {
    fn read(&self, texture: u16, _channel: u8, u: f32, v: f32) -> f32 {
        if texture != self.texture {
            return 0.0;
        }
        if let Ok(mut place) = self.place.lock() {
            *place = Some([u, v]);
        }
        self.fraction
    }
}

/// A scene keeps the light of its last frame if it reads it at least this bright.
const GAIN: f32 = 1.001;
/// A scene changes visibly when a history begins if more than this fraction of light is left by then.
const VISIBLE: f32 = 4.0 * FORGOTTEN;
/// Columns and rows of the pixels that are tried.
const TRIED: (u16, u16) = (7, 5);
/// The size of the picture in which they are.
const TRIED_SIZE: (u16, u16) = (160, 90);

/// Formulas that may read the last frame.
struct Formulas {
    roots: Vec<NodeId>,
    order: Order,
}

impl Formulas {
    fn new(world: &World, roots: Vec<NodeId>) -> Option<Self> {
        let order = world.scene.graph.order(&roots).ok()?;
        Some(Self { roots, order })
    }
}

/// How formulas read the last frame in one sound.
struct LastFrameUse<'w> {
    world: &'w World,
    /// Two brightnesses of the last frame.
    frames: [(Arc<EvenLight>, FrameInputs); 2],
}

impl<'w> LastFrameUse<'w> {
    fn new(world: &'w World, texture: usize, sound: SoundInputs) -> Self {
        let of = |fraction| {
            let light = Arc::new(EvenLight { texture: texture as u16, fraction, place: Mutex::default() });
            let inputs = FrameInputs {
                textures: Some(light.clone()),
                params: world.scene.params.iter().map(|param| param.default).collect(),
                shapes: world.scene.atlas.clone(),
                sound,
                screen: Screen::of_size((TRIED_SIZE.0.into(), TRIED_SIZE.1.into())),
                time: 1.0,
                ..FrameInputs::default()
            };
            (light, inputs)
        };
        Self { world, frames: [0.25, 0.5].map(of) }
    }

    /// Returns by which factor formulas change the light of the last frame at a pixel, and the place that they read.
    fn gain(&self, formulas: &Formulas, [x, y]: [f32; 2]) -> (f32, [f32; 2]) {
        let (width, height) = (f32::from(TRIED_SIZE.0), f32::from(TRIED_SIZE.1));
        let point = Point { position: [x * width, y * height, 0.0], normal: [0.0, 0.6, 0.8] };
        let Formulas { roots, order } = formulas;
        let light = |inputs| self.world.scene.graph.evaluate_in(order, roots, &point, inputs);
        let [(dim, dim_inputs), (bright, bright_inputs)] = &self.frames;
        let more = (bright.fraction - dim.fraction) * LAST_LIGHT_MAX;
        let gains = light(dim_inputs).into_iter().zip(light(bright_inputs));
        let gain = gains.map(|(dim, bright)| (bright - dim) / more).fold(0.0, f32::max);
        let place = bright.place.lock().ok().and_then(|place| *place);
        (gain, place.unwrap_or([x, y]))
    }

    /// Returns the fraction of light that is left after `frames` frames at a pixel, whose light comes from other places
    /// from frame to frame. Ends as soon as the light is not visible any more.
    fn left(&self, formulas: &Formulas, pixel: [f32; 2], frames: u32) -> f32 {
        let (mut at, mut left) = (pixel, 1.0);
        for frame in 0..frames {
            let (gain, from) = self.gain(formulas, at);
            if from == at {
                return left * gain.powf((frames - frame) as f32);
            }
            left *= gain;
            if left < VISIBLE {
                break;
            }
            at = from.map(|part| part.clamp(0.0, 1.0));
        }
        left
    }
}

impl World {
    /// Returns a warning if the sky or a shining material is brighter than the last frame that it reads, so that light
    /// grows up to its limit, or if light lasts longer than the scene's memory: tried at some pixels, in silence and in
    /// the loudest sound.
    pub fn feedback_warning(&self) -> Option<Diagnostic> {
        let textures = &self.scene.textures;
        let (number, texture) = textures.iter().enumerate().find(|(_, texture)| texture.is_last_frame())?;
        let frames = self.frame_tape.feedback.as_ref()?.frames;
        let emissions = self.scene.materials.iter().flat_map(|material| material.emission);
        let emissions = Formulas::new(self, emissions.collect())?;
        let sky_color = Formulas::new(self, self.scene.sky.color.to_vec())?;
        let loud = SoundInputs::each(|input| input.range().1.min(1.0));
        let (mut most, mut left): (f32, f32) = (0.0, 0.0);
        for sound in [SoundInputs::SILENCE, loud] {
            let of = LastFrameUse::new(self, number, sound);
            for at in 0..TRIED.0 * TRIED.1 {
                let pixel = [
                    (f32::from(at % TRIED.0) + 0.5) / f32::from(TRIED.0),
                    (f32::from(at / TRIED.0) + 0.5) / f32::from(TRIED.1),
                ];
                let (sky, _) = of.gain(&sky_color, pixel);
                let (emission, _) = of.gain(&emissions, pixel);
                most = most.max(sky).max(emission);
                // Which pixel shows a surface is not known.
                left = left.max(emission.powf(frames as f32));
                if sky.powf(frames as f32) > left.max(VISIBLE) {
                    left = left.max(of.left(&sky_color, pixel, frames));
                }
            }
        }
        if most > GAIN {
            let message =
                format!("the last frame gains light: it is shown {most:.2} times as bright as before");
            let hint = format!("multiply `previous` by less than 1; light is limited to {LAST_LIGHT_MAX}");
            return Some(Diagnostic::warning(texture.span, message).hint(hint));
        }
        (left > VISIBLE).then(|| outlasts(left.min(1.0), frames, texture.span))
    }
}

/// The warning about light of which a visible fraction is left after the frames that a scene remembers.
fn outlasts(left: f32, frames: u32, span: Span) -> Diagnostic {
    let (rate, most) = (FEEDBACK_RATE as f32, FEEDBACK_FRAMES_MAX as f32);
    let seconds = frames as f32 / rate;
    let percent = 100.0 * left;
    let message = format!(
        "light of `previous` lasts longer than the scene's memory of {seconds} s: {percent:.0} % is left when it ends, so \
         the brightness changes every {seconds} s"
    );
    // Rounded down: light that is multiplied by it is forgotten in time.
    let allowed = |frames: f32| (100.0 * FORGOTTEN.powf(frames.recip())).floor() / 100.0;
    let needed = frames as f32 * FORGOTTEN.ln().abs() / left.ln().abs();
    let less = format!("multiply `previous` by at most {}", allowed(frames as f32));
    let hint = if needed <= most {
        format!("write `picture {{ memory = {} }}`, or {less}", (needed / rate).ceil())
    } else if (frames as f32) < most {
        format!("{less}, or by at most {} with `picture {{ memory = {} }}`", allowed(most), most / rate)
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
            assert!(matches!(blend, Err(BlendError::Feedback { .. })));
        }
    }
}
