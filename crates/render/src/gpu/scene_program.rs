//! The program that draws a scene, in an interpreted and a compiled form.
//!
//! Both forms are `scene.frag` with different versions of the included `scene_functions.glsl`. In the compiled form
//! this file contains the scene's expressions. In the interpreted form it contains an interpreter that reads the
//! expressions from a list of texels. A variant of the interpreter draws every scene that needs no more operators,
//! registers and textures than the variant has.
//!
//! **One loop around the interpreter.** Drivers inline every call and compile it again. Therefore one call in a loop
//! serves a surface's normals, object and occlusion, and a second call serves its material and ambient light. Textures
//! and rare operators are computed between loops: inside a loop, renderers that never skip a branch would compute them
//! for every clause.
//!
//! On llvmpipe, vectors of 128 bits are as fast as vectors of 256 bits. With 512 bits (`LP_NATIVE_VECTOR_WIDTH`), Mesa
//! 22.3.6 aborts.

pub use super::error::DoesNotFit;
use super::error::Result;
use super::evaluations::Counting;
use super::gl::{Gl, GlInfo};
use super::mode::CellUse;
pub use super::mode::Mode;
use super::program::{PendingProgram, Program, ProgramTexts};
use super::shader_source::{ShaderLibrary, Variant};
use crate::frame::block::{block_defines, light_defines};
use crate::frame::projection::{Projection, projection_defines};
use crate::view::scale;
use mariana_field::graph::{CELL_HASH_GLSL, levels_glsl};
use mariana_field::region::{RegionPlan, RegionVariant};
use mariana_field::tape::interpreter;
use mariana_field::world::{SceneFeatures, TapeBuffers, World};

/// The fragment shader of scenes.
pub const SCENE_SHADER: &str = "scene.frag";
/// The fragment shader that draws scenes by paths of light.
pub const PATH_SHADER: &str = "path.frag";
/// The define of the variant that counts distance evaluations and clauses.
pub const COUNTING_DEFINE: &str = "COUNT_EVALUATIONS";
/// The define of scenes whose value is not a distance.
const NON_LIPSCHITZ_DEFINE: &str = "NON_LIPSCHITZ 1";

/// Scenes with more statements than this are compiled only on request, because compiling would take minutes.
pub const COMPILED_BY_ITSELF_MAX: usize = 20_000;

/// A variant of the interpreter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interpreter {
    tapes: interpreter::Variant,
    regions: RegionVariant,
    features: SceneFeatures,
}

impl Interpreter {
    /// The smallest variant for a scene on this driver; for a scene with rare features on a GPU, a variant that
    /// scenes with the same rare features share.
    pub fn for_scene(
        features: SceneFeatures,
        buffers: &TapeBuffers,
        plan: &RegionPlan,
        info: &GlInfo,
    ) -> Self {
        let tapes = if info.software { &buffers.software_variant } else { &buffers.variant }.clone();
        let own = Self { tapes, regions: plan.variant.clone(), features };
        // On a GPU, scenes with the same rare features share an interpreter, as other scenes share the universal one.
        let shared = Self { features: features.with_usual(), ..Self::universal(own.is_non_lipschitz()) };
        let is_rare = shared.features != SceneFeatures::USUAL;
        if is_rare && !info.software && shared.covers(&own) { shared } else { own }
    }

    /// The variant that draws almost every scene whose value is a distance or, with `non_lipschitz`, is not a distance.
    /// GPUs compile this variant before editing starts.
    pub fn universal(non_lipschitz: bool) -> Self {
        Self {
            tapes: interpreter::Variant::universal(),
            regions: RegionVariant::universal(non_lipschitz),
            features: SceneFeatures::USUAL,
        }
    }

    /// True if the variant draws scenes whose value is not a distance.
    pub fn is_non_lipschitz(&self) -> bool {
        self.regions.non_lipschitz
    }

    /// True if this variant can draw every scene that `other` can.
    pub fn covers(&self, other: &Self) -> bool {
        let (regions, others) = (&self.regions, &other.regions);
        let every_case = self.tapes.every_case;
        let registers = |of: &RegionVariant| {
            if every_case { of.registers } else { of.registers.next_power_of_two() }
        };
        self.tapes.covers(&other.tapes)
            && self.features.covers(other.features)
            && regions.non_lipschitz == others.non_lipschitz
            && registers(regions) >= registers(others)
            && regions.operators.is_superset(&others.operators)
            && regions.compounds.covers(others.compounds)
    }

