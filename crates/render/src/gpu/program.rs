//! A linked program: a full-screen vertex shader and one fragment shader.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::cell::OnceCell;

use glow::HasContext;
use mariana_field::limits::LIMITS as FIELD_LIMITS;

use super::error::{GpuError, Result};
use super::flash_pass::LIMIT_SHADERS;
use super::gl::{Gl, GlInfo};
use super::object::{ProgramObject, ShaderObject};
use super::program_store::ProgramKey;
use super::samplers::SLOTS;
use super::shader_source::{ShaderLibrary, ShaderSourceError, Variant, driver_preamble, name_places};

/// The uniform blocks of the shaders, with their binding points (see `shaders/README.md`).
pub const UNIFORM_BLOCKS: [(&str, u32); 7] = [
    ("FrameBlock", 0),
    ("PassBlock", 1),
    ("PictureBlock", 2),
    ("PostBlock", 3),
    ("ViewBlock", 4),
    ("FlashBlock", 5),
    ("PlaceBlock", 6),
];

/// The renderer's own textures and their units (see `shaders/README.md`). The scene's textures use the first units, by
/// their number ([`numbered_textures`]). No program reads two textures with the same unit.
pub const TEXTURE_UNITS: [(&str, u32); 38] = [
    ("medium_end", 10),
    ("medium_light", 11),
    ("light_swings", 0),
    ("red_swings", 1),
    ("light_ages", 2),
    ("light_rest", 3),
    ("red_ages", 4),
    ("red_rest", 5),
    ("shown_swings", 6),
    ("shown_ages", 7),
    ("shown_rest", 8),
    ("cells", 9),
    ("marked_rows", 10),
    ("shown_cells", 10),
    ("shown_lows", 11),
    ("own_ceilings", 12),
    ("covered_rows", 12),
    ("crowded_rows", 13),
    ("edge_pixels", 12),
    ("path_state", 12),
    ("path_guides", 13),
    ("path_light", 14),
    ("picture", 12),
    ("ceilings", 13),
    ("extra_samples", 13),
    ("bloom", 13),
    ("before", 14),
    ("mean", 15),
    ("blurred", 13),
    ("last_frame", 13),
    ("warp_grid", 14),
    ("regions", 13),
    ("tape", 14),
    ("edge_squares", 14),
    ("spreads", 14),
    ("shown_red_swings", 14),
    ("shown_red_ages", 15),
    ("sound_tables", 15),
];

const _: () = assert!(FIELD_LIMITS.scene_textures_max <= 12, "the scene's textures have the units 0..12");

pub(super) fn unit_of(texture: &str) -> u32 {
    TEXTURE_UNITS.iter().find(|(name, _)| *name == texture).map_or(0, |(_, unit)| *unit)
}

pub(super) fn binding_of(block: &str) -> u32 {
    UNIFORM_BLOCKS.iter().find(|(name, _)| *name == block).map_or(0, |(_, binding)| *binding)
}

/// The textures whose unit is the number in their name: the scene's textures, and the slots of `samplers.frag`.
pub fn numbered_textures() -> impl Iterator<Item = (String, u32)> {
    let of_scene =
        (0..FIELD_LIMITS.scene_textures_max as u32).map(|unit| (format!("scene_texture_{unit}"), unit));
    of_scene.chain((0..SLOTS).map(|unit| (format!("slot_{unit}"), unit)))
}

/// The vertex shader of all passes except the one that dims cells.
pub const VERTEX_SHADER: &str = "fullscreen.vert";

/// The texts of a program's two shaders.
#[derive(Debug, Clone)]
pub struct ProgramTexts {
    vertex: (String, String),
    fragment: (String, String),
}

impl ProgramTexts {
    /// Length of both texts in bytes.
    #[expect(clippy::len_without_is_empty, reason = "a program always has texts")]
    pub fn len(&self) -> usize {
        self.vertex.1.len() + self.fragment.1.len()
    }

    /// Assembles a variant of `fragment` of `library` for a driver.
    ///
    /// # Errors
    /// Fails if shader files are missing.
    pub fn assemble(
        library: &ShaderLibrary,
        fragment: &str,
        variant: &Variant,
        info: &GlInfo,
    ) -> Result<Self, ShaderSourceError> {
        let preamble = driver_preamble(info);
        let assembled = |name: &str| Ok((name.to_owned(), library.assemble(name, &preamble, variant)?));
        let vertex = if fragment == LIMIT_SHADERS.0 { LIMIT_SHADERS.1 } else { VERTEX_SHADER };
        Ok(Self { fragment: assembled(fragment)?, vertex: assembled(vertex)? })
    }

    /// The key of the texts alone, for any driver.
    pub fn text_key(&self) -> ProgramKey {
        ProgramKey::of([self.vertex.1.as_str(), &self.fragment.1])
    }

