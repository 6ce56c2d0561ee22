//! A small picture of another scene beside the one that is drawn, for who wants to know what comes next.

use super::{Renderer, Targets};
use crate::frame::Frame;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::GpuError;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::program::Program;
use crate::gpu::scene_resources::SceneResources;
use crate::placement::Placement;

/// Where such pictures are drawn, one after the other.
#[derive(Default)]
pub struct Sketch {
    targets: Option<Targets>,
}

impl Renderer {
    /// Draws a picture that nobody sees here, and sends it on its way to `reader`. What was finished last stays. A picture
    /// that is being drawn would be lost. False if it was left out, because too many are on their way.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn sketch(
        &mut self,
        sketch: &mut Sketch,
        frame: &Frame,
        (scene, program): (&SceneResources, &Program),
        reader: &mut PictureReader,
    ) -> Result<bool, GpuError> {
        let targets = std::mem::replace(&mut self.targets, sketch.targets.take());
        let edges = std::mem::replace(&mut self.edge_samples, EdgeSamples::Two);
        let dimmed = self.placing.as_mut().and_then(|placing| placing.dimmed.take());
        let (stands, finished_light) = (self.stands.take(), self.finished_light.take());
        let (timer, fade) = (self.timer.take(), self.fade.take());
        let is_limited = std::mem::replace(&mut self.is_limited, false);
        let whole = Placement::default();
        let drawn = self.draw(frame, scene, program);
        let sent = drawn.and_then(|()| self.send_placed(reader, &whole.map(), whole.part()));
        self.making = None;
        sketch.targets = std::mem::replace(&mut self.targets, targets);
        self.edge_samples = edges;
        if let Some(placing) = &mut self.placing {
            placing.dimmed = dimmed;
        }
        (self.stands, self.finished_light) = (stands, finished_light);
        (self.timer, self.fade, self.is_limited) = (timer, fade, is_limited);
        sent
    }
}
