//! Limits the flashes of finished images on the GPU: measures an image's cells, decides which cells to dim, and dims
//! these cells.
//!
//! All results stay on the GPU, so frames do not wait, and the frame with the fourth flash is itself dimmed. Textures
//! with one texel per cell hold the state of the cells, and two passes rewrite these textures for each frame. Decisions
//! that depend on many cells use rows of bits, one bit per cell. The steps of a frame:
//!
//! 1. `cells.frag` takes the mean colours of the cells.
//! 2. `flash_follow.frag` finds changes, and marks the cells that change too often.
//! 3. `flash_rows.frag`, `flash_fields.frag` and `flash_areas.frag` find the cells to limit.
//! 4. `flash_decide.frag` sets the ceilings of cells, and `flash_spread.frag` spreads them to neighbouring cells.
//! 5. `cells.frag` takes the mean colours again, below the ceilings, and `flash_note.frag` records their changes.
//! 6. `limit_flashes.frag` draws over the displayed image, only near limited cells. Other pixels do not change, and an
//!    image without limited cells skips this pass.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::slice::from_ref;

use glow::HasContext;

use super::error::{GpuError, Result};
use super::gl::Gl;
use super::passes::{Block, Passes};
use super::program::{Program, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use crate::flash::{CELLS, COLUMNS, ROWS, Steps};

/// The shader that dims cells, and the vertex shader that places these cells.
pub const LIMIT_SHADERS: (&str, &str) = ("limit_flashes.frag", "flash_cells.vert");
/// The fragment shaders of the limiter and their defines, in the order of the passes.
pub const FLASH_SHADERS: [(&str, &[&str]); 13] = [
    ("cells.frag", &[]),
    ("flash_follow.frag", &[]),
    ("flash_follow.frag", &[SECOND_HALF]),
    ("flash_rows.frag", &[]),
    ("flash_fields.frag", &[]),
    ("flash_areas.frag", &[]),
    ("flash_decide.frag", &[]),
    ("flash_spread.frag", &[]),
    ("cells.frag", &["SHOWN"]),
    ("flash_note.frag", &[]),
    ("flash_note.frag", &[SECOND_HALF]),
    (LIMIT_SHADERS.0, &[]),
    (LIMIT_SHADERS.0, &["ENLARGED"]),
];

/// The define of the programs that write the second half of the outputs.
const SECOND_HALF: &str = "SECOND_HALF";
/// Number of outputs of each half: OpenGL ES 3.0 guarantees four.
const HALF: usize = 3;

/// The outputs of `flash_follow.frag`, in order.
const FOLLOWED: [&str; 6] =
    ["light_swings", "red_swings", "light_ages", "light_rest", "red_ages", "red_rest"];
/// The outputs of `flash_note.frag`, in order.
const NOTED: [&str; 6] =
    ["shown_swings", "shown_ages", "shown_rest", "shown_lows", "shown_red_swings", "shown_red_ages"];
/// Number of passes per frame.
pub const PASSES: usize = 10;
/// The place in [`FLASH_SHADERS`] of each pass's program. A pass with two outputs draws the second one with the next
/// program.
const PROGRAMS: [usize; PASSES] = [0, 1, 3, 4, 5, 6, 7, 7, 8, 9];
/// The place in [`FLASH_SHADERS`] of the program that dims cells. The next one dims the cells of an enlarged image.
const LIMIT: usize = 11;
/// Number of cells in each rectangle that `flash_cells.vert` draws.
const GROUP: usize = 16;

/// The flash limiter and its GPU objects.
pub struct FlashPass {
    /// The programs of [`FLASH_SHADERS`].
    programs: Vec<Program>,
    memory: FlashMemory,
    passes: Passes,
    step_block: Block,
    steps: Steps,
    /// True before the first frame and after [`FlashPass::forget`].
    is_fresh: bool,
}

/// The first and the second half of the outputs of `flash_follow.frag` or `flash_note.frag`.
type Halves = [Target; 2];

struct FlashMemory {
    measured: Target,
    /// States of this frame and of the previous frame.
    followed: [Halves; 2],
    noted: [Halves; 2],
    marks: Target,
    covered: Target,
    areas: Target,
    /// Ceilings in three stages: each cell's own, spread along rows, and spread along both axes.
    ceilings: [Target; 3],
    shown: Target,
}

impl FlashPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// Fails with the driver's log if the driver rejects a shader.
    pub fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        let link = |(shader, defines)| Program::link(gl, library, shader, &Variant::of(defines));
        let pass = Self {
            programs: FLASH_SHADERS.into_iter().map(link).collect::<Result<_>>()?,
            memory: FlashMemory::new(gl)?,
            passes: Passes::new(gl)?,
            step_block: Block::new(gl, "FlashBlock")?,
            steps: Steps::default(),
            is_fresh: true,
        };
        gl.check("setting up the flash limiter")?;
        Ok(pass)
    }

    /// Forgets all earlier frames, because the user switches to another kind of image.
    pub fn forget(&mut self) {
        self.is_fresh = true;
        self.steps = Steps::default();
    }

    /// Draws once with each program, until `is_wanted` returns false, so that the driver compiles them completely in
    /// advance. The window does not change, and the limiter forgets these draws.
    pub fn warm_up(&mut self, picture: &Target, is_wanted: &mut dyn FnMut() -> bool) {
        self.begin(0.0);
        let passes = (0..PASSES).take_while(|_| is_wanted());
        passes.for_each(|number| {
            self.passes.prepare();
            self.pass(number, picture);
        });
        // The first frame is never dimmed, so this draw does not change the window.
        let (width, height) = picture.size();
        let windows = [(width, height), (width + 1, height)].into_iter().take_while(|_| is_wanted());
        windows.for_each(|window| self.limit_in_window(picture, window));
        self.forget();
    }

    /// Measures an image shown `seconds` after the previous image, and decides which cells to dim. The first image is
    /// never dimmed.
    pub fn measure(&mut self, finished: &Target, seconds: f64) {
        self.begin(seconds);
        (0..PASSES).for_each(|number| self.pass(number, finished));
    }

    fn begin(&mut self, seconds: f64) {
        let step = self.steps.next(seconds);
        let flag = |is: bool| f32::from(u8::from(is));
        let is_fresh = std::mem::take(&mut self.is_fresh);
        self.step_block.set(&[step.seconds as f32, flag(step.forgets), flag(is_fresh), 0.0]);
        self.memory.followed.swap(0, 1);
        self.memory.noted.swap(0, 1);
        self.passes.prepare();
    }

    /// Draws one of the [`PASSES`]. Draw them in order: each uses bindings and results of the previous passes.
    fn pass(&self, number: usize, finished: &Target) {
        let memory = &self.memory;
        let [followed, followed_before] = &memory.followed;
        let [noted, noted_before] = &memory.noted;
        let [own, along_rows, spread] = &memory.ceilings;
        let outputs: &[Target] = match number {
            0 => read(finished, "picture", &memory.measured),
            1 => {
                bind(&memory.measured, &["cells"]);
                bind_halves(followed_before, &FOLLOWED);
                bind_halves(noted_before, &NOTED);
                followed
            }
            2 => {
                bind_halves(followed, &FOLLOWED);
                from_ref(&memory.marks)
            }
            3 => read(&memory.marks, "marked_rows", &memory.covered),
            4 => read(&memory.covered, "covered_rows", &memory.areas),
            5 => read(&memory.areas, "crowded_rows", own),
            6 => self.spread_along([1.0, 0.0], own, along_rows),
            7 => self.spread_along([0.0, 1.0], along_rows, spread),
            8 => {
                bind(spread, &["ceilings"]);
                read(finished, "picture", &memory.shown)
            }
            _ => {
                bind(&memory.shown, &["shown_cells"]);
                bind(own, &["own_ceilings"]);
                // Its unit has held the ceilings in between.
                bind(&memory.areas, &["crowded_rows"]);
                noted
            }
        };
        let programs = self.programs.iter().skip(PROGRAMS[number]);
        programs.zip(outputs).for_each(|(program, output)| self.draw(program, output));
    }

    fn spread_along<'a>(&self, axis: [f32; 2], ceilings: &Target, output: &'a Target) -> &'a [Target] {
        self.passes.post.set(&[0.0, 0.0, axis[0], axis[1]]);
        read(ceilings, "ceilings", output)
    }

    /// Dims cells in `target`, which shows the last `finished` image that was measured.
    pub fn limit(&self, finished: &Target, target: &Target) {
        target.bind();
        self.dim_cells(finished, target.size());
    }

    /// Dims cells in the window's framebuffer, which has `window` pixels.
    pub fn limit_in_window(&self, finished: &Target, window: (u32, u32)) {
        self.passes.gl.bind_output(self.passes.gl.window(), window);
        self.dim_cells(finished, window);
    }

    /// Reads the cells of the last image, top row first: measured colours, corrections (grey in the third component, the
    /// ceiling in the fourth), and displayed colours. Waits for the GPU. Tests compare them.
    pub fn read(&self) -> [Vec<[f32; 4]>; 3] {
        let FlashMemory { measured, shown, .. } = &self.memory;
        [measured, self.memory.spread_ceilings(), shown]
            .map(|cells| cells.read_rgba32f(0).as_chunks().0.to_vec())
    }

    fn dim_cells(&self, finished: &Target, size: (u32, u32)) {
        finished.bind_color(0, unit_of("picture"));
        bind(self.memory.spread_ceilings(), &["ceilings"]);
        let is_enlarged = finished.size() != size;
        self.draw_cells(&self.programs[LIMIT + usize::from(is_enlarged)], size);
    }

    fn draw(&self, program: &Program, target: &Target) {
        target.bind();
        program.bind();
        // SAFETY: draws without attributes into the target bound above, with objects of the current context.
        let draw = || unsafe { self.passes.gl.draw_arrays(glow::TRIANGLES, 0, 3) };
        if target.colors() == 1 { self.passes.gl.replacing(draw) } else { draw() }
    }

    fn draw_cells(&self, program: &Program, size: (u32, u32)) {
        self.passes.prepare();
        self.passes.post.set(&[1.0 / size.0.max(1) as f32, 1.0 / size.1.max(1) as f32, 0.0, 0.0]);
        program.bind();
        // SAFETY: draws without attributes into the bound framebuffer, with objects of the current context.
        let draw = || unsafe { self.passes.gl.draw_arrays(glow::TRIANGLES, 0, (6 * CELLS / GROUP) as i32) };
        self.passes.gl.replacing(draw);
    }
}