    /// The key for storing the driver's binary. It depends on the driver, the driver's version, and the texts.
    pub fn key(&self, info: &GlInfo) -> ProgramKey {
        let GlInfo { vendor, renderer, version, shading_language, .. } = info;
        ProgramKey::of(
            [vendor, renderer, version, shading_language, &self.vertex.1, &self.fragment.1].map(|s| &**s),
        )
    }
}

/// A program in the driver's binary form.
pub struct ProgramBinary(glow::ProgramBinary);

impl ProgramBinary {
    /// Serializes the binary: the number of its format, then its content.
    pub fn to_bytes(&self) -> Vec<u8> {
        [&self.0.format.to_le_bytes()[..], &self.0.buffer].concat()
    }

    /// Reads the result of [`ProgramBinary::to_bytes`]; `None` if the binary is empty.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (format, buffer) = bytes.split_first_chunk()?;
        let format = u32::from_le_bytes(*format);
        (!buffer.is_empty()).then(|| Self(glow::ProgramBinary { buffer: buffer.to_owned(), format }))
    }
}

/// A program that is passed between contexts as plain values, without objects of either context.
///
/// Sharing program objects between contexts crashes some drivers. Mesa's software renderers compile a program once per
/// context. When one context deletes a shared program, the other contexts keep their compiled forms. When Mesa up to
/// 22.3 frees these forms (`free_zombie_shaders`), it unbinds the programs that those contexts are drawing with, and
/// the next draw reads a null pointer.
pub struct ReadyProgram {
    texts: ProgramTexts,
    /// The driver's binary, if the driver provides one. Loading it takes milliseconds.
    binary: Option<ProgramBinary>,
}

impl ReadyProgram {
    #[cfg(not(target_family = "wasm"))]
    pub(super) fn new(texts: ProgramTexts, binary: Option<ProgramBinary>) -> Self {
        Self { texts, binary }
    }

    /// The driver's binary, if the driver provides one.
    pub fn binary(&self) -> Option<&ProgramBinary> {
        self.binary.as_ref()
    }
}

/// A linked program whose blocks and textures are bound to their fixed binding points and units.
pub struct Program {
    gl: Gl,
    object: ProgramObject,
    /// True if the program interprets the tapes of materials and light.
    pub(super) reads_tapes: bool,
}

impl Program {
    /// Assembles, compiles and links a variant of `fragment` of `library`.
    ///
    /// # Errors
    /// Fails if shader files are missing, or with the driver's log if the driver rejects them.
    pub fn link(gl: &Gl, library: &ShaderLibrary, fragment: &str, variant: &Variant) -> Result<Self> {
        Self::of(gl, &ProgramTexts::assemble(library, fragment, variant, gl.info())?)
    }

    /// Compiles and links two texts.
    ///
    /// # Errors
    /// Fails with the driver's log if the driver rejects the texts.
    pub fn of(gl: &Gl, texts: &ProgramTexts) -> Result<Self> {
        PendingProgram::of(gl, texts)?.finish()
    }

    fn with_places(gl: &Gl, object: ProgramObject) -> Self {
        let program = object.native();
        let mut reads_tapes = false;
        // SAFETY: the program is linked and belongs to `object`, whose context is current.
        unsafe {
            for (block, binding) in UNIFORM_BLOCKS {
                if let Some(index) = gl.get_uniform_block_index(program, block) {
                    gl.uniform_block_binding(program, index, binding);
                }
            }
            gl.use_program(Some(program));
            let own = TEXTURE_UNITS.iter().map(|(name, unit)| ((*name).to_owned(), *unit));
            for (texture, unit) in own.chain(numbered_textures()) {
                if let Some(location) = gl.get_uniform_location(program, &texture) {
                    gl.uniform_1_i32(Some(&location), unit.cast_signed());
                    reads_tapes |= texture == "tape";
                }
            }
        }
        Self { gl: gl.clone(), object, reads_tapes }
    }

    /// Converts the program to values for another context of the same driver. `texts` are its sources.
    pub fn ready(&self, texts: ProgramTexts) -> ReadyProgram {
        let binary = if self.gl.info().program_binaries {
            // SAFETY: `self` owns the linked program, and the driver supports program binaries, as checked above.
            unsafe { self.gl.get_program_binary(self.object.native()) }
        } else {
            None
        };
        ReadyProgram { texts, binary: binary.filter(|binary| !binary.buffer.is_empty()).map(ProgramBinary) }
    }

    /// Recreates another context's program from the driver's binary, or from the texts if the binary does not load.
    ///
    /// # Errors
    /// Fails with the driver's log if the driver rejects the texts.
    pub fn adopt(gl: &Gl, ready: &ReadyProgram) -> Result<Self> {
        let known = ready.binary.as_ref().map(|binary| Self::load(gl, binary)).transpose()?.flatten();
        known.map_or_else(|| Self::of(gl, &ready.texts), Ok)
    }

