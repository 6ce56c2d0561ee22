//! The frames of feedback of a scene: small images of its light, each drawn with the previous one
//! ([`crate::frame::feedback`] explains their order).
//!
//! They do not depend on the size of the window, its quality or its samples at edges. They are drawn without cells,
//! because a tree would have to be built for each of them; only the interpreter and formulas that are not distances need one.

use std::rc::Rc;

use super::edge_samples::EdgeSamples;
use super::error::Result;
use super::gl::Gl;
use super::passes::Passes;
use super::renderer::Canvas;
use super::target::Target;
use super::texel_list::TexelList;
use super::trails::{TrailSource, Trails, empty_grid, fill_grid};
use crate::frame::Frame;
use crate::frame::feedback::{FeedbackOrder, FeedbackStep, moment_of, newest_before};
use crate::frame::projection::Stereo;
use mariana_field::world::{self, World};

/// The number of pixels of a frame of feedback.
const PIXELS: f64 = 640.0 * 360.0;

/// The further samples at edges of a frame of feedback.
pub(super) const EDGES: EdgeSamples = EdgeSamples::Two;

/// The next frame of feedback to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedbackRequest {
    /// Its moment in the song, in seconds.
    pub time: f64,
    /// Its size in pixels.
    pub size: (u32, u32),
    step: FeedbackStep,
}

/// The histories of a scene.
pub(super) struct SceneFeedback {
    rules: world::Feedback,
    order: FeedbackOrder,
    /// The song and the size of the histories.
    of: Option<(u64, (u32, u32))>,
    histories: [Option<Kept>; 2],
    /// The canvas on which frames are drawn.
    pub(super) canvas: Canvas,
    grid: Rc<TexelList>,
    black: Rc<Target>,
    mixed: Option<Rc<Target>>,
    /// The frame that the scene reads as its last one.
    pub(super) last: Rc<Target>,
    gl: Gl,
}

/// The last frame of a history, and the target of its next frame.
struct Kept {
    last: Rc<Target>,
    next: Rc<Target>,
}

impl SceneFeedback {
    /// Prepares the feedback of a world; `None` if its frames do not depend on earlier ones.
    pub(super) fn of(gl: &Gl, world: &World) -> Result<Option<Self>> {
        let Some(rules) = world.frame_tape.feedback.clone() else { return Ok(None) };
        let black = Rc::new(black(gl)?);
        Ok(Some(Self {
            order: FeedbackOrder::new(rules.frames),
            rules,
            of: None,
            histories: [None, None],
            canvas: Canvas::default(),
            grid: Rc::new(empty_grid(gl)?),
            last: black.clone(),
            black,
            mixed: None,
            gl: gl.clone(),
        }))
    }

    pub(super) fn request(
        &mut self,
        song: u64,
        time: f64,
        size: (u32, u32),
        stereo: Stereo,
        ahead: bool,
    ) -> Option<FeedbackRequest> {
        let size = size_for(size, stereo);
        if self.of.replace((song, size)) != Some((song, size)) {
            (self.histories, self.mixed) = ([None, None], None);
            (self.order, self.canvas) = (FeedbackOrder::new(self.rules.frames), Canvas::default());
        }
        let step = self.order.next(newest_before(time)?, ahead)?;
        Some(FeedbackRequest { time: moment_of(step.number), size, step })
    }

    /// The number of frames that images at `time` lack.
    pub(super) fn missing(&self, time: f64) -> u64 {
        newest_before(time).map_or(0, |newest| self.order.missing(newest))
    }

    pub(super) fn skip_to(&mut self, time: f64) {
        newest_before(time).into_iter().for_each(|newest| self.order.skip_to(newest));
    }

    /// Returns the groups of histories for which the frame must be drawn separately, because they read different last
    /// frames. Prepares the targets.
    pub(super) fn groups(&mut self, request: &FeedbackRequest) -> Result<Vec<Vec<usize>>> {
        let mut slots = Vec::new();
        for (slot, begins) in request.step.begins.into_iter().enumerate() {
            let Some(begins) = begins else { continue };
            let kept = match self.histories[slot].take() {
                Some(kept) => kept,
                None => Kept { last: self.black.clone(), next: self.target(request.size)? },
            };
            // A target that is visible keeps its content.
            let last = if begins { self.black.clone() } else { kept.last };
            let is_free = Rc::strong_count(&kept.next) == 1;
            let next = if is_free { kept.next } else { self.target(request.size)? };
            self.histories[slot] = Some(Kept { last, next });
            slots.push(slot);
        }
        Ok(if self.rules.is_read { slots.into_iter().map(|slot| vec![slot]).collect() } else { vec![slots] })
    }

