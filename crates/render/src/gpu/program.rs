//! A linked program: a full-screen vertex shader and one fragment shader.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::cell::OnceCell;

use glow::HasContext;
use mariana_field::limits::LIMITS as FIELD_LIMITS;

use super::error::GpuError;
use super::gl::{Gl, GlInfo};
use super::object::ProgramObject;
use super::program_store::ProgramKey;
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

/// The renderer's own textures, with their units (see `shaders/README.md`). The scene's have the first ones, by their
/// number ([`scene_texture`]). Textures that share a unit are never read by one program.
pub const TEXTURE_UNITS: [(&str, u32); 46] = [
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
    ("limited_rows", 13),
    ("edge_pixels", 12),
    ("picture", 12),
    ("ceilings", 13),
    ("extra_samples", 13),
    ("bloom", 13),
    ("before", 14),
    ("blurred", 13),
    ("regions", 13),
    ("tape", 14),
    ("edge_squares", 14),
    ("spreads", 14),
    ("shown_red_swings", 14),
    ("shown_red_ages", 15),
    ("sound_tables", 15),
    ("slot_0", 0),
    ("slot_1", 1),
    ("slot_2", 2),
    ("slot_3", 3),
    ("slot_4", 4),
    ("slot_5", 5),
    ("slot_6", 6),
    ("slot_7", 7),
    ("slot_8", 8),
    ("slot_9", 9),
    ("slot_10", 10),
    ("slot_11", 11),
    ("slot_12", 12),
    ("slot_13", 13),
    ("slot_14", 14),
    ("slot_15", 15),
];

const _: () = assert!(FIELD_LIMITS.scene_textures_max <= 12, "the scene's textures have the units 0..12");

/// The unit of one of [`TEXTURE_UNITS`]; 0 for any other name.
pub(super) fn unit_of(texture: &str) -> u32 {
    TEXTURE_UNITS.iter().find(|(name, _)| *name == texture).map_or(0, |(_, unit)| *unit)
}

/// The binding point of one of [`UNIFORM_BLOCKS`]; 0 for any other name.
pub(super) fn binding_of(block: &str) -> u32 {
    UNIFORM_BLOCKS.iter().find(|(name, _)| *name == block).map_or(0, |(_, binding)| *binding)
}

/// The name of a scene's texture in the shaders; its unit is its number.
pub fn scene_texture(index: usize) -> String {
    format!("scene_texture_{index}")
}

/// The vertex shader that all passes share.
pub const VERTEX_SHADER: &str = "fullscreen.vert";

/// The texts of a program's two shaders.
#[derive(Debug, Clone)]
pub struct ProgramTexts {
    /// The vertex shader's name, and its text.
    vertex: (&'static str, String),
    /// The fragment shader's name, and its text.
    fragment: (String, String),
}

impl ProgramTexts {
    /// How many bytes they have.
    #[expect(clippy::len_without_is_empty, reason = "a program without a text is none")]
    pub fn len(&self) -> usize {
        self.vertex.1.len() + self.fragment.1.len()
    }

    /// Assembles a variant of `fragment` of `library` for a driver.
    ///
    /// # Errors
    /// Missing shader files.
    pub fn assemble(
        library: &ShaderLibrary,
        fragment: &str,
        variant: &Variant,
        info: &GlInfo,
    ) -> Result<Self, ShaderSourceError> {
        Self::assemble_both(library, (VERTEX_SHADER, fragment), variant, info)
    }

    /// The same with another vertex shader.
    pub(super) fn assemble_both(
        library: &ShaderLibrary,
        (vertex, fragment): (&'static str, &str),
        variant: &Variant,
        info: &GlInfo,
    ) -> Result<Self, ShaderSourceError> {
        let assembled = |name| library.assemble(name, driver_preamble(info), variant);
        let fragment = (fragment.to_owned(), assembled(fragment)?);
        Ok(Self { vertex: (vertex, assembled(vertex)?), fragment })
    }

    /// By what a driver's own form of the program is kept: another driver, another version of it or another letter
    /// gives another key.
    pub fn key(&self, info: &GlInfo) -> ProgramKey {
        let GlInfo { vendor, renderer, version, shading_language, .. } = info;
        ProgramKey::of(
            [vendor, renderer, version, shading_language, &self.vertex.1, &self.fragment.1].map(|s| &**s),
        )
    }
}

/// A program in a driver's own form.
pub struct ProgramBinary(glow::ProgramBinary);

impl ProgramBinary {
    /// As bytes, to be kept: the number of the format, then what the driver gave.
    pub fn to_bytes(&self) -> Vec<u8> {
        [&self.0.format.to_le_bytes()[..], &self.0.buffer].concat()
    }