    /// Checks that a scene's buffers fit the driver's limits.
    ///
    /// # Errors
    /// [`DoesNotFit`] if a buffer exceeds a limit.
    pub fn fits(buffers: &TapeBuffers, plan: &RegionPlan, info: &GlInfo) -> Result<(), DoesNotFit> {
        if !plan.runs || !buffers.runs {
            return Err(DoesNotFit::Registers);
        }
        let needed = buffers.texels_max().max(plan.whole_texels);
        let available = info.list_texels_max as usize;
        if needed <= available { Ok(()) } else { Err(DoesNotFit::Texels { needed, available }) }
    }

    /// The shader text of the variant.
    pub fn variant(&self, counting: Counting) -> Variant {
        let mut variant = common(self.tapes.textures, self.features, counting);
        if self.regions.non_lipschitz {
            variant.defines.push(NON_LIPSCHITZ_DEFINE.to_owned());
        }
        if self.tapes.every_case {
            variant.defines.push("LIMITED_ROUNDS 1".to_owned());
        }
        let functions = "#include \"interpreted_scene.glsl\"\n".to_owned();
        variant.generated.push(("scene_functions.glsl".into(), functions));
        let RegionVariant { operators, compounds, registers, .. } = &self.regions;
        let operators = self.tapes.text(operators, *compounds, *registers);
        variant.generated.push(("operators.glsl".into(), operators));
        variant
    }
}

/// The shader text of a scene with the given `functions`: [`World::compiled_glsl`], or functions with the same names.
pub fn compiled_variant(
    functions: &str,
    textures: usize,
    features: SceneFeatures,
    counting: Counting,
) -> Variant {
    let mut variant = common(textures, features, counting);
    let functions = format!("{functions}#include \"surface.glsl\"\n");
    variant.generated.push(("scene_functions.glsl".into(), functions));
    variant
}

/// The samplers of a scene's textures, and the function that reads them; see `scene_textures.glsl`.
fn texture_samplers(textures: usize) -> String {
    let samplers = (0..textures).map(|index| format!("uniform sampler2D scene_texture_{index};\n"));
    let reads = (0..textures).map(|index| {
        let texture = format!("scene_texture_{index}");
        format!("    if (index == {index}) return textureGrad({texture}, PLACE_IN({texture}), dx, dy);\n")
    });
    let (samplers, reads): (String, String) = (samplers.collect(), reads.collect());
    format!(
        "{samplers}\nvec4 sample_texture(int index, vec2 uv, vec2 dx, vec2 dy) {{\n{reads}    return vec4(0.0);\n}}\n"
    )
}

fn common(textures: usize, features: SceneFeatures, counting: Counting) -> Variant {
    let mut variant = Variant::default();
    variant.defines.extend(block_defines());
    variant.defines.extend(light_defines());
    variant.defines.extend(mariana_field::rays::defines());
    variant.defines.extend(features.defines().map(str::to_owned));
    if counting == Counting::On {
        variant.defines.push(COUNTING_DEFINE.to_owned());
    }
    variant.generated.push(("cell_hash.glsl".into(), CELL_HASH_GLSL.to_owned()));
    variant.generated.push(("levels.glsl".into(), levels_glsl()));
    variant.generated.push(("texture_samplers.glsl".into(), texture_samplers(textures)));
    // Only views use these two files.
    variant.generated.push(("view_scales.glsl".into(), scale::glsl()));
    variant.generated.push(("view_dispatch.glsl".into(), scale::dispatch_glsl()));
    variant
}

/// The shader text of a world with generated GLSL.
///
/// # Errors
/// Fails if the generated GLSL is invalid.
pub fn compiled_variant_of(world: &World, counting: Counting) -> Result<Variant> {
    let functions = world.compiled_glsl()?;
    let mut variant = compiled_variant(&functions, world.pictures.len(), world.features, counting);
    if world.non_lipschitz {
        variant.defines.push(NON_LIPSCHITZ_DEFINE.to_owned());
    }
    variant.defines.push(format!("PLANES {}", world.planes.len()));
    Ok(variant)
}

