//! The window and the desktop: the only room that uses winit. The window's events come in on one thread
//! ([`window_thread`]); the session runs on another ([`show`]), on a [`window_screen`]. They talk by [`messages`].

mod accessibility;
pub mod identity;
#[cfg(all(unix, not(target_os = "macos")))]
mod lost_display;
mod media_controls;
mod messages;
pub mod monitors;
mod output;
mod shared_window;
mod show;
mod translate;
mod wallpaper;
mod window;
mod window_screen;
mod window_thread;

pub use show::run;
