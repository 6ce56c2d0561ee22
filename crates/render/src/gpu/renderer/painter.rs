//! Draws frames of any scene on a canvas.

use std::time::{Duration, Instant};

use super::canvas::Canvas;
use super::fade::Fade;
use super::making::{Making, Product, Progress, Tools, rehearse_passes};
use super::paths::PathResults;
use super::sampling::Sampling;
use super::targets::{Targets, TargetsKind};
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::GpuError;
use crate::gpu::evaluations::Counting;
use crate::gpu::feedback::{self, FeedbackRequest};
use crate::gpu::gl::Gl;
use crate::gpu::media::MediaTargets;
use crate::gpu::passes::Passes;
use crate::gpu::post::Post;
use crate::gpu::program::{Program, unit_of};
use crate::gpu::scene_resources::{SceneNames, SceneResources};
use crate::gpu::shader_source::ShaderLibrary;
use crate::gpu::target::{Target, Texel};
use crate::gpu::tiles::{Costs, Part};
use crate::gpu::timer::PictureClock;

/// Samples of a reference image along each side of a pixel.
const REFERENCE_SIDE: u32 = 8;

/// Size of the warm-up image: large enough for several levels of bloom. Software renderers compile separate variants
/// for powers of two, so no side of the image or of its bloom levels is a power of two.
const WARM_UP_SIZE: (u32, u32) = (90, 54);

pub(super) struct Painter {
    pub(super) gl: Gl,
    pub(super) counting: Counting,
    pub(super) sampling: Sampling,
    pub(super) post: Post,
    pub(super) canvas: Canvas,
    pub(super) clock: PictureClock,
    pub(super) fade: Option<Fade>,
    /// The mean of the exposures so far.
    mean: Option<Target>,
    pub(super) path_results: PathResults,
}

impl Painter {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary, counting: Counting) -> Result<Self, GpuError> {
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

    pub(super) fn passes(&self) -> &Passes {
        self.post.passes()
    }

    pub(super) fn finished(&self) -> Option<&Target> {
        self.canvas.finished()
    }

    pub(super) fn set_edge_samples(&mut self, samples: EdgeSamples) {
        if self.sampling.edge_samples != samples {
            tracing::debug!("{} further samples at edges", samples.count());
            self.sampling.edge_samples = samples;
            self.canvas.put_targets_away();
        }
    }

    /// Draws an empty image with every pass that follows a scene's samples, if no image was drawn before. Returns the
    /// image's targets.
    pub(super) fn warm_up(&mut self, picture: &Picture) -> Result<Option<Targets>, GpuError> {
        if !self.canvas.is_empty() {
            return Ok(None);
        }
        self.need_targets(WARM_UP_SIZE, picture)?;
        let Some(mut targets) = self.canvas.targets.take() else { return Ok(None) };
        self.post.bind_picture(picture, self.sampling.edge_samples);
        self.post.passes().prepare();
        let tools = Tools { sampling: &self.sampling, post: &self.post, fade: None };
        rehearse_passes(&tools, &mut targets, picture)?;
        Ok(Some(targets))
    }

    pub(super) fn need_targets(&mut self, size: (u32, u32), picture: &Picture) -> Result<(), GpuError> {
        let kind = TargetsKind { size, has_lens: picture.lens.is_some(), has_media: picture.has_media };
        self.canvas.need_targets(&self.gl, kind, self.sampling.edge_samples, self.counting)
    }

    pub(super) fn begin(
        &mut self,
        product: Product,
        frame: &Frame,
        scene: &SceneResources,
    ) -> Result<(), GpuError> {
        self.begin_without_trails(product, frame, scene)?;
        if let (Some(making), Some(feedback)) = (&mut self.canvas.making, scene.feedback()) {
            making.trails = feedback.trails(frame);
        }
        Ok(())
    }

