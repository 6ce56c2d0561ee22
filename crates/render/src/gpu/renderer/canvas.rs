//! The targets of a series of frames, the frame in progress, and the finished image.

use super::making::{Making, Product};
use super::targets::{Targets, TargetsKind};
use crate::frame::picture::Picture;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::Result;
use crate::gpu::evaluations::Counting;
use crate::gpu::gl::Gl;
use crate::gpu::target::Target;

#[derive(Default)]
pub(in crate::gpu) struct Canvas {
    pub(super) targets: Option<Targets>,
    pub(super) making: Option<Making>,
    /// The settings of the image whose light the targets hold; `None` for a view.
    finished_light: Option<Picture>,
    /// The last image, which stays visible while an image of a different size is drawn.
    stands: Option<Target>,
}

impl Canvas {
    /// Makes targets of a kind, unless the current targets fit. If the driver refuses the size, the last image
    /// stays visible.
    pub(super) fn need_targets(
        &mut self,
        gl: &Gl,
        kind: TargetsKind,
        samples: EdgeSamples,
        counting: Counting,
    ) -> Result<()> {
        if !self.targets.as_ref().is_some_and(|targets| targets.kind == kind) {
            Target::check_size(gl, kind.size)?;
            self.put_targets_away();
            self.targets = Some(Targets::new(gl, kind, samples, counting)?);
        }
        Ok(())
    }

    /// Drops the targets. The last image stays visible until the next image is finished.
    pub(super) fn put_targets_away(&mut self) {
        (self.making, self.finished_light) = (None, None);
        if let Some(targets) = self.targets.take()
            && self.stands.is_none()
        {
            self.stands = Some(targets.post.finished);
        }
    }

    pub(super) fn finish(&mut self, making: &Making) {
        if making.product != Product::Light {
            self.stands = None;
        }
        self.finished_light = (making.product != Product::View).then_some(making.picture);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.targets.is_none() && self.stands.is_none()
    }

    pub(super) fn finished(&self) -> Option<&Target> {
        self.stands.as_ref().or(self.targets.as_ref().map(|targets| &targets.post.finished))
    }

    pub(super) fn finished_light(&self) -> Option<(&Picture, &Targets)> {
        self.finished_light.as_ref().zip(self.targets.as_ref())
    }
}
