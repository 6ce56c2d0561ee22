//! The program that draws a scene, in its two forms: interpreted and compiled.
//!
//! Both are `scene.frag`; they differ in the file `scene_functions.glsl` that it includes. The compiled one holds the
//! scene's expressions, the interpreted one runs them from a texture buffer and so fits every scene that its variant has
//! the operators, registers and textures for.

use std::collections::BTreeSet;

use super::error::GpuError;
use super::gl::{Gl, GlInfo};
use super::program::Program;
use super::renderer::Counting;
use super::shader_source::{ShaderLibrary, Variant};
use crate::frame::block::block_defines;
use crate::graph::{CELL_HASH_GLSL, Op};
use crate::limits::LIMITS;
use crate::tape::glsl;
use crate::world::{TapeBuffers, World};

/// The fragment shader of scenes.
pub const SCENE_SHADER: &str = "scene.frag";
/// The define of the variant that counts distance evaluations and clauses.
pub const COUNTING_DEFINE: &str = "COUNT_EVALUATIONS";

/// How a scene's expressions are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// From the tape in a texture buffer.
    Interpreted,
    /// As GLSL of their own.
    Compiled,
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Mode::Interpreted => "interpreted",
            Mode::Compiled => "compiled",
        })
    }
}

/// What an interpreter needs to run a scene.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Interpreter {
    operators: BTreeSet<Op>,
    slots: usize,
    memory: usize,
    textures: usize,
}

/// Registers of the variants.
const SLOT_STEPS: [usize; 6] = [8, 16, 32, 64, 128, 256];

/// Why a scene cannot be interpreted by a driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the scene's tape needs {needed} texels of a texture buffer, but the driver has {available}: it is compiled instead"
)]
pub struct DoesNotFit {
    /// Texels that are needed.
    pub needed: usize,
    /// Texels that the driver reports.
    pub available: usize,
}

impl Interpreter {
    /// The variant for a scene: its operators, its registers rounded up.
    pub fn for_scene(buffers: &TapeBuffers, textures: usize) -> Self {
        let slots = SLOT_STEPS.iter().copied().find(|&step| step >= buffers.slots).unwrap_or(256);
        let memory = if buffers.memory == 0 { 0 } else { buffers.memory.next_power_of_two() };
        Self { operators: buffers.operators.clone(), slots, memory, textures }
    }

    /// The variant that runs every scene without spilled values.
    pub fn for_all() -> Self {
        Self {
            operators: Op::ALL.iter().copied().collect(),
            slots: 256,
            memory: 0,
            textures: LIMITS.scene_textures_max,
        }
    }

    /// Whether what this variant was made for includes what `other` was.
    pub fn covers(&self, other: &Self) -> bool {
        self.operators.is_superset(&other.operators)
            && self.slots >= other.slots
            && self.memory >= other.memory
            && self.textures >= other.textures
    }

    /// Whether a scene's buffers fit what the driver reports.
    ///
    /// # Errors
    /// [`DoesNotFit`], with both numbers.
    pub fn fits(buffers: &TapeBuffers, info: &GlInfo) -> Result<(), DoesNotFit> {
        let needed = (buffers.words.len() / 4).max(buffers.table.len());
        let available = info.texture_buffer_texels_max as usize;
        if needed <= available { Ok(()) } else { Err(DoesNotFit { needed, available }) }
    }

    /// The shader's text of the variant.
    pub fn variant(&self, counting: Counting) -> Variant {
        let mut variant = common(self.textures, counting);
        variant.defines.push(format!("SLOTS {}", self.slots));
        variant.defines.push(format!("MEMORY {}", self.memory));
        variant.defines.push(format!("CLAUSES_MAX {}", LIMITS.tape_clauses_max));
        let functions = "#include \"interpreted_scene.glsl\"\n".to_owned();
        variant.generated.push(("scene_functions.glsl".into(), functions));
        variant.generated.push(("operators.glsl".into(), glsl::operators(&self.operators)));
        variant
    }
}

/// The shader's text of a scene whose functions are `functions`: [`World::compiled_glsl`], or others of the same names.
pub fn compiled_variant(functions: &str, textures: usize, counting: Counting) -> Variant {
    let mut variant = common(textures, counting);
    variant.generated.push(("scene_functions.glsl".into(), functions.to_owned()));
    variant
}

/// What both forms share.
fn common(textures: usize, counting: Counting) -> Variant {
    let mut variant = Variant::default();
    variant.defines.extend(block_defines());
    variant.defines.push(format!("TEXTURES {textures}"));
    if counting == Counting::On {
        variant.defines.push(COUNTING_DEFINE.to_owned());
    }
    variant.generated.push(("cell_hash.glsl".into(), CELL_HASH_GLSL.to_owned()));
    variant
}

/// The variant of a world in a mode.
///
/// # Errors
/// A scene over its limits, generated GLSL that is refused, or a tape that the driver has no room for.
pub fn variant_of(
    world: &World,
    buffers: &TapeBuffers,
    mode: Mode,
    info: &GlInfo,
    counting: Counting,
) -> Result<Variant, GpuError> {
    match mode {
        Mode::Compiled => Ok(compiled_variant(&world.compiled_glsl()?, world.pictures.len(), counting)),
        Mode::Interpreted => {
            Interpreter::fits(buffers, info)?;
            Ok(Interpreter::for_scene(buffers, world.pictures.len()).variant(counting))
        }
    }
}

/// Links the program of a variant.
///
/// # Errors
/// What the driver refuses, with its log.
pub fn link_scene(gl: &Gl, library: &ShaderLibrary, variant: &Variant) -> Result<Program, GpuError> {
    Program::link(gl, library, SCENE_SHADER, variant)
}
