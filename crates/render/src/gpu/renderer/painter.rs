//! Draws frames of any scene on a canvas.

use std::time::Duration;

use web_time::Instant;

use super::canvas::Canvas;
use super::making::{Making, Product, Progress, Tools};
use super::paths::PathResults;
use super::presenter::Fade;
use super::sampling::Sampling;
use super::targets::TargetsKind;
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::gpu::error::Result;
use crate::gpu::evaluations::Counting;
use crate::gpu::gl::Gl;
use crate::gpu::post::Post;
use crate::gpu::program::Program;
use crate::gpu::scene_resources::{SceneNames, SceneResources};
use crate::gpu::shader_source::ShaderLibrary;
use crate::gpu::target::Target;
use crate::gpu::tiles::{Costs, Tile};
use crate::gpu::timer::PictureClock;

pub(super) struct Painter {
    pub(super) gl: Gl,
    pub(super) counting: Counting,
    pub(super) sampling: Sampling,
    pub(super) post: Post,
    pub(super) canvas: Canvas,
    pub(super) clock: PictureClock,
    pub(super) fade: Option<Fade>,
    /// The mean of the exposures so far.
    pub(super) mean: Option<Target>,
    pub(super) path_results: PathResults,
}

impl Painter {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self> {
        Ok(Self {
            gl: gl.clone(),
            counting,
            sampling: Sampling::new(gl, library)?,
            post: Post::new(gl, library)?,
            canvas: Canvas::default(),
            clock: PictureClock::default(),
            fade: None,
            mean: None,
            path_results: PathResults::new(gl, library)?,
        })
    }

    pub(super) fn need_targets(&mut self, size: (u32, u32), picture: &Picture) -> Result<()> {
        let kind = TargetsKind { size, has_lens: picture.lens.is_some(), has_media: picture.has_media };
        self.canvas.need_targets(&self.gl, kind, self.sampling.edge_samples, self.counting)
    }

    pub(super) fn begin(&mut self, product: Product, frame: &Frame, scene: &SceneResources) -> Result<()> {
        self.begin_without_trails(product, frame, scene)?;
        if let (Some(making), Some(feedback)) = (&mut self.canvas.making, scene.feedback()) {
            making.trails = feedback.trails(frame);
        }
        Ok(())
    }

    pub(super) fn begin_without_trails(
        &mut self,
        product: Product,
        frame: &Frame,
        scene: &SceneResources,
    ) -> Result<()> {
        let block = scene.block_of(frame);
        scene.upload_inputs(frame)?;
        self.begin_block(product, frame.size, &block, &frame.picture)
    }

    pub(super) fn begin_block(
        &mut self,
        product: Product,
        size: (u32, u32),
        block: &FrameBlock,
        picture: &Picture,
    ) -> Result<()> {
        self.need_targets(size, picture)?;
        self.sampling.set_frame(block);
        self.post.bind_picture(picture, self.sampling.edge_samples);
        self.canvas.making = Some(Making::new(*picture, product));
        Ok(())
    }

    pub(super) fn resume(
        &mut self,
        scene: &SceneNames,
        program: &Program,
        costs: &Costs,
        patience: Duration,
    ) -> Result<Progress> {
        let begun = Instant::now();
        // Take both values, so that an error drops the unfinished frame.
        let (Some(mut making), Some(mut targets)) = (self.canvas.making.take(), self.canvas.targets.take())
        else {
            return Ok(Progress::Finished { spent: Duration::ZERO });
        };
        self.post.passes.prepare();
        self.sampling.settle_samplers(&targets.first)?;
        scene.bind(&self.gl);
        let mut cost = costs.of(program);
        if making.spent == Duration::ZERO {
            if let Some(time) = self.clock.cost.take() {
                cost.record(Tile::whole(targets.first.size()).pixels(), time);
                cost.finish_picture();
            }
            if making.plan(&targets, cost) {
                self.clock.begin();
            }
        }
        let tools = Tools { sampling: &self.sampling, post: &self.post, fade: self.fade.as_ref() };
        let finished = making.resume(&tools, &mut targets, program, &mut cost, begun, patience);
        self.clock.end();
        making.spent += begun.elapsed();
        if matches!(finished, Ok(true)) {
            cost.finish_picture();
        }
        costs.keep(program, cost);
        self.canvas.targets = Some(targets);
        let progress = if finished? {
            let (draws, largest) = making.draws;
            tracing::debug!("a frame took {draws} draws, the largest of {largest} pixels");
            self.canvas.finish(&making);
            Progress::Finished { spent: making.spent }
        } else {
            let seconds = making.seconds();
            self.canvas.making = Some(making);
            Progress::Going { seconds }
        };
        self.gl.check_context("drawing a frame")?;
        Ok(progress)
    }

    pub(super) fn draw(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        costs: &Costs,
    ) -> Result<()> {
        self.begin(Product::Picture, frame, scene)?;
        self.resume(&scene.names(program), program, costs, Duration::MAX).map(|_| ())
    }

    /// Calls `draw` with another canvas, without fade and clock, then restores all three. Loses a frame in progress.
    pub(super) fn elsewhere<R>(&mut self, canvas: &mut Canvas, draw: impl FnOnce(&mut Self) -> R) -> R {
        let (clock, fade) = (std::mem::take(&mut self.clock), self.fade.take());
        std::mem::swap(&mut self.canvas, canvas);
        let result = draw(self);
        self.canvas.making = None;
        std::mem::swap(&mut self.canvas, canvas);
        self.canvas.making = None;
        (self.clock, self.fade) = (clock, fade);
        result
    }

    /// The exposed linear light of the finished image; `None` for a view. Reuses the target `room` if its size fits.
    pub(super) fn exposed(&self, room: Option<Target>) -> Result<Option<Target>> {
        let Some((picture, targets)) = self.canvas.finished_light() else { return Ok(None) };
        let size = targets.first.size();
        let room = room.filter(|room| room.size() == size);
        let light = room.map_or_else(|| Target::of_light(&self.gl, size), Ok)?;
        self.post.passes.prepare();
        self.post.bind_picture(picture, self.sampling.edge_samples);
        self.post.expose(&targets.post, picture, &targets.first, &light)?;
        self.gl.check("keeping an image's light").map(|()| Some(light))
    }
}
