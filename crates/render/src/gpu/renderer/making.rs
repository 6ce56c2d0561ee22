//! A picture that is being made: its passes, each in as many parts as it takes, in one go or in several.
//!
//! Between two goes anything may be drawn and shown, as long as the scene's tape, regions and sound stay as they are;
//! meanwhile the previous picture is shown.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::time::{Duration, Instant};

use glow::HasContext;

use super::{
    Edges, FIRST_SAMPLE, FURTHER_SAMPLE, Fade, FrameTimer, LISTED_SAMPLES, PASS_BLOCK_NUMBERS, Renderer,
    Targets,
};
use crate::frame::Frame;
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::gpu::error::GpuError;
use crate::gpu::program::{Program, unit_of};
use crate::gpu::scene_resources::{SceneNames, SceneResources};
use crate::gpu::target::Target;
use crate::gpu::tiles::{Costs, PART_SECONDS, Part, Parts, PixelCost};
use crate::view::legend::LegendPicture;
use crate::view::setup::ViewBlock;

/// How far a picture is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// It is finished: [`Renderer::show`] and [`Renderer::read`] bring it out.
    Finished {
        /// How long it took, in all goes.
        spent: Duration,
    },
    /// It needs another go.
    Going {
        /// How long it will take in all, in seconds, as far as is known.
        seconds: Option<f64>,
    },
}

/// A picture that was begun.
pub(super) struct Making {
    picture: Picture,
    is_view: bool,
    /// Whether only its light is wanted, to be mixed into another picture.
    only_light: bool,
    pass: Pass,
    parts: Parts,
    spent: Duration,
    /// Seconds that the draws will take which the driver was given since it was last told to begin.
    held_back: f64,
    /// Draws of samples so far, and the pixels of the largest.
    draws: (u32, u64),
}

/// What is drawn next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pass {
    /// A sample in the middle of each pixel.
    First,
    /// One of the further samples, where the stencil is set.
    Further(usize),
    /// All further samples, side by side.
    Listed,
    /// Light.
    Post,
}

/// The radius of the beam that holds all rays of a pixel, in half widths of it: half the diagonal, and a little more.
const BEAM: f32 = 1.4143;

/// Share of a picture's time that goes into its further samples, if nothing else is known.
const FURTHER_SHARE: f64 = 0.3;

impl Renderer {
    /// Draws `frame` of a scene with one of its programs into the renderer's own target; [`Renderer::show`] or
    /// [`Renderer::read`] brings it out.
    ///
    /// # Errors
    /// A size beyond the driver's, or an error that the driver reports.
    pub fn draw(&mut self, frame: &Frame, scene: &SceneResources, program: &Program) -> Result<(), GpuError> {
        self.begin(frame, scene)?;
        self.go_on(scene, program, Duration::MAX).map(|_| ())
    }

