//! The frame in progress: its passes, each drawn in parts, in one call or several. Between two calls the caller may
//! draw and show anything, but must not change the scene's tape, regions and sound tables. The previous image stays
//! visible until the frame is finished.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::time::Duration;

use glow::HasContext;
use web_time::Instant;

use super::presenter::Fade;
use super::sampling::{Sample, Sampling};
use super::targets::{Edges, Targets};
use crate::frame::picture::Picture;
use crate::gpu::error::Result;
use crate::gpu::media::MediaTargets;
use crate::gpu::post::Post;
use crate::gpu::program::{Program, unit_of};
use crate::gpu::tiles::{DrawTimer, PART_SECONDS, Parts, PixelCost, Tile};
use crate::gpu::trails::TrailSource;

/// The progress of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// Finished: [`show`](super::Renderer::show) and [`read`](super::Renderer::read) output it.
    Finished {
        /// The time spent on the frame in all calls.
        spent: Duration,
    },
    /// Unfinished: another call is needed.
    Going {
        /// The estimated total time in seconds, if known.
        seconds: Option<f64>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Product {
    Picture,
    /// Only the frame's light, for mixing into another image.
    Light,
    View,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pass {
    /// The media, in half of the width and height.
    Media,
    First,
    /// One of the further samples, drawn where the stencil is set.
    Further(usize),
    Listed,
    Post,
}

pub(super) struct Tools<'a> {
    pub sampling: &'a Sampling,
    pub post: &'a Post,
    pub fade: Option<&'a Fade>,
}

pub(super) struct Making {
    pub(super) picture: Picture,
    pub(super) product: Product,
    /// The trails to add; `None` if there are none.
    pub(super) trails: Option<TrailSource>,
    pass: Pass,
    parts: Parts,
    pub(super) spent: Duration,
    /// Estimated seconds of the draws since the last flush.
    held_back: f64,
    /// Number of draws of samples so far, and the number of pixels of the largest draw.
    pub(super) draws: (u32, u64),
}

/// Assumed fraction of a frame's time that further samples take.
const FURTHER_FRACTION: f64 = 0.3;

impl Making {
    pub(super) fn new(picture: Picture, product: Product) -> Self {
        Self {
            picture,
            product,
            trails: None,
            pass: Pass::First,
            parts: Parts::default(),
            spent: Duration::ZERO,
            held_back: 0.0,
            draws: (0, 0),
        }
    }

    /// Plans the first pass over `targets`. Returns true if it is a single draw.
    pub(super) fn plan(&mut self, targets: &Targets, cost: PixelCost) -> bool {
        let media = targets.media.as_ref().filter(|_| self.product != Product::View);
        if media.is_some() {
            self.pass = Pass::Media;
        }
        let size = media.map_or(&targets.first, |media| &media.rays).size();
        self.parts = Parts::of(vec![Tile::whole(size)], size, cost);
        self.parts.are_one(cost)
    }

    /// Estimated duration of the whole frame, in seconds; `None` before the first measurement.
    pub(super) fn seconds(&self) -> Option<f64> {
        let is_first = self.pass == Pass::First && self.product != Product::View;
        let fraction = if is_first { 1.0 - FURTHER_FRACTION } else { 1.0 };
        self.parts.seconds().map(|seconds| seconds / fraction)
    }

    pub(super) fn resume(
        &mut self,
        tools: &Tools<'_>,
        targets: &mut Targets,
        program: &Program,
        cost: &mut PixelCost,
        begun: Instant,
        patience: Duration,
    ) -> Result<bool> {
        let mut is_finished = false;
        while !is_finished && begun.elapsed() < patience {
            is_finished = match self.parts.next(*cost) {
                Some(part) => {
                    self.draw_measured(tools.sampling, targets, program, cost, part);
                    false
                }
                None => self.finish_pass(tools, targets, *cost)?,
            };
        }
        Ok(is_finished)
    }

    fn draw_measured(
        &mut self,
        sampling: &Sampling,
        targets: &Targets,
        program: &Program,
        cost: &mut PixelCost,
        part: Tile,
    ) {
        let gl = &sampling.gl;
        // If the GPU measures a pass of a single draw, do not measure it here: measuring would wait for the draw.
        let is_measured = !gl.info().has_timers() || !self.parts.were_one();
        let timer = DrawTimer::start(gl.info().software);
        self.draw_part(sampling, targets, program, part);
        self.draws = (self.draws.0 + 1, self.draws.1.max(part.pixels()));
        if is_measured {
            gl.finish();
            self.held_back = 0.0;
            self.parts.record(part, timer.stop(), cost);
        } else {
            // A watchdog measures the time since the last flush, which may contain several passes.
            self.held_back += cost.seconds(part.pixels());
            if self.held_back > PART_SECONDS / 2.0 {
                // SAFETY: flushes the current context.
                unsafe { gl.flush() }
                self.held_back = 0.0;
            }
        }
    }

    fn finish_pass(&mut self, tools: &Tools<'_>, targets: &mut Targets, cost: PixelCost) -> Result<bool> {
        if self.product == Product::View {
            return Ok(true);
        }
        let (sampling, size) = (tools.sampling, targets.first.size());
        (self.pass, self.parts) = match (self.pass, &mut targets.edges) {
            (Pass::Media, _) => {
                if let Some(media) = &targets.media {
                    sampling.media_filter.draw(&tools.post.passes, media)?;
                }
                (Pass::First, Parts::of(vec![Tile::whole(size)], size, cost))
            }
            (Pass::First, Edges::Stencil(sum)) => {
                sampling.mark_in_stencil(&targets.first, sum)?;
                (Pass::Further(0), Parts::of(vec![Tile::whole(size)], size, cost))
            }
            (Pass::Further(sample), Edges::Stencil(_)) if sample + 1 < sampling.edge_samples.count() => {
                (Pass::Further(sample + 1), Parts::of(vec![Tile::whole(size)], size, cost))
            }
            (Pass::First, Edges::List(list)) => {
                sampling.mark_in_list(&targets.first, &list.marks)?;
                let areas = list.prepare(&targets.first.read_last_red32f())?;
                (Pass::Listed, Parts::of(areas, list.samples.size(), cost))
            }
            (Pass::Post, _) => return Ok(true),
            _ => {
                resolve(tools, targets)?;
                self.finish_resolved(tools, targets)?;
                (Pass::Post, Parts::default())
            }
        };
        Ok(false)
    }

    fn draw_part(&self, sampling: &Sampling, targets: &Targets, program: &Program, part: Tile) {
        let is_view = self.product == Product::View;
        match (&targets.edges, self.pass) {
            _ if is_view => targets.post.finished.bind(),
            (_, Pass::Media) => targets.media.iter().for_each(|media| media.rays.bind()),
            (Edges::List(list), Pass::Listed) => list.samples.bind(),
            (Edges::Stencil(sum), Pass::Further(_)) => sum.bind(),
            _ => targets.first.bind(),
        }
        match &targets.edges {
            Edges::List(list) if !is_view => {
                list.bind_pixels();
                program.bind();
            }
            Edges::Stencil(_) if !is_view => sampling.prepare(program),
            _ => {
                sampling.unbind_edge_pixels();
                program.bind();
            }
        }
        targets.media.iter().for_each(MediaTargets::bind_mean);
        let has_stencil = matches!(targets.edges, Edges::Stencil(_)) && !is_view && self.pass != Pass::Media;
        let gl = &sampling.gl;
        // SAFETY: sets state and clears the target bound above, in the current context.
        unsafe {
            if has_stencil {
                gl.enable(glow::STENCIL_TEST);
            }
            gl.enable(glow::SCISSOR_TEST);
            let [x, y, width, height] = [part.x, part.y, part.width, part.height].map(u32::cast_signed);
            gl.scissor(x, y, width, height);
            if self.pass == Pass::Media {
                // OpenGL ES cannot blend 32-bit floats.
                gl.disable(glow::BLEND);
            }
            if has_stencil && self.pass == Pass::First {
                gl.clear_stencil(1);
                gl.clear(glow::COLOR_BUFFER_BIT | glow::STENCIL_BUFFER_BIT);
            }
        }
        match self.pass {
            Pass::Further(sample) => sampling.draw_further(sample),
            Pass::Listed => sampling.draw(Sample::Listed),
            Pass::Media => {
                let height = targets.media.as_ref().map_or(1, |media| media.mean.size().1);
                sampling.draw(Sample::Media(height));
            }
            // A view has no further samples.
            _ if is_view => sampling.draw(Sample::Only),
            _ => sampling.draw(Sample::First),
        }
        // SAFETY: sets state of the current context.
        unsafe {
            gl.disable(glow::SCISSOR_TEST);
            gl.disable(glow::STENCIL_TEST);
            gl.disable(glow::BLEND);
        }
    }

    /// Finishes the image of light that is resolved.
    pub(super) fn finish_resolved(&self, tools: &Tools<'_>, targets: &mut Targets) -> Result<()> {
        if let Some(trails) = &self.trails {
            tools.post.add_trails(&mut targets.post, trails)?;
        }
        if self.product == Product::Light {
            return Ok(());
        }
        let fade = tools.fade.map(|fade| (&fade.light, fade.fraction));
        tools.post.finish(&targets.post, &self.picture, &targets.first, fade)
    }
}

/// Warms up the driver: draws all passes that follow the first samples, with the content of `targets`.
pub(super) fn rehearse_passes(tools: &Tools<'_>, targets: &mut Targets, picture: &Picture) -> Result<()> {
    match &mut targets.edges {
        Edges::Stencil(sum) => tools.sampling.mark_in_stencil(&targets.first, sum)?,
        Edges::List(list) => {
            tools.sampling.mark_in_list(&targets.first, &list.marks)?;
            list.prepare(&[])?;
        }
    }
    resolve(tools, targets)?;
    tools.post.finish(&targets.post, picture, &targets.first, None)
}

fn resolve(tools: &Tools<'_>, targets: &Targets) -> Result<()> {
    targets.first.bind_color(0, unit_of("picture"));
    match &targets.edges {
        Edges::Stencil(sum) => sum.bind_color(0, unit_of("extra_samples")),
        Edges::List(list) => list.bind_samples(),
    }
    tools.post.resolve(&targets.post, tools.sampling.edge_samples.block())
}
