//! Trails: the last frame, warped, blurred and dimmed, under the light of a scene (`shaders/trails.frag`).

use std::rc::Rc;

use super::error::Result;
use super::gl::Gl;
use super::passes::Passes;
use super::program::{LazyProgram, unit_of};
use super::target::Target;
use super::texel_list::{self, ListTexel, TexelList};
use crate::frame::Frame;
use crate::frame::projection::ProjectionKind;
use mariana_field::limits::LAST_LIGHT_MAX;
use mariana_field::world::{Feedback, WARP_CELLS};

pub(super) struct Trails {
    /// Adds trails to an image.
    pub(super) add: LazyProgram,
    /// Adds trails to a last frame.
    pub(super) keep: LazyProgram,
    pub(super) mix: LazyProgram,
}

/// The last frame, and how trails come from it.
#[derive(Clone)]
pub(super) struct TrailSource {
    pub(super) last: Rc<Target>,
    pub(super) grid: Rc<TexelList>,
}

impl TrailSource {
    /// Adds trails to `light` with one of the programs of [`Trails`].
    pub(super) fn draw(
        &self,
        passes: &Passes,
        program: &LazyProgram,
        light: &Target,
        output: &Target,
    ) -> Result<()> {
        light.bind_color(0, unit_of("picture"));
        self.last.bind_color(0, unit_of("last_frame"));
        texel_list::bind(&passes.gl, unit_of("warp_grid"), self.grid.texture());
        passes.draw(program, output)
    }
}

impl Trails {
    /// Mixes two last frames; `fraction` is the weight of the second one, 0..1.
    pub(super) fn mix(
        &self,
        passes: &Passes,
        first: &Target,
        second: &Target,
        fraction: f32,
        output: &Target,
    ) -> Result<()> {
        first.bind_color(0, unit_of("picture"));
        second.bind_color(0, unit_of("last_frame"));
        passes.draw_with(&self.mix, output, [fraction, 0.0])
    }
}

/// Creates the list that [`fill_grid`] fills.
pub(super) fn empty_grid(gl: &Gl) -> Result<TexelList> {
    TexelList::new(gl, ListTexel::Rgba32F, &[0; 16])
}

/// Uploads the rules and the grid of a frame's trails, in the order of `trails.frag`.
pub(super) fn fill_grid(grid: &TexelList, feedback: &Feedback, frame: &Frame) {
    let projection = &frame.projection;
    let (width, height) = projection.eye_size(frame.size);
    let aspect = (width / height) as f32;
    let (decay, blur) = (frame.picture.decay, frame.picture.blur);
    let rules = [decay, blur / aspect, blur, LAST_LIGHT_MAX];
    let (columns, rows) = projection.stereo.pictures();
    let cells = [WARP_CELLS.0 as f32, WARP_CELLS.1 as f32, columns as f32, rows as f32];
    let shape = [f32::from(u8::from(projection.kind == ProjectionKind::Dome)), 0.0, 0.0, 0.0];
    let corners = feedback.warped(&frame.inputs).into_iter().map(|[u, v]| [u, v, 0.0, 0.0]);
    let texels: Vec<[f32; 4]> = [rules, cells, shape].into_iter().chain(corners).collect();
    grid.replace(bytemuck::cast_slice(&texels));
}