/// The variant of a world in a mode.
///
/// # Errors
/// Fails if the scene exceeds its limits, the generated GLSL is invalid, or the tape exceeds the driver's limits.
pub fn variant_of(
    world: &World,
    buffers: &TapeBuffers,
    plan: &RegionPlan,
    mode: Mode,
    info: &GlInfo,
    counting: Counting,
) -> Result<Variant> {
    match mode {
        Mode::Compiled => compiled_variant_of(world, counting),
        Mode::Interpreted => {
            Interpreter::fits(buffers, plan, info)?;
            Ok(Interpreter::for_scene(world.features, buffers, plan, info).variant(counting))
        }
    }
}

/// Removes cell lookups ([`CellUse::divides`]) from the variant of a compiled scene. The scene's value must be a
/// distance. The image stays the same, but is drawn faster: the code is 5 to 23 % shorter on AMD and 6 to 24 % shorter
/// on Xe, and seven of thirteen scenes run with more waves on AMD.
pub fn without_cells(mut variant: Variant) -> Variant {
    variant.defines.push("NO_CELLS 1".to_owned());
    variant
}

/// The variant that draws frames of a compiled world, with or without cell lookups.
///
/// # Errors
/// Same errors as [`compiled_variant_of`].
pub fn compiled_drawing_variant(world: &World, has_cells: bool) -> Result<Variant> {
    let variant = compiled_variant_of(world, Counting::Off)?;
    Ok(if has_cells { variant } else { without_cells(variant) })
}

/// The variant that draws frames of a world in a mode, with cell lookups if cells are used.
///
/// # Errors
/// Same errors as [`variant_of`].
pub fn drawing_variant_of(
    world: &World,
    buffers: &TapeBuffers,
    plan: &RegionPlan,
    mode: Mode,
    cells: CellUse,
    info: &GlInfo,
) -> Result<Variant> {
    match mode {
        Mode::Compiled => compiled_drawing_variant(world, cells.divides(world, buffers, mode)),
        Mode::Interpreted => variant_of(world, buffers, plan, mode, info, Counting::Off),
    }
}

/// Turns a counting variant into a variant that draws views.
pub fn as_views(mut counting: Variant) -> Variant {
    counting.defines.push("VIEWS 1".to_owned());
    counting
}

/// Makes a variant draw a projection. A variant without this draws only flat pictures for one eye, which costs less.
pub fn projected(mut variant: Variant, projection: &Projection) -> Variant {
    if !projection.is_plain() {
        variant.defines.extend(projection_defines());
    }
    variant
}

/// Makes the sky of a variant invisible, for images that are laid over other images.
pub fn without_sky(mut variant: Variant) -> Variant {
    variant.defines.push("NO_SKY 1".to_owned());
    variant
}

/// Turns a variant into a variant that draws coverage: its light is the fraction of an eye ray that does not reach the
/// sky, which is 1 on a surface without haze.
pub fn as_coverage(variant: Variant) -> Variant {
    let mut variant = without_sky(variant);
    variant.defines.push("COVERAGE 1".to_owned());
    variant
}

/// Turns a variant into a variant of [`PATH_SHADER`], which draws paths of light.
pub fn as_paths(mut variant: Variant) -> Variant {
    variant.defines.push("PATHS 1".to_owned());
    variant
}

/// Returns the texts of the program that draws paths of light, from a variant for [`link_scene`].
///
/// # Errors
/// Fails if a shader cannot be read.
pub fn path_texts(gl: &Gl, library: &ShaderLibrary, variant: &Variant) -> Result<ProgramTexts> {
    Ok(ProgramTexts::assemble(library, PATH_SHADER, &as_paths(variant.clone()), gl.info())?)
}

/// Links the program of a variant.
///
/// # Errors
/// Fails with the driver's log if the driver rejects the program.
pub fn link_scene(gl: &Gl, library: &ShaderLibrary, variant: &Variant) -> Result<Program> {
    begin_scene(gl, library, variant)?.finish()
}

/// Begins to link the program of a variant.
///
/// # Errors
/// Fails if the driver cannot create more objects.
pub fn begin_scene(gl: &Gl, library: &ShaderLibrary, variant: &Variant) -> Result<PendingProgram> {
    PendingProgram::of(gl, &ProgramTexts::assemble(library, SCENE_SHADER, variant, gl.info())?)
}
