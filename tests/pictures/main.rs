//! Tests of rendered images, without a window.

mod agreement;
mod blends;
mod embedded;
mod fades;
mod feedback;
mod flash_limiter;
#[cfg(target_os = "linux")]
mod flashes;
mod followed_sounds;
mod glsl_import;
mod golden;
mod hardware_path;
mod kept_paths;
mod light;
mod light_to_screen;
mod materials;
mod media;
mod mips;
mod paths;
mod placing;
mod projections;
mod ray_oracle;
mod scene_looks;
mod scene_modes;
mod shaders;
mod shadow_of_a_facing_surface;
mod shipped_scenes;
mod swarm;
mod textures;
mod two_dimensions;
mod views;

#[path = "../support/mod.rs"]
mod support;
