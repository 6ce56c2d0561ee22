//! Draws worlds of signed distance functions with OpenGL 3.3: a world, the sound and a size in, a picture out.
//!
//! ```text
//! world, time, sound ─► frame ─► gpu: samples, edges, more samples, light, picture ─► pixels | a window's framebuffer
//! ```
//!
//! [`SceneRenderer`] is the short way in. It draws in any context that is current: that of a window of yours, or one
//! without a window, a [`Headless`]:
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
//! // A moment without sound, and one with a loud bass.
//! scene.draw(0.0, Features::SILENCE, (64, 48))?;
//! let quiet = scene.read();
//! scene.draw(0.0, Features { bass: 1.0, ..Features::SILENCE }, (64, 48))?;
//! let loud = scene.read();
//!
//! // Four bytes per pixel, the top row first.
//! assert_eq!(quiet.len(), 4 * 64 * 48);
//! assert_ne!(quiet, loud, "the ball has grown");
//! # drop(scene);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Frame`] holds everything that one picture shows, as plain numbers. Change it before it is drawn:
//!
//! ```
//! # use mariana_field::world::World;
//! # use mariana_music::Features;
//! use mariana_render::Frame;
//!
//! let world = World::parse("ball", "sphere(p, 1)")?;
//! let mut frame = Frame::new(&world, 2.5, Features::SILENCE, (640, 360));
//! // Fewer details where a window cannot afford them; stills keep the best.
//! frame.quality = 0.5;
//! # Ok::<(), mariana_field::world::WorldError>(())
//! ```
//!
//! `examples/one_picture.rs` draws a text to a file, `examples/in_your_window.rs` draws it into a window of its own.
//! To draw several scenes, to compile them on other threads ([`gpu::background`]), to keep what drivers made of them
//! ([`gpu::program_store`]) and to draw in parts between two events, begin with [`Renderer`].

pub mod faults;
pub mod flash;
pub mod frame;
pub mod gpu;
pub mod limits;
pub mod placement;
pub mod reading_order;
mod scene_renderer;
pub mod srgb;
pub mod system_fonts;
pub mod view;

pub use frame::Frame;
pub use gpu::error::GpuError;
pub use gpu::gl::Gl;
pub use gpu::headless::Headless;
pub use gpu::renderer::Renderer;
pub use scene_renderer::SceneRenderer;
