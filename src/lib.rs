//! Mariana: a music visualizer whose worlds are formulas.
//!
//! The folders follow the pipeline: `mariana_player` reads sound, `mariana_music` analyses it, [`frame`] adds time and
//! camera, and [`gpu`] draws the frame for a window ([`shell`]) or a file ([`export`]). ARCHITECTURE.md lists all
//! modules and the rules between them.

pub use mariana_commands::{self as commands, input};
pub use mariana_files::{atomic_file, attempt, caches, child, documents, ending, file_names, reading};
pub use mariana_render::{
    faults, flash, frame, placement, ray_diagram, reading_order, srgb, system_fonts, view,
};
pub use mariana_scenes::{self as scenes, probing, thumbnails};
pub use mariana_stage as show;
pub use mariana_ui::{self as ui, clock, monitor};

/// The GPU side: [`mariana_render::gpu`], with the types that most modules need.
pub mod gpu {
    pub use mariana_render::gpu::background::{Sources, WorkerContext};
    pub use mariana_render::gpu::edge_samples::EdgeSamples;
    pub use mariana_render::gpu::error::GpuError;
    pub use mariana_render::gpu::gl::{Gl, GlInfo};
    pub use mariana_render::gpu::headless::Headless;
    pub use mariana_render::gpu::mode::CellUse;
    pub use mariana_render::gpu::path_state::KeptPaths;
    pub use mariana_render::gpu::picture_reader::PictureReader;
    pub use mariana_render::gpu::program::Program;
    pub use mariana_render::gpu::program_store::ProgramKey;
    pub use mariana_render::gpu::renderer::{
        Counting, Evaluations, FeedbackRequest, PathOrder, PathSampling, Renderer, Sketch,
    };
    pub use mariana_render::gpu::scene_program::{Interpreter, Mode};
    pub use mariana_render::gpu::scene_resources::{
        BuiltRegions, RegionMaker, RegionRequest, SceneResources,
    };
    pub use mariana_render::gpu::shader_source::{ShaderLibrary, Variant};
    pub use mariana_render::gpu::target::Target;
    pub use mariana_render::gpu::*;
}

pub mod cached_files;
pub mod cli;
pub mod config;
pub mod covers;
pub mod demo_track;
pub mod export;
pub mod limits;
pub mod moving_textures;
pub mod program_cache;
pub mod sending;
pub mod session;
pub mod shell;
pub mod song_shapes;
pub mod song_structures;
pub mod stems;
pub mod videos;
pub mod y4m;