impl FlashMemory {
    fn new(gl: &Gl) -> Result<Self> {
        let of = |size, count| Target::new(gl, size, &vec![Texel::Rgba32F; count], None);
        let of_cells = |count: usize| of((COLUMNS as u32, ROWS as u32), count);
        let halves = || Ok::<_, GpuError>([of_cells(HALF)?, of_cells(HALF)?]);
        let of_rows = || of((1, ROWS as u32), 1);
        Ok(Self {
            measured: of_cells(1)?,
            followed: [halves()?, halves()?],
            noted: [halves()?, halves()?],
            marks: of_rows()?,
            covered: of_rows()?,
            areas: of_rows()?,
            ceilings: [of_cells(1)?, of_cells(1)?, of_cells(1)?],
            shown: of_cells(1)?,
        })
    }

    fn spread_ceilings(&self) -> &Target {
        let [.., spread] = &self.ceilings;
        spread
    }
}

/// Binds the only texture that a pass reads, as `name`, and returns the pass's outputs.
fn read<'a>(input: &Target, name: &str, output: &'a Target) -> &'a [Target] {
    bind(input, &[name]);
    from_ref(output)
}

fn bind_halves(halves: &Halves, names: &[&str; 2 * HALF]) {
    halves.iter().zip(names.chunks(HALF)).for_each(|(half, names)| bind(half, names));
}

fn bind(target: &Target, names: &[&str]) {
    for (index, name) in names.iter().enumerate() {
        target.bind_color(index, unit_of(name));
    }
}