    /// Loads a program from the driver's binary; `None` if the driver rejects it.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create another object.
    pub fn load(gl: &Gl, binary: &ProgramBinary) -> Result<Option<Self>> {
        if !gl.info().program_binaries {
            return Ok(None);
        }
        let object = ProgramObject::new(gl)?;
        // SAFETY: the program was just created in the current context. An invalid binary leaves it unlinked.
        let linked = unsafe {
            gl.program_binary(object.native(), &binary.0);
            gl.get_program_link_status(object.native())
        };
        if linked {
            return Ok(Some(Self::with_places(gl, object)));
        }
        // Clear the driver's error about the binary.
        let _ = gl.check("loading a program binary");
        Ok(None)
    }

    pub(super) fn native(&self) -> glow::Program {
        self.object.native()
    }

    /// Unbinds the current program, so that the context does not keep a deleted program.
    pub fn unbind(&self) {
        // SAFETY: sets state of the current context.
        unsafe { self.gl.use_program(None) }
    }

    /// Uses this program for the following draws.
    pub fn bind(&self) {
        // SAFETY: `self` owns the linked program, which belongs to the current context.
        unsafe { self.gl.use_program(Some(self.object.native())) }
    }
}

/// A program that is linked at its first use, so that startup does not wait for unused programs.
pub(super) struct LazyProgram {
    texts: ProgramTexts,
    linked: OnceCell<Program>,
}

impl LazyProgram {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary, fragment: &str, variant: &Variant) -> Result<Self> {
        let texts = ProgramTexts::assemble(library, fragment, variant, gl.info())?;
        Ok(Self { texts, linked: OnceCell::new() })
    }

    pub(super) fn bind(&self, gl: &Gl) -> Result<()> {
        if self.linked.get().is_none() {
            let _ = self.linked.set(Program::of(gl, &self.texts)?);
        }
        self.linked.get().iter().for_each(|program| program.bind());
        Ok(())
    }
}

/// A program that the driver may still be compiling.
pub struct PendingProgram {
    gl: Gl,
    object: ProgramObject,
    shaders: Vec<ShaderObject>,
    texts: ProgramTexts,
}

impl PendingProgram {
    /// Begins to compile and link two texts.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create more objects.
    pub fn of(gl: &Gl, texts: &ProgramTexts) -> Result<Self> {
        let object = ProgramObject::new(gl)?;
        let mut shaders = Vec::new();
        for (stage, (_, text)) in
            [(glow::VERTEX_SHADER, &texts.vertex), (glow::FRAGMENT_SHADER, &texts.fragment)]
        {
            let shader = ShaderObject::new(gl, stage)?;
            // SAFETY: all names belong to the current context.
            unsafe {
                gl.shader_source(shader.native(), text);
                gl.compile_shader(shader.native());
                gl.attach_shader(object.native(), shader.native());
            }
            shaders.push(shader);
        }
        // SAFETY: the program and its shaders belong to the current context. Shaders with mistakes leave it unlinked.
        unsafe {
            if gl.info().program_binaries {
                gl.program_binary_retrievable_hint(object.native(), true);
            }
            gl.link_program(object.native());
        }
        Ok(Self { gl: gl.clone(), object, shaders, texts: texts.clone() })
    }

    /// True if [`Self::finish`] need not wait. Drivers that cannot tell make it wait.
    pub fn is_finished(&self) -> bool {
        if !self.gl.info().tells_completion {
            return true;
        }
        // SAFETY: the program belongs to the current context, whose driver has the extension.
        unsafe { self.gl.get_program_completion_status(self.object.native()) }
    }

    /// Waits for the driver, and returns the program.
    ///
    /// # Errors
    /// Fails with the driver's log if the driver rejects the texts.
    pub fn finish(self) -> Result<Program> {
        let (gl, program) = (&self.gl, self.object.native());
        // SAFETY: the program and its shaders belong to the current context.
        unsafe {
            if gl.get_program_link_status(program) {
                return Ok(Program::with_places(gl, self.object));
            }
            let ProgramTexts { vertex, fragment } = &self.texts;
            for (shader, (name, text)) in self.shaders.iter().zip([vertex, fragment]) {
                if !gl.get_shader_compile_status(shader.native()) {
                    let log = name_places(&gl.get_shader_info_log(shader.native()), text);
                    return Err(GpuError::Compile { name: name.clone(), log });
                }
            }
            let log = gl.get_program_info_log(program);
            Err(GpuError::Compile { name: format!("the program of {}", fragment.0), log })
        }
    }
}
