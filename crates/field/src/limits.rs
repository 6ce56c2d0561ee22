//! All limits of this crate. Errors name the limit that was exceeded. Tests pass smaller limits to exceed them.

/// Upper limits on the text of a scene and on everything built from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum nesting of includes, in scenes and in shaders.
    pub include_depth_max: usize,
    /// Maximum number of distinct nodes in an expression graph (32 bytes each).
    pub graph_nodes_max: usize,
    /// Maximum number of clauses in a tape (each takes four bytes, or 40 while the tape is built).
    pub tape_clauses_max: usize,
    /// Maximum number of outputs of a tape. Each output keeps its slot until the end of the tape.
    pub tape_outputs_max: usize,
    /// Maximum number of memory slots to which the values of one tape are spilled.
    pub tape_memory_max: usize,
    /// Maximum number of bytes in a scene's text and its included files together.
    pub scene_bytes_max: usize,
    /// Maximum number of tokens in a scene's text and its included files together.
    pub scene_tokens_max: usize,
    /// Maximum nesting of expressions in a scene's text.
    pub scene_nesting_max: usize,
    /// Maximum nesting of expressions after function calls have been expanded.
    pub scene_depth_max: usize,
    /// Maximum number of operations after functions and loops have been expanded, before equal operations are merged.
    pub scene_expansion_max: usize,
    /// Maximum number of iterations of one loop.
    pub scene_loop_max: usize,
    /// Maximum number of mistakes reported at once.
    pub scene_diagnostics_max: usize,
    /// Maximum number of files that a scene includes, each counted once. `include_depth_max` limits the nesting.
    pub scene_includes_max: usize,
    /// Maximum number of parameters of a scene.
    pub scene_params_max: usize,
    /// Maximum number of textures of a scene. OpenGL 3.3 guarantees that a fragment shader can use 16.
    pub scene_textures_max: usize,
    /// Maximum number of textures of a scene with media, which occupy two texture units.
    pub scene_textures_beside_media_max: usize,
    /// Maximum number of different texts and pictures that the shapes of a scene read.
    pub scene_shapes_max: usize,
    /// Maximum number of letters in a text that is a shape.
    pub shape_letters_max: usize,
    /// Maximum number of objects of a scene.
    pub scene_objects_max: usize,
    /// Maximum number of materials of a scene.
    pub scene_materials_max: usize,
    /// Maximum number of lights of a scene.
    pub scene_lights_max: usize,
    /// Maximum number of media of a scene, such as fog and clouds.
    pub scene_media_max: usize,
    /// Maximum number of swarms of a scene.
    pub scene_swarms_max: usize,
    /// Maximum number of points in all swarms of a scene.
    pub scene_swarm_points_max: usize,
    /// Maximum number of named cameras of a scene.
    pub scene_cameras_max: usize,
    /// Maximum number of values that are computed once per frame. Further values are computed at every point.
    pub hoisted_max: usize,
}

/// Frames a second at which light is fed back, in the time of the song.
pub const FEEDBACK_RATE: u32 = 60;
/// Maximum number of earlier frames on which a frame depends. Stills and seeks draw up to twice as many small frames.
pub const FEEDBACK_FRAMES_MAX: u32 = 10 * FEEDBACK_RATE;
/// The largest fraction of the last frame's light that stays: after [`FEEDBACK_FRAMES_MAX`] frames, 1/255 is left.
pub const FEEDBACK_DECAY_MAX: f32 = 0.9908;
/// The brightest light that is fed back.
pub const LAST_LIGHT_MAX: f32 = 16.0;

/// Maximum nesting of operators, brackets and components in one statement of GLSL. naga parses and lowers them
/// recursively.
pub const GLSL_NESTING_MAX: usize = 192;
/// Maximum number of values of a struct in GLSL.
pub const GLSL_STRUCT_VALUES_MAX: usize = 1 << 12;
/// Maximum number of parameters of a macro in GLSL.
pub const GLSL_MACRO_PARAMETERS_MAX: usize = 64;

/// The limits of the program.
pub const LIMITS: Limits = Limits {
    include_depth_max: 16,
    graph_nodes_max: 1 << 21,
    tape_clauses_max: 1 << 21,
    tape_outputs_max: 16,
    tape_memory_max: 1 << 16,
    scene_bytes_max: 1 << 20,
    scene_tokens_max: 400_000,
    scene_nesting_max: 256,
    scene_depth_max: 400,
    scene_expansion_max: 1 << 22,
    scene_loop_max: 4_096,
    scene_diagnostics_max: 20,
    scene_includes_max: 64,
    scene_params_max: 64,
    scene_textures_max: 12,
    scene_textures_beside_media_max: 10,
    scene_shapes_max: 16,
    shape_letters_max: 200,
    scene_objects_max: 256,
    scene_materials_max: 64,
    scene_lights_max: 16,
    scene_media_max: 8,
    scene_swarms_max: 8,
    scene_swarm_points_max: 1 << 16,
    scene_cameras_max: 16,
    hoisted_max: 256,
};