    /// What [`ProgramBinary::to_bytes`] gave; none if there is nothing in it.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (format, buffer) = bytes.split_first_chunk()?;
        let format = u32::from_le_bytes(*format);
        (!buffer.is_empty()).then(|| Self(glow::ProgramBinary { buffer: buffer.to_owned(), format }))
    }
}

/// A program on its way from one context to another: values only, no object of either context.
///
/// Sharing programs between contexts is a trap. If a driver compiles a program once for each context (Mesa's software
/// renderers do), a program that one context deletes leaves its compiled forms to the others. When Mesa up to 22.3
/// frees those (`free_zombie_shaders`), it unbinds whatever the other contexts are drawing with, and their next draw
/// reads a null pointer.
pub struct ReadyProgram {
    texts: ProgramTexts,
    /// The driver's own form of it, if it provides one: linking it again then takes milliseconds.
    binary: Option<ProgramBinary>,
}

impl ReadyProgram {
    /// A program that was made from these texts, in the driver's own form if there is one.
    pub(super) fn new(texts: ProgramTexts, binary: Option<ProgramBinary>) -> Self {
        Self { texts, binary }
    }

    /// The driver's own form, if it provides one.
    pub fn binary(&self) -> Option<&ProgramBinary> {
        self.binary.as_ref()
    }
}

impl From<ProgramTexts> for ReadyProgram {
    fn from(texts: ProgramTexts) -> Self {
        Self { texts, binary: None }
    }
}

/// A linked program, with its blocks and textures bound to their fixed places.
pub struct Program {
    gl: Gl,
    object: ProgramObject,
}

impl Program {
    /// Assembles, compiles and links a variant of `fragment` of `library`.
    ///
    /// # Errors
    /// Missing shader files, and what the driver says about malformed ones.
    pub fn link(
        gl: &Gl,
        library: &ShaderLibrary,
        fragment: &str,
        variant: &Variant,
    ) -> Result<Self, GpuError> {
        Self::of(gl, &ProgramTexts::assemble(library, fragment, variant, gl.info())?)
    }

    /// Compiles and links two texts.
    ///
    /// # Errors
    /// What the driver says about malformed ones.
    pub fn of(gl: &Gl, texts: &ProgramTexts) -> Result<Self, GpuError> {
        let (vertex, fragment) = (&texts.vertex, &texts.fragment);
        let object = link_texts(gl, (vertex.0, &vertex.1), (&fragment.0, &fragment.1))?;
        Ok(Self::with_places(gl, object))
    }

    /// Binds the blocks and textures of a linked program to their places.
    fn with_places(gl: &Gl, object: ProgramObject) -> Self {
        let program = object.native();
        // SAFETY: the program is linked and ours.
        unsafe {
            for (block, binding) in UNIFORM_BLOCKS {
                if let Some(index) = gl.get_uniform_block_index(program, block) {
                    gl.uniform_block_binding(program, index, binding);
                }
            }
            gl.use_program(Some(program));
            let own = TEXTURE_UNITS.iter().map(|(name, unit)| ((*name).to_owned(), *unit));
            let of_scenes = (0..FIELD_LIMITS.scene_textures_max).map(scene_texture).zip(0..);
            for (texture, unit) in own.chain(of_scenes) {
                if let Some(location) = gl.get_uniform_location(program, &texture) {
                    gl.uniform_1_i32(Some(&location), unit.cast_signed());
                }
            }
        }
        Self { gl: gl.clone(), object }
    }

    /// What another context of the same driver needs to make the program too; `texts` are what it was made from.
    pub fn ready(&self, texts: ProgramTexts) -> ReadyProgram {
        let binary = if self.gl.info().program_binaries {
            // SAFETY: the program is linked and ours, and the functions are there where the driver has binaries.
            unsafe { self.gl.get_program_binary(self.object.native()) }
        } else {
            None
        };
        ReadyProgram { texts, binary: binary.filter(|binary| !binary.buffer.is_empty()).map(ProgramBinary) }
    }