    fn begin_without_trails(
        &mut self,
        product: Product,
        frame: &Frame,
        scene: &SceneResources,
    ) -> Result<(), GpuError> {
        let tree = scene.tree_of(frame);
        scene.upload_inputs(frame)?;
        self.begin_block(product, frame.size, &frame.block(scene.world(), &tree), &frame.picture)
    }

    /// Draws a frame of feedback for each group of histories with its own last frame.
    pub(super) fn draw_feedback(
        &mut self,
        request: &FeedbackRequest,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<(), GpuError> {
        let Some(mut feedback) = scene.feedback() else { return Ok(()) };
        let (groups, mut canvas) = (feedback.groups(request)?, std::mem::take(&mut feedback.canvas));
        drop(feedback);
        let edges = std::mem::replace(&mut self.sampling.edge_samples, feedback::EDGES);
        let drawn = scene.without_cells(|| {
            groups.iter().try_for_each(|slots| {
                let read = slots.first().copied().unwrap_or_default();
                scene.feedback().iter_mut().for_each(|feedback| feedback.read(read));
                self.elsewhere(&mut canvas, |painter| {
                    painter.begin_without_trails(Product::Light, frame, scene)?;
                    painter.resume(&scene.names(), program, scene.costs(), Duration::MAX)?;
                    let Some(targets) = &painter.canvas.targets else { return Ok(()) };
                    let Some(mut feedback) = scene.feedback() else { return Ok(()) };
                    let (passes, trails) = (painter.post.passes(), painter.post.programs_of_trails());
                    feedback.keep(passes, trails, frame, targets.post.light(), slots)
                })
            })
        });
        self.sampling.edge_samples = edges;
        if let Some(mut feedback) = scene.feedback() {
            feedback.canvas = canvas;
            feedback.record_drawn(request);
        }
        drawn
    }

    pub(super) fn show_feedback(&self, scene: &SceneResources, time: f64) -> Result<(), GpuError> {
        let Some(mut feedback) = scene.feedback() else { return Ok(()) };
        self.post.passes().prepare();
        feedback.show(self.post.passes(), self.post.programs_of_trails(), time)?;
        self.gl.check("mixing frames of feedback")
    }

    pub(super) fn begin_block(
        &mut self,
        product: Product,
        size: (u32, u32),
        block: &FrameBlock,
        picture: &Picture,
    ) -> Result<(), GpuError> {
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
    ) -> Result<Progress, GpuError> {
        let begun = Instant::now();
        // Take both values, so that an error drops the unfinished frame.
        let (Some(mut making), Some(mut targets)) = (self.canvas.making.take(), self.canvas.targets.take())
        else {
            return Ok(Progress::Finished { spent: Duration::ZERO });
        };
        self.post.passes().prepare();
        self.sampling.settle_samplers(&targets.first)?;
        scene.bind(&self.gl);
        let mut cost = costs.of(program);
        if making.spent == Duration::ZERO {
            if let Some(time) = self.clock.drain_cost() {
                cost.record(Part::whole(targets.first.size()).pixels(), time);
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
            let (draws, largest) = making.draws();
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
    ) -> Result<(), GpuError> {
        self.begin(Product::Picture, frame, scene)?;
        self.resume(&scene.names(), program, costs, Duration::MAX).map(|_| ())
    }

    pub(super) fn draw_reference(
        &self,
        picture: &Picture,
        scene: &SceneNames,
        program: &Program,
    ) -> Result<(), GpuError> {
        let Some(targets) = &self.canvas.targets else { return Ok(()) };
        scene.bind(&self.gl);
        let sum = Target::new(&self.gl, targets.first.size(), &[Texel::Rgba32F], None)?;
        sum.bind();
        targets.media.iter().for_each(MediaTargets::bind_mean);
        self.sampling.draw_grid(program, REFERENCE_SIDE);
        sum.bind_color(0, unit_of("extra_samples"));
        self.post.resolve_all(&targets.post)?;
        self.post.finish(&targets.post, picture, &targets.first, None)?;
        self.gl.check("drawing a reference")
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

    /// Draws a frame twice on a temporary canvas: first without a fade, then with a fade.
    pub(super) fn rehearse(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<(), GpuError> {
        self.elsewhere(&mut Canvas::default(), |painter| {
            // The driver may compile during this draw, so do not record its time as the scene's cost.
            painter.draw(frame, scene, program, &Costs::default())?;
            painter.keep_light()?;
            painter.set_fade(Some(0.5));
            painter.draw(frame, scene, program, scene.costs())
        })
    }

    /// Draws a frame on another canvas, with two further samples at edges, and passes the image to `send`.
    pub(super) fn sketch(
        &mut self,
        canvas: &mut Canvas,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        send: impl FnOnce(&Passes, &Target) -> Result<bool, GpuError>,
    ) -> Result<bool, GpuError> {
        let edges = std::mem::replace(&mut self.sampling.edge_samples, EdgeSamples::Two);
        let sent = self.elsewhere(canvas, |painter| {
            painter.draw(frame, scene, program, scene.costs())?;
            let Some(picture) = painter.finished() else { return Ok(false) };
            let sent = send(painter.passes(), picture)?;
            painter.gl.check("sending an image").map(|()| sent)
        });
        self.sampling.edge_samples = edges;
        sent
    }

    pub(super) fn keep_light(&mut self) -> Result<bool, GpuError> {
        let old = self.fade.take().map(Fade::into_light);
        self.fade = self.exposed(old)?.map(Fade::of);
        Ok(self.fade.is_some())
    }

    /// The exposed linear light of the finished image; `None` for a view. Reuses the target `room` if its size fits.
    pub(super) fn exposed(&self, room: Option<Target>) -> Result<Option<Target>, GpuError> {
        let Some((picture, targets)) = self.canvas.finished_light() else { return Ok(None) };
        let light = match room.filter(|room| room.size() == targets.first.size()) {
            Some(room) => room,
            None => Target::new(&self.gl, targets.first.size(), &[Texel::Rgba16F], None)?.smooth(),
        };
        self.post.passes().prepare();
        self.post.bind_picture(picture, self.sampling.edge_samples);
        self.post.expose(&targets.post, picture, &targets.first, &light)?;
        self.gl.check("keeping an image's light").map(|()| Some(light))
    }

    /// Mixes the finished image's light, with its fade, into the mean of `number` earlier exposures.
    pub(super) fn add_exposure(&mut self, number: usize) -> Result<(), GpuError> {
        let Some((picture, targets)) = self.canvas.finished_light() else { return Ok(()) };
        let size = targets.first.size();
        let earlier = self.mean.take().filter(|mean| number > 0 && mean.size() == size);
        // Whole floats keep the light of still parts exactly.
        let mean = Target::new(&self.gl, size, &[Texel::Rgba32F], None)?;
        self.post.passes().prepare();
        self.post.bind_picture(picture, self.sampling.edge_samples);
        let fade = self.fade.as_ref().map(Fade::mixed_in);
        let earlier = earlier.as_ref().map(|mean| (mean, 1.0 / (number as f32 + 1.0)));
        self.post.add_exposure(&targets.post, picture, &targets.first, fade, earlier, &mean)?;
        self.mean = Some(mean);
        self.gl.check("adding an exposure")
    }

    /// Finishes the image of the exposures' mean.
    pub(super) fn finish_exposures(&mut self) -> Result<(), GpuError> {
        let (Some((picture, targets)), Some(mean)) = (self.canvas.finished_light(), self.mean.take()) else {
            return Ok(());
        };
        self.post.passes().prepare();
        self.post.bind_picture(picture, self.sampling.edge_samples);
        self.post.finish_mean(&targets.post, picture, &mean)?;
        self.gl.check("finishing the exposures")
    }

    pub(super) fn set_fade(&mut self, fraction: Option<f32>) {
        match (fraction, &mut self.fade) {
            (Some(fraction), Some(fade)) => fade.set_fraction(fraction),
            _ => self.fade = None,
        }
    }
}
