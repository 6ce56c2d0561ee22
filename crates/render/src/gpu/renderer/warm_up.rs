//! The first draws of the passes that all scenes share, while there is no scene to draw yet: many drivers finish a program
//! only when it first draws.

use super::{Edges, Renderer};
use crate::frame::picture::Picture;
use crate::gpu::error::GpuError;

/// Size of the picture: large enough for several levels of bloom. Software renderers make programs of their own for powers
/// of two, which are neither here nor among the levels' sides.
const SIZE: (u32, u32) = (90, 54);

impl Renderer {
    /// Draws an empty picture that nobody sees with every pass that a scene's first picture in a window takes, made as
    /// `picture` says, for as long as that `is_wanted`; what the limiter of flashes takes comes last. Nothing happens once
    /// something was drawn.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn warm_up(
        &mut self,
        picture: &Picture,
        is_wanted: &mut dyn FnMut() -> bool,
    ) -> Result<(), GpuError> {
        if self.targets.is_some() || self.stands.is_some() {
            return Ok(());
        }
        self.need_targets(SIZE, picture.lens.is_some())?;
        let Some(mut targets) = self.targets.take() else { return Ok(()) };
        self.post.bind_picture(picture, self.edge_samples);
        self.prepare_passes();
        match &mut targets.edges {
            Edges::Stencil(sum) => self.mark_in_stencil(&targets.first, sum)?,
            Edges::List(list) => {
                self.mark_in_list(&targets.first, list.marks())?;
                list.prepare(&[])?;
            }
        }
        self.resolve(&targets)?;
        self.post.finish(&targets.post, picture, &targets.first, None)?;
        let finished = targets.post.finished();
        if let Some(upscale) = &self.upscale {
            self.enlarge(upscale, finished, SIZE, Some([0; 4]))?;
        }
        self.flashes.iter_mut().for_each(|flashes| flashes.warm_up(finished, is_wanted));
        self.gl.check("drawing an empty picture")
    }
}