    /// Makes a program that another context has made before: from the driver's own form or, if there is none or the
    /// driver no longer accepts it, from the texts.
    ///
    /// # Errors
    /// What the driver says about the texts.
    pub fn adopt(gl: &Gl, ready: &ReadyProgram) -> Result<Self, GpuError> {
        let known = match &ready.binary {
            Some(binary) => Self::take(gl, binary)?,
            None => None,
        };
        known.map_or_else(|| Self::of(gl, &ready.texts), Ok)
    }

    /// Makes a program from the driver's own form; none if the driver does not accept it.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no object left.
    pub fn take(gl: &Gl, binary: &ProgramBinary) -> Result<Option<Self>, GpuError> {
        if !gl.info().program_binaries {
            return Ok(None);
        }
        let object = ProgramObject::new(gl)?;
        // SAFETY: the program is ours; a binary that is no longer valid leaves it unlinked.
        let linked = unsafe {
            gl.program_binary(object.native(), &binary.0);
            gl.get_program_link_status(object.native())
        };
        if linked {
            return Ok(Some(Self::with_places(gl, object)));
        }
        // An error that the driver noted about the binary is answered here.
        let _ = gl.check("taking a program");
        Ok(None)
    }

    /// The driver's number of it.
    pub(super) fn number(&self) -> u32 {
        self.object.native().0.get()
    }

    /// Leaves the context without a program, so that it keeps none that is deleted.
    pub fn unbind(&self) {
        // SAFETY: plain state.
        unsafe { self.gl.use_program(None) }
    }

    /// Makes this the program of the following draws.
    pub fn bind(&self) {
        // SAFETY: the program is linked and ours.
        unsafe { self.gl.use_program(Some(self.object.native())) }
    }
}

/// A program that is linked when it is first drawn with, so that a start does not wait for those that nobody needs.
pub(super) struct LazyProgram {
    texts: ProgramTexts,
    linked: OnceCell<Program>,
}

impl LazyProgram {
    /// Assembles a variant of `fragment` of `library`.
    ///
    /// # Errors
    /// Missing shader files.
    pub(super) fn new(
        gl: &Gl,
        library: &ShaderLibrary,
        fragment: &str,
        variant: &Variant,
    ) -> Result<Self, GpuError> {
        let texts = ProgramTexts::assemble(library, fragment, variant, gl.info())?;
        Ok(Self { texts, linked: OnceCell::new() })
    }

    /// Makes it the program of the following draws.
    ///
    /// # Errors
    /// What the driver says about a malformed one.
    pub(super) fn bind(&self, gl: &Gl) -> Result<(), GpuError> {
        if self.linked.get().is_none() {
            let _ = self.linked.set(Program::of(gl, &self.texts)?);
        }
        self.linked.get().iter().for_each(|program| program.bind());
        Ok(())
    }
}

/// Compiles and links the texts of a vertex and a fragment shader, each with its name. The driver's messages name the
/// places in the files that [`super::shader_source`] marked.
///
/// # Errors
/// What the driver says.
pub(super) fn link_texts(
    gl: &Gl,
    vertex: (&str, &str),
    fragment: (&str, &str),
) -> Result<ProgramObject, GpuError> {
    let object = ProgramObject::new(gl)?;
    let program = object.native();
    // SAFETY: names are made and used in the current context; shaders are freed on every path.
    unsafe {
        for (stage, (name, text)) in [(glow::VERTEX_SHADER, vertex), (glow::FRAGMENT_SHADER, fragment)] {
            let shader =
                gl.create_shader(stage).map_err(|reason| GpuError::Object { what: "a shader", reason })?;
            gl.shader_source(shader, text);
            gl.compile_shader(shader);
            let compiled = gl.get_shader_compile_status(shader);
            let log =
                if compiled { String::new() } else { name_places(&gl.get_shader_info_log(shader), text) };
            if compiled {
                gl.attach_shader(program, shader);
            }
            // A shader that is attached lives until its program is deleted.
            gl.delete_shader(shader);
            if !compiled {
                return Err(GpuError::Compile { name: name.into(), log });
            }
        }
        if gl.info().program_binaries {
            gl.program_binary_retrievable_hint(program, true);
        }
        gl.link_program(program);
        if !gl.get_program_link_status(program) {
            let log = gl.get_program_info_log(program);
            return Err(GpuError::Compile { name: format!("the program of {}", fragment.0), log });
        }
    }
    Ok(object)
}
