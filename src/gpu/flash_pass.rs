//! Limits the flashes of finished pictures: measures their cells, decides which to dim, and dims them.
//!
//! Everything stays on the GPU, so that no picture waits for what the GPU says about it, and yet the picture that
//! shows the fourth flash is itself dimmed. What is known of each cell lies in textures of a texel for each, which two
//! passes write anew for each picture; what depends on many cells, the crowded fields and the areas around flashes,
//! is computed in rows of bits:
//!
//! 1. `cells.frag` takes the mean colours of the cells.
//! 2. `flash_follow.frag` finds changes, and marks the cells that change too often.
//! 3. `flash_rows.frag`, `flash_fields.frag` and `flash_areas.frag` find those that are limited.
//! 4. `flash_decide.frag` decides how bright cells are shown; `flash_centres.frag` makes gains at their centres of it.
//! 5. `limit_flashes.frag` is drawn over the picture where it is shown, in those cells alone. All other pixels stay
//!    as they are, and a picture in which nothing is limited costs no pass over it.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::VertexArray;
use super::post::Block;
use super::program::{Program, ProgramTexts, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use crate::flash::{CELLS, CENTRE_RATES, COLUMNS, Correction, Grid, ROWS, Steps};

/// The shader that places the cells to be dimmed.
pub const FLASH_VERTEX_SHADER: &str = "flash_cells.vert";
/// The fragment shaders of the limiter and their defines.
pub const FLASH_SHADERS: [(&str, &[&str]); 9] = [
    ("cells.frag", &[]),
    ("flash_follow.frag", &[]),
    ("flash_rows.frag", &[]),
    ("flash_fields.frag", &[]),
    ("flash_areas.frag", &[]),
    ("flash_decide.frag", &[]),
    ("flash_centres.frag", &[]),
    ("limit_flashes.frag", &[]),
    ("limit_flashes.frag", &["ENLARGED"]),
];

/// What `flash_follow.frag` writes, in the order of its outputs.
const FOLLOWED: [&str; 6] =
    ["light_swings", "red_swings", "light_ages", "light_rest", "red_ages", "red_rest"];
/// What `flash_decide.frag` writes.
const DECIDED: [&str; 6] =
    ["shown_swings", "shown_ages", "shown_rest", "corrections", "shown_red_swings", "shown_red_ages"];
/// What `flash_rows.frag` writes.
const ROW_MARKS: [&str; 2] = ["marked_rows", "bright_rows"];
/// What is drawn for each picture, one after the other.
pub const PASSES: usize = 7;
/// Cells of a rectangle of `flash_cells.vert`.
const GROUP: usize = 16;

/// The limiter, and what it needs on the GPU.
pub struct FlashPass {
    gl: Gl,
    measure: Program,
    follow: Program,
    gather: Program,
    find_fields: Program,
    find_areas: Program,
    decide: Program,
    centre: Program,
    limit: Program,
    limit_enlarged: Program,
    /// What the passes over cells read.
    step_block: Block,
    /// What is told to a single pass.
    place_block: Block,
    vertices: VertexArray,
    cells: Target,
    /// What is remembered: of this picture, and of the one before.
    followed: [Target; 2],
    decided: [Target; 2],
    marks: Target,
    covered: Target,
    areas: Target,
    /// Rounds take turns with these.
    gains: [Target; 2],
    steps: Steps,
    /// Whether nothing is known of any picture before the next.
    is_fresh: bool,
}

impl FlashPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// What the driver refuses, with its log.
    pub fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let [measure, follow, gather, find_fields, find_areas, decide, centre, limit, limit_enlarged] =
            FLASH_SHADERS.map(|(shader, defines)| move || linked(gl, library, shader, defines));
        let of_cells =
            |count: usize| Target::new(gl, (COLUMNS as u32, ROWS as u32), &vec![Texel::Rgba32F; count], None);
        let of_rows = |count: usize| Target::new(gl, (1, ROWS as u32), &vec![Texel::Rgba32F; count], None);
        let pass = Self {
            gl: gl.clone(),
            measure: measure()?,
            follow: follow()?,
            gather: gather()?,
            find_fields: find_fields()?,
            find_areas: find_areas()?,
            decide: decide()?,
            centre: centre()?,
            limit: limit()?,
            limit_enlarged: limit_enlarged()?,
            step_block: Block::new(gl, "FlashBlock")?,
            place_block: Block::new(gl, "PostBlock")?,
            vertices: VertexArray::new(gl)?,
            cells: of_cells(1)?,
            followed: [of_cells(FOLLOWED.len())?, of_cells(FOLLOWED.len())?],
            decided: [of_cells(DECIDED.len())?, of_cells(DECIDED.len())?],
            marks: of_rows(ROW_MARKS.len())?,
            covered: of_rows(1)?,
            areas: of_rows(1)?,
            gains: [of_cells(1)?, of_cells(1)?],
            steps: Steps::default(),
            is_fresh: true,
        };
        gl.check("setting up the flash limiter")?;
        Ok(pass)
    }

    /// Starts afresh: what comes next is another kind of picture, which the user asked for.
    pub fn forget(&mut self) {
        self.is_fresh = true;
        self.steps = Steps::default();
    }

    /// Draws once with each program, for as long as that `is_wanted`, so that the driver has nothing left to make when
    /// pictures come. Nothing is seen, and nothing of it is known later.
    pub fn warm_up(&mut self, picture: &Target, is_wanted: &mut dyn FnMut() -> bool) {
        self.begin(0.0);
        let passes = (0..PASSES).take_while(|_| is_wanted());
        passes.for_each(|number| {
            self.reset_state();
            self.pass(number, picture);
        });
        // A picture after none is dimmed nowhere, so nothing of the window changes.
        let (width, height) = picture.size();
        let windows = [(width, height), (width + 1, height)].into_iter().take_while(|_| is_wanted());
        windows.for_each(|window| self.limit_in_window(picture, window));
        self.forget();
    }

    /// Takes a finished picture that is shown `seconds` after the last one, and decides what to dim in it. In the first one
    /// nothing is dimmed.
    pub fn take(&mut self, finished: &Target, seconds: f64) {
        self.begin(seconds);
        (0..PASSES).for_each(|number| self.pass(number, finished));
    }

    /// Begins the passes of a picture.
    fn begin(&mut self, seconds: f64) {
        let step = self.steps.next(seconds);
        let flag = |is: bool| f32::from(u8::from(is));
        let is_fresh = std::mem::take(&mut self.is_fresh);
        self.step_block.set(&[step.seconds as f32, flag(step.forgets), flag(is_fresh), 0.0]);
        self.followed.swap(0, 1);
        self.decided.swap(0, 1);
        self.reset_state();
    }

    /// One of the [`PASSES`] of a picture, which reads what the ones before have bound and drawn.
    fn pass(&self, number: usize, finished: &Target) {
        let [followed, followed_before] = &self.followed;
        let [decided, decided_before] = &self.decided;
        match number {
            0 => {
                finished.bind_color(0, unit_of("picture"));
                self.draw(&self.measure, &self.cells);
            }
            1 => {
                self.cells.bind_color(0, unit_of("cells"));
                bind(followed_before, &FOLLOWED);
                bind(decided_before, &DECIDED);
                self.draw(&self.follow, followed);
            }
            2 => {
                bind(followed, &FOLLOWED);
                self.draw(&self.gather, &self.marks);
            }
            3 => {
                bind(&self.marks, &ROW_MARKS);
                self.draw(&self.find_fields, &self.covered);
            }
            4 => {
                bind(&self.covered, &["covered_rows"]);
                self.draw(&self.find_areas, &self.areas);
            }
            5 => {
                bind(&self.areas, &["limited_rows"]);
                self.draw(&self.decide, decided);
            }
            _ => {
                bind(decided, &DECIDED);
                for (round, rate) in CENTRE_RATES.into_iter().enumerate() {
                    self.centre_with(round, [rate, 0.0]);
                }
                self.centre_with(CENTRE_RATES.len(), [0.0, 1.0]);
            }
        }
    }

    /// A round of `flash_centres.frag`, and what it is told.
    fn centre_with(&self, round: usize, told: [f32; 2]) {
        self.place_block.set(&[0.0, 0.0, told[0], told[1]]);
        let [even, odd] = &self.gains;
        let gains = if round.is_multiple_of(2) { even } else { odd };
        self.draw(&self.centre, gains);
        bind(gains, &["corrections"]);
    }

    /// Draws over `target`, which shows the `finished` picture that was taken last, whatever is dimmed in it.
    pub fn limit(&self, finished: &Target, target: &Target) {
        target.bind();
        self.draw_cells(finished, target.size());
    }

    /// The same over the window's framebuffer of `window` pixels.
    pub fn limit_in_window(&self, finished: &Target, window: (u32, u32)) {
        // SAFETY: plain state.
        unsafe {
            self.gl.bind_framebuffer(glow::FRAMEBUFFER, None);
            self.gl.viewport(0, 0, window.0.cast_signed(), window.1.cast_signed());
        }
        self.draw_cells(finished, window);
    }

    /// The cells of the picture that was taken last, and what is done to them, the top row first. Waits for the GPU:
    /// this is for comparing it with [`crate::flash::Limiter`].
    pub fn read(&self) -> (Grid, Vec<Correction>) {
        let colors = self.cells.read_rgba32f(0);
        let corrections = self.corrections().read_rgba32f(0);
        let correction = |[gain, grey, limited, mean]: &[f32; 4]| {
            let level = *limited > 1.5;
            Correction {
                gain: if level { *mean } else { *gain },
                grey: *grey,
                limited: *limited > 0.5,
                level,
            }
        };
        (
            Grid::new(colors.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b])),
            corrections.as_chunks::<4>().0.iter().map(correction).collect(),
        )
    }

    /// What the last round made.
    fn corrections(&self) -> &Target {
        let [even, odd] = &self.gains;
        if CENTRE_RATES.len().is_multiple_of(2) { even } else { odd }
    }

    /// Draws the limited cells into the framebuffer of `size` pixels that is bound.
    fn draw_cells(&self, finished: &Target, size: (u32, u32)) {
        self.reset_state();
        self.place_block.set(&[1.0 / size.0.max(1) as f32, 1.0 / size.1.max(1) as f32, 0.0, 0.0]);
        finished.bind_color(0, unit_of("picture"));
        bind(self.corrections(), &["corrections"]);
        if finished.size() == size { &self.limit } else { &self.limit_enlarged }.bind();
        // SAFETY: a plain draw on objects of ours, in the current context.
        let draw = || unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, (6 * CELLS / GROUP) as i32) };
        self.gl.replacing(draw);
    }

    /// The state in which all its draws begin.
    fn reset_state(&self) {
        // SAFETY: plain state; the vertices are ours.
        unsafe {
            for state in [
                glow::SCISSOR_TEST,
                glow::STENCIL_TEST,
                glow::DEPTH_TEST,
                glow::CULL_FACE,
                glow::BLEND,
                glow::FRAMEBUFFER_SRGB,
            ] {
                self.gl.disable(state);
            }
            self.gl.bind_vertex_array(Some(self.vertices.native()));
        }
    }

    /// Draws all over a target with what is bound.
    fn draw(&self, program: &Program, target: &Target) {
        target.bind();
        program.bind();
        // SAFETY: a plain draw on objects of ours, in the current context.
        let draw = || unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) };
        if target.colors() == 1 { self.gl.replacing(draw) } else { draw() }
    }
}

/// Links one of [`FLASH_SHADERS`].
fn linked(gl: &Gl, library: &ShaderLibrary, shader: &str, defines: &[&str]) -> Result<Program, GpuError> {
    let variant = Variant::of(defines);
    match shader {
        "limit_flashes.frag" => {
            let both = (FLASH_VERTEX_SHADER, shader);
            Program::of(gl, &ProgramTexts::assemble_both(library, both, &variant, gl.info())?)
        }
        _ => Program::link(gl, library, shader, &variant),
    }
}

/// Makes the textures of a target readable under their names.
fn bind(target: &Target, names: &[&str]) {
    for (index, name) in names.iter().enumerate() {
        target.bind_color(index, unit_of(name));
    }
}
