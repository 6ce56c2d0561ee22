//! What pictures are drawn on, one after the other: their targets, the picture that is being drawn, and the finished one.

use super::making::{Making, Product};
use super::targets::Targets;
use crate::frame::picture::Picture;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::GpuError;
use crate::gpu::evaluations::Counting;
use crate::gpu::gl::Gl;
use crate::gpu::target::Target;

/// See the module.
#[derive(Default)]
pub(super) struct Canvas {
    pub(super) targets: Option<Targets>,
    /// The picture that is being drawn.
    pub(super) making: Option<Making>,
    /// The picture whose light the targets hold; none if it is a view's.
    finished_light: Option<Picture>,
    /// What is shown while a picture of another size is being drawn.
    stands: Option<Target>,
}

impl Canvas {
    /// Makes targets of `size` pixels. If the size is refused, the last picture stays.
    ///
    /// # Errors
    /// A size beyond the driver's, or no room.
    pub(super) fn need_targets(
        &mut self,
        gl: &Gl,
        (size, has_lens): ((u32, u32), bool),
        samples: EdgeSamples,
        counting: Counting,
    ) -> Result<(), GpuError> {
        if !self.targets.as_ref().is_some_and(|targets| targets.fit(size, has_lens)) {
            Target::check_size(gl, size)?;
            self.put_targets_away();
            self.targets = Some(Targets::new(gl, size, has_lens, samples, counting)?);
        }
        Ok(())
    }

    /// Makes room for other targets. The last picture is shown until the next one is finished.
    pub(super) fn put_targets_away(&mut self) {
        (self.making, self.finished_light) = (None, None);
        if let Some(targets) = self.targets.take()
            && self.stands.is_none()
        {
            self.stands = Some(targets.post.into_finished());
        }
    }

    /// What was drawn is finished.
    pub(super) fn finish(&mut self, making: &Making) {
        if making.product != Product::Light {
            self.stands = None;
        }
        self.finished_light = (making.product != Product::View).then_some(making.picture);
    }

    /// Whether nothing was drawn yet.
    pub(super) fn is_empty(&self) -> bool {
        self.targets.is_none() && self.stands.is_none()
    }

    /// The finished picture that is shown.
    pub(super) fn finished(&self) -> Option<&Target> {
        self.stands.as_ref().or(self.targets.as_ref().map(|targets| targets.post.finished()))
    }

    /// The light of the picture that was finished last; none for a view.
    pub(super) fn finished_light(&self) -> Option<(&Picture, &Targets)> {
        self.finished_light.as_ref().zip(self.targets.as_ref())
    }
}
