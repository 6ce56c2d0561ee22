//! Every ceiling of the program, in one place.
//!
//! A limit is data: code that meets one reads it here, an error that reports one names the number
//! that stands here, and a test reaches it. Nothing in this file depends on any other room.

/// Ceilings on what comes from outside and on what the program allocates for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most channels of a decoded stream that are mixed down to stereo. More is an over-limit input.
    pub channels_max: u16,
    /// Lowest sample rate of a stream, in hertz.
    pub sample_rate_min: u32,
    /// Highest sample rate of a stream, in hertz.
    pub sample_rate_max: u32,
    /// Most undecodable packets in a row before a file is given up as damaged.
    pub bad_packets_in_a_row: u32,
    /// Most frames (one sample per channel) that one decoded packet may hold.
    pub packet_frames_max: usize,
    /// Most tracks of a playlist; further ones are left out.
    pub playlist_tracks_max: usize,
    /// Most bytes of the file of a list of tracks.
    pub playlist_bytes_max: u64,
    /// Most lists that are read for one playlist, nested ones counted.
    pub playlist_lists_max: usize,
    /// Deepest nesting of lists and folders.
    pub playlist_depth_max: usize,
    /// Most entries of lists and folders that are looked at for one playlist.
    pub playlist_looks_max: usize,
    /// Longest time over which a feature track remembers, in seconds (0.5 MB for each).
    pub feature_track_seconds_max: f64,
    /// Longest duration of a stream, in seconds, that a container's claim is believed (a year); beyond, it is unknown.
    pub claimed_duration_max: f64,
    /// Smallest width and height of a picture or a window, in pixels.
    pub picture_side_min: u32,
    /// Largest width and height of a picture, in pixels (what OpenGL 3.3 drivers commonly allow).
    pub picture_side_max: u32,
    /// Most pixels of one picture (64 Mi: a target of 16-bit floats takes 512 MiB).
    pub picture_pixels_max: u64,
    /// Lowest and highest frame rate of `analyze`, `video` and the frame cap, in frames per second.
    pub fps_min: f64,
    /// See [`Limits::fps_min`].
    pub fps_max: f64,
    /// Longest time that `--at`, `--start` and `--duration` take, in seconds (a day).
    pub seconds_max: f64,
    /// Largest shift of the picture against the sound, in milliseconds, either way.
    pub latency_ms_max: f64,
    /// Most bytes of the file of settings.
    pub settings_bytes_max: usize,
    /// Deepest nesting of shader includes.
    pub include_depth_max: usize,
    /// Largest shader source after its includes were resolved, in bytes.
    pub shader_bytes_max: usize,
    /// Most distinct nodes of an expression graph (32 bytes each).
    pub graph_nodes_max: usize,
    /// Most clauses of a tape (four bytes each, and 40 while it is built).
    pub tape_clauses_max: usize,
    /// Most outputs of a tape; each keeps a slot to the end.
    pub tape_outputs_max: usize,
    /// Most memory slots that the values of one tape are spilled to.
    pub tape_memory_max: usize,
    /// Most bytes of a scene's text, its includes counted.
    pub scene_bytes_max: usize,
    /// Most words and signs of a scene, its includes counted.
    pub scene_tokens_max: usize,
    /// Deepest nesting of expressions in a scene's text.
    pub scene_nesting_max: usize,
    /// Deepest nesting of expressions once functions stand where they are called.
    pub scene_depth_max: usize,
    /// Most operations that a scene is expanded to by functions and loops before equal ones are merged.
    pub scene_expansion_max: usize,
    /// Most rounds of one loop.
    pub scene_loop_max: usize,
    /// Most mistakes that are reported at once.
    pub scene_diagnostics_max: usize,
    /// Most files that a scene includes, each counted once; [`Limits::include_depth_max`] holds for their depth.
    pub scene_includes_max: usize,
    /// Most parameters of a scene.
    pub scene_params_max: usize,
    /// Most textures of a scene (16 are what OpenGL 3.3 promises a fragment shader).
    pub scene_textures_max: usize,
    /// Most bytes of the file of a texture.
    pub texture_bytes_max: usize,
    /// Largest width and height of a texture, in texels.
    pub texture_side_max: u32,
    /// Most texels of a texture (16 Mi: 64 MiB, and a third more with its mip levels).
    pub texture_pixels_max: u64,
    /// Most objects of a scene.
    pub scene_objects_max: usize,
    /// Most materials of a scene.
    pub scene_materials_max: usize,
    /// Most lights of a scene.
    pub scene_lights_max: usize,
    /// Most texels of a frame's regions (4 Mi: 64 MiB); cells beyond have the whole tape.
    pub region_texels_max: usize,
    /// Most interpreters, and most programs of views, that are kept for scenes to come (some 20 MiB each on a software
    /// renderer).
    pub programs_kept_max: usize,
    /// Longest time that a scene's first picture may take in a window before the scene that was shown stays, in seconds.
    pub picture_seconds_max: f64,
    /// Most values that are computed once a frame instead of at every point; further ones stay where they are.
    pub hoisted_max: usize,
}

/// The limits that the program runs with.
pub const LIMITS: Limits = Limits {
    channels_max: 32,
    sample_rate_min: 4_000,
    sample_rate_max: 768_000,
    bad_packets_in_a_row: 256,
    packet_frames_max: 1 << 20,
    claimed_duration_max: 31_536_000.0,
    playlist_tracks_max: 20_000,
    playlist_bytes_max: 1 << 22,
    playlist_lists_max: 64,
    playlist_depth_max: 16,
    playlist_looks_max: 200_000,
    feature_track_seconds_max: 60.0,
    picture_side_min: 1,
    picture_side_max: 16_384,
    picture_pixels_max: 1 << 26,
    fps_min: 1.0,
    fps_max: 1_000.0,
    seconds_max: 86_400.0,
    latency_ms_max: 5_000.0,
    settings_bytes_max: 1 << 20,
    include_depth_max: 16,
    shader_bytes_max: 1 << 20,
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
    texture_bytes_max: 1 << 25,
    texture_side_max: 8_192,
    texture_pixels_max: 1 << 24,
    scene_objects_max: 256,
    scene_materials_max: 64,
    scene_lights_max: 16,
    region_texels_max: 1 << 22,
    programs_kept_max: 4,
    picture_seconds_max: 10.0,
    hoisted_max: 256,
};

impl Default for Limits {
    fn default() -> Self {
        LIMITS
    }
}
