//! A linked program: a full-screen vertex shader and one fragment shader.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::ProgramObject;
use super::shader_source::{DRIVER_PREAMBLE, ShaderLibrary, Variant, name_places};
use crate::limits::LIMITS;

/// The uniform blocks of the shaders, with their binding points (see `shaders/README.md`).
pub const UNIFORM_BLOCKS: [(&str, u32); 5] =
    [("FrameBlock", 0), ("PassBlock", 1), ("PictureBlock", 2), ("PostBlock", 3), ("ViewBlock", 4)];

/// The renderer's own textures, with their units (see `shaders/README.md`). The scene's come before them, by their
/// number ([`scene_texture`]). What shares a unit is never read by one program.
pub const TEXTURE_UNITS: [(&str, u32); 11] = [
    ("edge_pixels", 12),
    ("picture", 12),
    ("corrections", 13),
    ("extra_samples", 13),
    ("bloom", 13),
    ("blurred", 13),
    ("regions", 13),
    ("tape", 14),
    ("edge_squares", 14),
    ("spreads", 14),
    ("sound_tables", 15),
];

const _: () = assert!(LIMITS.scene_textures_max <= 12, "the scene's textures have the units 0..12");

/// The unit of one of [`TEXTURE_UNITS`]; 0 for a name that is none of them.
pub(super) fn unit_of(texture: &str) -> u32 {
    TEXTURE_UNITS.iter().find(|(name, _)| *name == texture).map_or(0, |(_, unit)| *unit)
}

/// The binding point of one of [`UNIFORM_BLOCKS`]; 0 for a name that is none of them.
pub(super) fn binding_of(block: &str) -> u32 {
    UNIFORM_BLOCKS.iter().find(|(name, _)| *name == block).map_or(0, |(_, binding)| *binding)
}

/// The name of a texture of the scene in the shaders; its unit is its number.
pub fn scene_texture(index: usize) -> String {
    format!("scene_texture_{index}")
}

/// The vertex shader that all passes share.
pub const VERTEX_SHADER: &str = "fullscreen.vert";

/// A program on its way from one context to another. One that is never adopted lives as long as the contexts.
#[derive(Debug)]
pub struct ReadyProgram(glow::NativeProgram);

/// A linked program, its blocks and textures bound to their fixed places.
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
        let assembled = |name| library.assemble(name, DRIVER_PREAMBLE, variant);
        let (vertex, text) = (assembled(VERTEX_SHADER)?, assembled(fragment)?);
        let object = link_texts(gl, (VERTEX_SHADER, &vertex), (fragment, &text))?;
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
            let of_scenes = (0..LIMITS.scene_textures_max).map(scene_texture).zip(0..);
            for (texture, unit) in own.chain(of_scenes) {
                if let Some(location) = gl.get_uniform_location(program, &texture) {
                    gl.uniform_1_i32(Some(&location), unit.cast_signed());
                }
            }
        }
        Ok(Self { gl: gl.clone(), object })
    }

    /// Leaves the program to another context that shares objects with this one.
    pub fn into_ready(self) -> ReadyProgram {
        ReadyProgram(self.object.into_native())
    }

    /// Takes a program that was made in a context which shares objects with `gl`'s.
    pub fn adopt(gl: &Gl, ready: ReadyProgram) -> Self {
        Self { gl: gl.clone(), object: ProgramObject::from_native(gl, ready.0) }
    }

    /// Makes this the program of the following draws.
    pub fn bind(&self) {
        // SAFETY: the program is linked and ours.
        unsafe { self.gl.use_program(Some(self.object.native())) }
    }
}

/// Compiles and links the texts of a vertex and a fragment shader, each with its name. The driver's complaints name the
/// places in files that [`super::shader_source`] marked.
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
            // A shader that is attached lives on until its program goes.
            gl.delete_shader(shader);
            if !compiled {
                return Err(GpuError::Compile { name: name.into(), log });
            }
        }
        gl.link_program(program);
        if !gl.get_program_link_status(program) {
            let log = gl.get_program_info_log(program);
            return Err(GpuError::Compile { name: format!("the program of {}", fragment.0), log });
        }
    }
    Ok(object)
}
