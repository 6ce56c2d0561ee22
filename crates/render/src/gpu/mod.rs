//! The GPU side: context, programs, targets, passes and readback. Only this module uses glow.

pub mod api;
#[cfg(not(target_family = "wasm"))]
pub mod background;
#[cfg(target_os = "linux")]
pub mod driver_cache;
mod edge_list;
pub mod edge_samples;
pub mod error;
mod evaluations;
mod feedback;
pub mod flash_pass;
pub mod gl;
mod guest;
#[cfg(not(target_family = "wasm"))]
pub mod headless;
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub mod heaps;
pub mod media;
pub mod mode;
pub mod object;
mod passes;
pub mod path_state;
pub mod picture_reader;
pub mod post;
pub mod program;
pub mod program_store;
pub mod renderer;
pub mod samplers;
pub mod scene_program;
pub mod scene_resources;
pub mod shader_source;
#[cfg(not(target_family = "wasm"))]
pub mod stand_ins;
mod swarm;
pub mod target;
pub mod texel_list;
pub mod texture;
mod tiles;
pub mod timer;
mod trails;
