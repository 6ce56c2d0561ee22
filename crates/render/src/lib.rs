//! Draws scenes of signed distance functions with OpenGL 3.3 or OpenGL ES 3.0: takes a world, the sound and a size, and returns an
//! image.
//!
//! ```text
//! world, time, sound ─► frame ─► gpu: samples, edges, more samples, light, image ─► pixels | a window's framebuffer
//! ```
//!
//! [`SceneRenderer`] is the simplest way to draw. It uses the current OpenGL context: your window's context, or a
//! [`Headless`] context.
//!
//! ```
//! use mariana_field::world::World;
//! use mariana_music::Features;
//! use mariana_render::{Headless, SceneRenderer};
//!
//! let world = World::parse("ball", "sphere(p, 0.5 + 0.5 * bass)")?;
//! let context = Headless::new(false)?;
//! let mut scene = SceneRenderer::new(context.gl(), world)?;
//!
//! // Silence, then a loud bass.
//! scene.draw(0.0, Features::SILENCE, (64, 48))?;
//! let quiet = scene.read();
//! scene.draw(0.0, Features { bass: 1.0, ..Features::SILENCE }, (64, 48))?;
//! let loud = scene.read();
//!
//! // Four bytes per pixel, the top row first.
//! assert_eq!(quiet.len(), 4 * 64 * 48);
//! assert_ne!(quiet, loud, "the ball grows with the bass");
//! # drop(scene);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Frame`] holds all inputs of one image as plain numbers. Change it before you draw it:
//!
//! ```
//! # use mariana_field::world::World;
//! # use mariana_music::Features;
//! use mariana_render::Frame;
//!
//! let world = World::parse("ball", "sphere(p, 1)")?;
//! let mut frame = Frame::new(&world, 2.5, Features::SILENCE, (640, 360));
//! // Less detail, for a window on a slow GPU.
//! frame.quality = 0.5;
//! # Ok::<(), mariana_field::world::WorldError>(())
//! ```
//!
//! `examples/one_picture.rs` draws a scene to a file, and `examples/in_your_window.rs` draws into a window.
//! [`Renderer`] draws several scenes and splits expensive frames into parts. [`gpu::background`] compiles on worker
//! threads, and [`gpu::program_store`] stores compiled programs on disk.

pub mod faults;
pub mod flash;
pub mod frame;
pub mod gpu;
pub mod limits;
pub mod placement;
pub mod ray_diagram;
pub mod reading_order;
mod scene_renderer;
pub mod srgb;
pub mod system_fonts;
pub mod view;

pub use frame::Frame;
pub use gpu::error::GpuError;
pub use gpu::gl::Gl;
#[cfg(not(target_family = "wasm"))]
pub use gpu::headless::Headless;
pub use gpu::renderer::Renderer;
pub use scene_renderer::SceneRenderer;