    /// Begins a picture in place of any that was not finished; [`Renderer::go_on`] draws it.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        let tree = scene.tree_of(frame);
        scene.upload_inputs(frame);
        self.begin_block(frame.size, (&frame.block(scene.world(), &tree), &frame.picture))
    }

    /// Begins a picture of which only the light is wanted, for [`Renderer::keep_light`]; what was finished before is shown
    /// until the next picture is finished.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin_light(&mut self, frame: &Frame, scene: &SceneResources) -> Result<(), GpuError> {
        self.begin(frame, scene)?;
        self.making.iter_mut().for_each(|making| making.only_light = true);
        Ok(())
    }

    /// Continues the picture that was begun, in the same scene and with one program, for about `patience`; until the
    /// picture is finished if that is [`Duration::MAX`].
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn go_on(
        &mut self,
        scene: &SceneResources,
        program: &Program,
        patience: Duration,
    ) -> Result<Progress, GpuError> {
        self.go_on_block(&scene.names(), (program, scene.costs()), patience)
    }

    /// Draws a picture of `size` pixels from a frame's blocks and what is bound for its scene.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_block(
        &mut self,
        size: (u32, u32),
        blocks: (&FrameBlock, &Picture),
        scene: &SceneNames,
        program: &Program,
    ) -> Result<(), GpuError> {
        self.begin_block(size, blocks)?;
        self.go_on_block(scene, (program, &Costs::default()), Duration::MAX).map(|_| ())
    }

    /// Draws a view of `frame` with a program of [`crate::gpu::scene_program::as_views`], and its legend over it. Its
    /// colours are the screen's: no pass of the picture changes them, and no pixel is a mean of several samples.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_view(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
        (view, legend): (&ViewBlock, Option<&LegendPicture>),
    ) -> Result<(), GpuError> {
        self.begin_view(frame, scene, view)?;
        self.go_on(scene, program, Duration::MAX)?;
        self.put_legend(legend)
    }

    /// Begins a view as [`Renderer::begin`] begins a picture. Its legend is put over it at the end.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn begin_view(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        view: &ViewBlock,
    ) -> Result<(), GpuError> {
        self.begin(frame, scene)?;
        self.become_view(view);
        Ok(())
    }

    /// Puts a legend over the view that was finished.
    ///
    /// # Errors
    /// An error that the driver reports.
    pub fn put_legend(&mut self, legend: Option<&LegendPicture>) -> Result<(), GpuError> {
        if let (Some(targets), Some(legend)) = (&self.targets, legend) {
            targets.post.finished().put_rgba8((legend.margin, legend.margin), legend.size, &legend.rgba);
        }
        self.gl.check("drawing a legend")
    }

    /// Draws a view from a frame's block and what is bound for its scene, without a legend.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_view_block(
        &mut self,
        size: (u32, u32),
        blocks: (&FrameBlock, &Picture),
        scene: &SceneNames,
        program: &Program,
        view: &ViewBlock,
    ) -> Result<(), GpuError> {
        self.begin_block(size, blocks)?;
        self.become_view(view);
        self.go_on_block(scene, (program, &Costs::default()), Duration::MAX).map(|_| ())
    }

    /// Turns the picture that was begun into a view.
    fn become_view(&mut self, view: &ViewBlock) {
        self.view_block.set(view.as_flattened());
        if let Some(making) = &mut self.making {
            making.is_view = true;
        }
    }

    /// Begins a picture: targets of its size, and what every pass reads.
    fn begin_block(
        &mut self,
        size: (u32, u32),
        (block, picture): (&FrameBlock, &Picture),
    ) -> Result<(), GpuError> {
        self.need_targets(size, picture.lens.is_some())?;
        self.frame_block.set(block.as_flattened());
        self.post.bind_picture(picture, self.edge_samples);
        self.making = Some(Making {
            picture: *picture,
            is_view: false,
            only_light: false,
            pass: Pass::First,
            parts: Parts::default(),
            spent: Duration::ZERO,
            held_back: 0.0,
            draws: (0, 0),
        });
        Ok(())
    }

    pub(super) fn go_on_block(
        &mut self,
        scene: &SceneNames,
        (program, costs): (&Program, &Costs),
        patience: Duration,
    ) -> Result<Progress, GpuError> {
        let begun = Instant::now();
        // Taken out of `self`, so that lists can grow while the rest is used.
        let (Some(mut making), Some(mut targets)) = (self.making.take(), self.targets.take()) else {
            return Ok(Progress::Finished { spent: Duration::ZERO });
        };
        self.prepare_passes();
        self.settle_samplers(&targets.first)?;
        scene.bind(&self.gl);
        let mut cost = costs.of(program);
        if making.spent == Duration::ZERO {
            if self.upscale.is_none() {
                // Nobody else asks for the time of the last picture.
                self.gpu_time();
            }
            if let Some(time) = self.gpu_cost.take() {
                cost.note(Part::whole(targets.first.size()).pixels(), time);
                cost.finish_picture();
            }
            making.parts = Parts::of(vec![Part::whole(targets.first.size())], targets.first.size(), cost);
            if making.parts.are_one(cost) {
                self.timer.iter_mut().for_each(FrameTimer::begin);
            }
        }
        let mut timer = self.timer.take();
        let mut finished = Ok(false);
        while matches!(finished, Ok(false)) && begun.elapsed() < patience {
            finished = self.step(&mut making, &mut targets, (program, &mut cost));
        }
        timer.iter_mut().for_each(FrameTimer::end);
        making.spent += begun.elapsed();
        if matches!(finished, Ok(true)) {
            cost.finish_picture();
        }
        costs.keep(program, cost);
        (self.targets, self.timer) = (Some(targets), timer);
        let progress = if finished? {
            if !making.only_light {
                self.stands = None;
                self.is_limited = false;
            }
            self.finished_light = (!making.is_view).then_some(making.picture);
            let (draws, largest) = making.draws;
            tracing::debug!("a picture in {draws} draws, the largest of {largest} pixels");
            Progress::Finished { spent: making.spent }
        } else {
            let share = if making.pass == Pass::First && !making.is_view { 1.0 - FURTHER_SHARE } else { 1.0 };
            let seconds = making.parts.seconds().map(|seconds| seconds / share);
            self.making = Some(making);
            Progress::Going { seconds }
        };
        self.gl.check("drawing a frame")?;
        Ok(progress)
    }

    /// Sets what every pass needs.
    pub(super) fn prepare_passes(&self) {
        // SAFETY: the vertices are ours.
        unsafe { self.gl.bind_vertex_array(Some(self.vertices.native())) }
        self.reset_state();
    }

    /// Lets a scene's program find the same samplers whatever was drawn last. `edges.frag`, which is drawn within a
    /// picture, changes only the first slot, where scenes have a texture that brings its own sampler.
    fn settle_samplers(&self, target: &Target) -> Result<(), GpuError> {
        self.samplers.as_ref().map_or(Ok(()), |samplers| samplers.settle(&self.gl, target))
    }

    /// Draws the next part of a picture, or moves on to the next pass. Returns whether the picture is finished.
    fn step(
        &self,
        making: &mut Making,
        targets: &mut Targets,
        (program, cost): (&Program, &mut PixelCost),
    ) -> Result<bool, GpuError> {
        if let Some(part) = making.parts.next(*cost) {
            // On a GPU, a draw that is a whole pass and is known to be short is not waited for.
            let is_measured = self.gl.info().software || !making.parts.were_one();
            let begun = Instant::now();
            self.draw_part(making, targets, program, part);
            making.draws = (making.draws.0 + 1, making.draws.1.max(part.pixels()));
            if is_measured {
                self.gl.finish();
                making.held_back = 0.0;
                making.parts.note(part, begun.elapsed(), cost);
            } else {
                // A watchdog looks at what was handed over together, which may be several passes.
                making.held_back += cost.seconds(part.pixels());
                if making.held_back > PART_SECONDS / 2.0 {
                    // SAFETY: plain state.
                    unsafe { self.gl.flush() }
                    making.held_back = 0.0;
                }
            }
            return Ok(false);
        }
        if making.is_view {
            return Ok(true);
        }
        let size = targets.first.size();
        (making.pass, making.parts) = match (making.pass, &mut targets.edges) {
            (Pass::First, Edges::Stencil(sum)) => {
                self.mark_in_stencil(&targets.first, sum)?;
                (Pass::Further(0), Parts::of(vec![Part::whole(size)], size, *cost))
            }
            (Pass::Further(sample), Edges::Stencil(_)) if sample + 1 < self.edge_samples.count() => {
                (Pass::Further(sample + 1), Parts::of(vec![Part::whole(size)], size, *cost))
            }
            (Pass::First, Edges::List(list)) => {
                self.mark_in_list(&targets.first, list.marks())?;
                let areas = list.prepare(&targets.first.read_last_red32f())?;
                (Pass::Listed, Parts::of(areas, list.samples().size(), *cost))
            }
            (Pass::Post, _) => return Ok(true),
            _ => {
                self.finish_light(targets, making)?;
                (Pass::Post, Parts::default())
            }
        };
        Ok(false)
    }

    /// Draws a part of a pass of samples.
    fn draw_part(&self, making: &Making, targets: &Targets, program: &Program, part: Part) {
        match (&targets.edges, making.pass) {
            _ if making.is_view => targets.post.finished().bind(),
            (Edges::List(list), Pass::Listed) => list.samples().bind(),
            (Edges::Stencil(sum), Pass::Further(_)) => sum.bind(),
            _ => targets.first.bind(),
        }
        match &targets.edges {
            Edges::List(list) if !making.is_view => {
                list.bind_pixels();
                program.bind();
            }
            Edges::Stencil(_) if !making.is_view => self.prepare_samples(program),
            _ => {
                self.unbind_edge_pixels();
                program.bind();
            }
        }
        let has_stencil = matches!(targets.edges, Edges::Stencil(_)) && !making.is_view;
        // SAFETY: plain state and a clear of what is bound.
        unsafe {
            let gl = &*self.gl;
            if has_stencil {
                gl.enable(glow::STENCIL_TEST);
            }
            gl.enable(glow::SCISSOR_TEST);
            let [x, y, width, height] = [part.x, part.y, part.width, part.height].map(u32::cast_signed);
            gl.scissor(x, y, width, height);
            if has_stencil && making.pass == Pass::First {
                gl.clear_stencil(1);
                gl.clear(glow::COLOR_BUFFER_BIT | glow::STENCIL_BUFFER_BIT);
            }
        }
        match making.pass {
            Pass::Further(sample) => {
                let place = self.edge_samples.offsets().nth(sample).unwrap_or_default();
                self.draw_sample(place, sample as f32, FURTHER_SAMPLE, 0.0);
            }
            Pass::Listed => self.draw_sample([0.0; 2], 0.0, LISTED_SAMPLES, 0.0),
            // A view has no further samples.
            _ if making.is_view => self.draw_sample([0.0; 2], 0.0, FIRST_SAMPLE, 0.0),
            _ => self.draw_sample([0.0; 2], 0.0, FIRST_SAMPLE, BEAM),
        }
        // SAFETY: plain state.
        unsafe {
            self.gl.disable(glow::SCISSOR_TEST);
            self.gl.disable(glow::STENCIL_TEST);
            self.gl.disable(glow::BLEND);
        }
    }

    /// Sets the stencil at edges; `sum` shares it with `first`. Clears the sum.
    pub(super) fn mark_in_stencil(&self, first: &Target, sum: &Target) -> Result<(), GpuError> {
        // SAFETY: plain state and draws on objects of ours, in the current context.
        unsafe {
            let gl = &*self.gl;
            sum.bind();
            gl.clear_stencil(0);
            gl.clear(glow::COLOR_BUFFER_BIT | glow::STENCIL_BUFFER_BIT);
            gl.enable(glow::STENCIL_TEST);
            gl.stencil_func(glow::ALWAYS, 1, 0xff);
            gl.stencil_op(glow::KEEP, glow::KEEP, glow::REPLACE);
            gl.color_mask(false, false, false, false);
            first.bind_color(0, unit_of("picture"));
            self.edges.bind(&self.gl)?;
            gl.draw_arrays(glow::TRIANGLES, 0, 3);
            gl.color_mask(true, true, true, true);
            gl.disable(glow::STENCIL_TEST);
        }
        Ok(())
    }

    /// Draws the marks of edges.
    pub(super) fn mark_in_list(&self, first: &Target, marks: &Target) -> Result<(), GpuError> {
        marks.bind();
        // SAFETY: plain draws on objects of ours, in the current context.
        unsafe {
            self.gl.clear(glow::COLOR_BUFFER_BIT);
            first.bind_color(0, unit_of("picture"));
            self.edges.bind(&self.gl)?;
            self.gl.replacing(|| self.gl.draw_arrays(glow::TRIANGLES, 0, 3));
        }
        Ok(())
    }

    /// Makes the picture of all samples, or only its light.
    fn finish_light(&self, targets: &Targets, making: &Making) -> Result<(), GpuError> {
        self.resolve(targets)?;
        if making.only_light {
            return Ok(());
        }
        let fade = self.fade.as_ref().map(Fade::mixed_in);
        self.post.finish(&targets.post, &making.picture, &targets.first, fade)
    }

    /// Makes light of the samples.
    pub(super) fn resolve(&self, targets: &Targets) -> Result<(), GpuError> {
        targets.first.bind_color(0, unit_of("picture"));
        match &targets.edges {
            Edges::Stencil(sum) => sum.bind_color(0, unit_of("extra_samples")),
            Edges::List(list) => list.bind_samples(),
        }
        self.post.resolve(&targets.post, self.edge_samples.block())
    }

    /// Sets the states in which all samples are drawn, the first and the further ones: some drivers compile a program
    /// once for each set of states.
    pub(super) fn prepare_samples(&self, program: &Program) {
        self.unbind_edge_pixels();
        // SAFETY: plain state.
        unsafe {
            self.gl.stencil_func(glow::EQUAL, 1, 0xff);
            self.gl.stencil_op(glow::KEEP, glow::KEEP, glow::KEEP);
            self.gl.enable(glow::BLEND);
            self.gl.blend_func(glow::ONE, glow::ONE);
        }
        program.bind();
    }

    /// Unbinds the list of edges where none is read: a texture left in its place may be the target of the draw.
    fn unbind_edge_pixels(&self) {
        // SAFETY: plain state.
        unsafe {
            self.gl.active_texture(glow::TEXTURE0 + unit_of("edge_pixels"));
            self.gl.bind_texture(glow::TEXTURE_2D, None);
        }
    }

    /// Draws a sample everywhere: `place` in the pixel, `number` among the further ones, `kind`, and the radius of its
    /// `beam`, in half widths of a pixel.
    pub(super) fn draw_sample(&self, place: [f32; 2], number: f32, kind: f32, beam: f32) {
        let (across, down) = self.edge_samples.block();
        let head = [place[0], place[1], kind, number, across as f32, down as f32, beam, 0.0];
        let mut block = head.into_iter().chain(self.edge_samples.offsets().flatten()).collect::<Vec<f32>>();
        block.resize(PASS_BLOCK_NUMBERS, 0.0);
        self.pass_block.set(&block);
        // SAFETY: the draw reads only what was bound for the go.
        unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) }
    }
}
