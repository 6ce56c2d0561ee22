//! All limits of this crate. Errors name the number that they exceed, and tests pass smaller limits to reach them.

/// Upper limits on the text of a scene and on everything built from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Deepest nesting of shader includes.
    pub include_depth_max: usize,
    /// Most distinct nodes of an expression graph (32 bytes each).
    pub graph_nodes_max: usize,
    /// Most clauses of a tape (four bytes each, and 40 while it is built).
    pub tape_clauses_max: usize,
    /// Most outputs of a tape. Each keeps its slot until the end of the tape.
    pub tape_outputs_max: usize,
    /// Most memory slots that the values of one tape are spilled to.
    pub tape_memory_max: usize,
    /// Most bytes of a scene's text, including the files that it includes.
    pub scene_bytes_max: usize,
    /// Most tokens of a scene, including the files that it includes.
    pub scene_tokens_max: usize,
    /// Deepest nesting of expressions in a scene's text.
    pub scene_nesting_max: usize,
    /// Deepest nesting of expressions after function calls have been expanded.
    pub scene_depth_max: usize,
    /// Most operations after functions and loops have been expanded, before equal operations are merged.
    pub scene_expansion_max: usize,
    /// Most iterations of one loop.
    pub scene_loop_max: usize,
    /// Most mistakes reported at once.
    pub scene_diagnostics_max: usize,
    /// Most files that a scene includes, each counted once; [`Limits::include_depth_max`] limits their depth.
    pub scene_includes_max: usize,
    /// Most parameters of a scene.
    pub scene_params_max: usize,
    /// Most textures of a scene (OpenGL 3.3 guarantees a fragment shader 16).
    pub scene_textures_max: usize,
    /// Most objects of a scene.
    pub scene_objects_max: usize,
    /// Most materials of a scene.
    pub scene_materials_max: usize,
    /// Most lights of a scene.
    pub scene_lights_max: usize,
    /// Most named cameras of a scene.
    pub scene_cameras_max: usize,
    /// Most values that are computed once per frame; further ones are computed at every point.
    pub hoisted_max: usize,
}

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
    scene_objects_max: 256,
    scene_materials_max: 64,
    scene_lights_max: 16,
    scene_cameras_max: 16,
    hoisted_max: 256,
};
