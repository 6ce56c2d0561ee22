//! A show without a window: scenes are prepared and composed into pictures here. It knows no window system and reads
//! no keys; whoever drives it hands in an OpenGL context, the moment of the song, and what users ask for.

pub(crate) mod desktop;
mod error;
pub(crate) mod lay;
pub mod monitor;
pub(crate) mod scene;
pub(crate) mod screen;
pub mod waker;

pub use error::SessionError;