    /// Lets the scene read the last frame of a history.
    pub(super) fn read(&mut self, slot: usize) {
        if let Some(kept) = &self.histories[slot] {
            self.last = kept.last.clone();
        }
    }

    /// Keeps the light of a frame, with its trails, as the last frame of some histories.
    pub(super) fn keep(
        &mut self,
        passes: &Passes,
        trails: &Trails,
        frame: &Frame,
        light: &Target,
        slots: &[usize],
    ) -> Result<()> {
        fill_grid(&self.grid, &self.rules, frame);
        for slot in slots {
            let Some(Kept { last, next }) = self.histories[*slot].take() else { continue };
            let source = TrailSource { last, grid: self.grid.clone() };
            source.draw(passes, &trails.keep, light, &next)?;
            let room =
                if Rc::ptr_eq(&source.last, &self.black) { self.target(next.size())? } else { source.last };
            self.histories[*slot] = Some(Kept { last: next, next: room });
        }
        Ok(())
    }

    pub(super) fn record_drawn(&mut self, request: &FeedbackRequest) {
        self.order.record_drawn(&request.step);
    }

    /// Selects the last frame of an image at `time`.
    pub(super) fn show(&mut self, passes: &Passes, trails: &Trails, time: f64) -> Result<()> {
        let shown = newest_before(time).and_then(|newest| self.order.shown(newest));
        let of = |slot: usize| self.histories[slot].as_ref().map(|kept| kept.last.clone());
        let older = shown.and_then(|shown| of(shown.older));
        let younger = shown.and_then(|shown| shown.younger).and_then(|(slot, part)| Some((of(slot)?, part)));
        self.last = match (older, younger) {
            (Some(older), Some((younger, fraction))) => {
                let mixed = self.mixed.take().map_or_else(|| self.target(older.size()), Ok)?;
                trails.mix(passes, &older, &younger, fraction, &mixed)?;
                self.mixed = Some(mixed.clone());
                mixed
            }
            (older, _) => older.unwrap_or_else(|| self.black.clone()),
        };
        Ok(())
    }

    /// Returns the trails of an image; `None` if it has none.
    pub(super) fn trails(&self, frame: &Frame) -> Option<TrailSource> {
        if !self.rules.has_trails || frame.picture.decay <= 0.0 || Rc::ptr_eq(&self.last, &self.black) {
            return None;
        }
        fill_grid(&self.grid, &self.rules, frame);
        Some(TrailSource { last: self.last.clone(), grid: self.grid.clone() })
    }

    fn target(&self, size: (u32, u32)) -> Result<Rc<Target>> {
        Target::of_light(&self.gl, size).map(Rc::new)
    }
}

/// Creates a last frame without light. Mesa's software renderers compile another variant of a program for sides that
/// are powers of two.
pub(super) fn black(gl: &Gl) -> Result<Target> {
    let target = Target::of_light(gl, (6, 6))?;
    target.clear();
    Ok(target)
}

/// Returns the size of the frames of feedback for an image of `size` pixels: about [`PIXELS`], or as many as the image
/// has, in its aspect ratio. Each of two eyes has whole pixels. No side is a power of two (see [`black`]).
fn size_for(size: (u32, u32), stereo: Stereo) -> (u32, u32) {
    let (width, height) = size;
    let pixels = f64::from(width) * f64::from(height);
    let scale = (PIXELS / pixels.max(1.0)).sqrt().min(1.0);
    let side = |side: u32, eyes: u32| {
        let side = ((f64::from(side) / f64::from(eyes) * scale).round() as u32).max(3);
        eyes * if side.is_power_of_two() { side + 1 } else { side }
    };
    let (columns, rows) = stereo.pictures();
    (side(width, columns), side(height, rows))
}

#[cfg(test)]
mod tests {
    use super::size_for;
    use crate::frame::projection::Stereo;

    #[test]
    fn frames_of_feedback_are_small_and_have_the_aspect_of_the_image() {
        assert_eq!(size_for((1920, 1080), Stereo::None), (640, 360));
        assert_eq!(size_for((3840, 2160), Stereo::None), (640, 360));
        assert_eq!(size_for((1080, 1920), Stereo::None), (360, 640));
        assert_eq!(size_for((320, 180), Stereo::None), (320, 180));
        assert_eq!(size_for((64, 36), Stereo::None), (65, 36));
        assert_eq!(size_for((0, 1), Stereo::None), (3, 3));
        assert_eq!(size_for((128, 36), Stereo::SideBySide), (130, 36));
        assert_eq!(size_for((127, 65), Stereo::OverUnder), (127, 66));
        let (width, height) = size_for((20_000, 100), Stereo::None);
        assert!(width * height < 300_000 && width > 100 * height);
    }
}
