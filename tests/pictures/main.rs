//! Tests of rendered images, without a window.

mod agreement;
mod blends;
mod embedded;
mod fades;
mod feedback;
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

// The limiter is not used here.
#[allow(dead_code, unused_imports)]
#[path = "../../crates/render/tests/flashes/witness/mod.rs"]
mod flash_witness;
#[path = "../support/mod.rs"]
mod support;
