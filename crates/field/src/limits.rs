//! All limits of this crate. Errors name the limit that was exceeded. Tests pass smaller limits to exceed them.

/// Declares the limits: each with its type and its value in the program.
macro_rules! limits {
    ($($(#[doc = $doc:literal])+ $name:ident: $type:ty = $value:expr;)+) => {
        /// Upper limits on the text of a scene and on everything built from it.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Limits { $($(#[doc = $doc])+ pub $name: $type,)+ }

        /// The limits of the program.
        pub const LIMITS: Limits = Limits { $($name: $value,)+ };
    };
}

limits! {
    /// Maximum nesting of includes, in scenes and in shaders.
    include_depth_max: usize = 16;
    /// Maximum number of distinct nodes in an expression graph (32 bytes each).
    graph_nodes_max: usize = 1 << 21;
    /// Maximum number of bytes in a scene's text and its included files together.
    scene_bytes_max: usize = 1 << 20;
    /// Maximum number of tokens in a scene's text and its included files together.
    scene_tokens_max: usize = 400_000;
    /// Maximum nesting of expressions in a scene's text.
    scene_nesting_max: usize = 256;
    /// Maximum nesting of expressions after function calls have been expanded.
    scene_depth_max: usize = 400;
    /// Maximum number of operations after functions and loops have been expanded, before equal operations are merged.
    scene_expansion_max: usize = 1 << 22;
    /// Maximum number of iterations of one loop.
    scene_loop_max: usize = 4_096;
    /// Maximum number of mistakes reported at once.
    scene_diagnostics_max: usize = 20;
    /// Maximum number of files that a scene includes, each counted once. `include_depth_max` limits the nesting.
    scene_includes_max: usize = 64;
    /// Maximum number of parameters of a scene.
    scene_params_max: usize = 64;
    /// Maximum number of textures of a scene. OpenGL 3.3 guarantees that a fragment shader can use 16.
    scene_textures_max: usize = 12;
    /// Maximum number of textures of a scene with media, which occupy two texture units.
    scene_textures_beside_media_max: usize = 10;
    /// Maximum number of different texts and pictures that the shapes of a scene read.
    scene_shapes_max: usize = 16;
    /// Maximum number of letters in a text that is a shape.
    shape_letters_max: usize = 200;
    /// Maximum number of objects of a scene.
    scene_objects_max: usize = 256;
    /// Maximum number of materials of a scene.
    scene_materials_max: usize = 64;
    /// Maximum number of lights of a scene.
    scene_lights_max: usize = 16;
    /// Maximum number of media of a scene, such as fog and clouds.
    scene_media_max: usize = 8;
    /// Maximum number of swarms of a scene.
    scene_swarms_max: usize = 8;
    /// Maximum number of points in all swarms of a scene.
    scene_swarm_points_max: usize = 1 << 16;
    /// Maximum number of numbers with inertia (`follow`, `spring`, `since`) of a scene.
    scene_motions_max: usize = 64;
    /// Maximum number of named cameras of a scene.
    scene_cameras_max: usize = 16;
    /// Maximum number of values that are computed once per frame. Further values are computed at every point.
    hoisted_max: usize = 256;
}

/// Seconds of sound from which numbers with inertia are computed.
pub const MOTION_SECONDS: f32 = 6.0;
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
