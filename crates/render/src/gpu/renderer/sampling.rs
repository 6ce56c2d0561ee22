//! Draws samples of a scene: one at the centre of each pixel, and further samples at edges.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use crate::frame::block::FrameBlock;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::Result;
use crate::gpu::gl::Gl;
use crate::gpu::media::MediaFilter;
use crate::gpu::passes::Block;
use crate::gpu::program::{LazyProgram, Program, unit_of};
use crate::gpu::samplers::Samplers;
use crate::gpu::shader_source::{ShaderLibrary, Variant};
use crate::gpu::target::Target;
use crate::view::setup::ViewBlock;

/// The shader that marks edges.
pub const EDGE_SHADER: &str = "edges.frag";

/// Number of floats in the `PassBlock` of `frame_block.glsl`.
const PASS_BLOCK_NUMBERS: usize = 8 + 2 * 16;

/// Radius of the beam around all rays of a pixel, in half pixel widths: half the diagonal and a small margin.
const BEAM: f32 = 1.4143;

#[derive(Debug, Clone, Copy)]
pub(super) enum Sample {
    /// The sample at the centre. It also finds the distance up to which the pixel's beam meets no surface.
    First,
    /// Only the sample at the centre, for views.
    Only,
    /// A further sample: its offset from the pixel's centre in pixels, and its number.
    Further([f32; 2], usize),
    Listed,
    /// The media along a ray through two by two pixels, in layers of this height in texels.
    Media(u32),
}

pub(super) struct Sampling {
    pub(super) gl: Gl,
    edges: LazyProgram,
    samplers: Option<Samplers>,
    frame_block: Block,
    pass_block: Block,
    view_block: Block,
    pub(super) media_filter: MediaFilter,
    pub(super) edge_samples: EdgeSamples,
}

impl Sampling {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        Ok(Self {
            gl: gl.clone(),
            edges: LazyProgram::new(gl, library, EDGE_SHADER, &Variant::default())?,
            samplers: gl.info().software.then(|| Samplers::new(gl, library)).transpose()?,
            frame_block: Block::new(gl, "FrameBlock")?,
            pass_block: Block::new(gl, "PassBlock")?,
            view_block: Block::new(gl, "ViewBlock")?,
            media_filter: MediaFilter::new(gl, library)?,
            edge_samples: EdgeSamples::Four,
        })
    }

    pub(super) fn set_frame(&self, block: &FrameBlock) {
        self.frame_block.set(block.as_flattened());
    }

    pub(super) fn set_view(&self, view: &ViewBlock) {
        self.view_block.set(view.as_flattened());
    }

    /// Resets a scene program's samplers. `edges.frag` needs no reset after it: it changes only the first slot.
    pub(super) fn settle_samplers(&self, target: &Target) -> Result<()> {
        self.samplers.as_ref().map_or(Ok(()), |samplers| samplers.settle(&self.gl, target))
    }

    /// Sets the stencil at edges. `sum` and `first` share this stencil. Clears the colours of `sum`.
    pub(super) fn mark_in_stencil(&self, first: &Target, sum: &Target) -> Result<()> {
        // SAFETY: sets state and draws without attributes into the target bound here, in the current context.
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

    pub(super) fn mark_in_list(&self, first: &Target, marks: &Target) -> Result<()> {
        marks.bind();
        // SAFETY: clears and draws without attributes into the target bound above, in the current context.
        unsafe {
            self.gl.clear(glow::COLOR_BUFFER_BIT);
            first.bind_color(0, unit_of("picture"));
            self.edges.bind(&self.gl)?;
            self.gl.replacing(|| self.gl.draw_arrays(glow::TRIANGLES, 0, 3));
        }
        Ok(())
    }

    /// Sets one state for first and further samples, because some drivers compile a program once per state.
    pub(super) fn prepare(&self, program: &Program) {
        self.unbind_edge_pixels();
        // SAFETY: sets state of the current context.
        unsafe {
            self.gl.stencil_func(glow::EQUAL, 1, 0xff);
            self.gl.stencil_op(glow::KEEP, glow::KEEP, glow::KEEP);
            self.gl.enable(glow::BLEND);
            self.gl.blend_func(glow::ONE, glow::ONE);
        }
        program.bind();
    }

    /// Unbinds the edge list's texture, because the next draw might write to this texture.
    pub(super) fn unbind_edge_pixels(&self) {
        self.gl.bind_unit(unit_of("edge_pixels"), glow::TEXTURE_2D, None);
    }

    pub(super) fn draw(&self, sample: Sample) {
        let media_layers = self.edge_samples.media_layers() as usize;
        let (place, number, kind, beam, layer) = match sample {
            Sample::First => ([0.0; 2], 0, 0.0, BEAM, 0.0),
            Sample::Only => ([0.0; 2], 0, 0.0, 0.0, 0.0),
            Sample::Further(place, number) => (place, number, 1.0, 0.0, 0.0),
            Sample::Listed => ([0.0; 2], 0, 2.0, 0.0, 0.0),
            Sample::Media(height) => ([0.0; 2], media_layers, 3.0, 0.0, height as f32),
        };
        let (across, down) = self.edge_samples.block();
        let head = [place[0], place[1], kind, number as f32, across as f32, down as f32, beam, layer];
        self.draw_pass(head.into_iter().chain(self.edge_samples.offsets().flatten()).collect());
    }

    /// Draws a pass of `path.frag`, which explains the numbers.
    pub(super) fn draw_paths(&self, numbers: [f32; 8]) {
        self.draw_pass(numbers.to_vec());
    }

    fn draw_pass(&self, mut block: Vec<f32>) {
        block.resize(PASS_BLOCK_NUMBERS, 0.0);
        self.pass_block.set(&block);
        // SAFETY: draws without attributes into the bound target, with the objects bound for this call, in the current
        // context.
        unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) }
    }

    pub(super) fn draw_further(&self, number: usize) {
        let place = self.edge_samples.offsets().nth(number).unwrap_or_default();
        self.draw(Sample::Further(place, number));
    }

    /// Draws the sum of a regular grid of `side` x `side` samples into the bound target. Slow.
    pub(super) fn draw_grid(&self, program: &Program, side: u32) {
        // SAFETY: clears the bound target of the current context.
        unsafe { self.gl.clear(glow::COLOR_BUFFER_BIT) }
        self.prepare(program);
        for number in 0..side * side {
            let place = [number % side, number / side];
            let place = place.map(|at| (at as f32 + 0.5) / side as f32 - 0.5);
            self.draw(Sample::Further(place, number as usize));
            self.gl.finish();
        }
        // SAFETY: sets state of the current context.
        unsafe { self.gl.disable(glow::BLEND) }
    }
}
