//! The window and the desktop, and the only module that uses winit. [`window_thread`] receives the window's events; the
//! session runs on a second thread ([`show`]) and draws on a [`window_screen`]. [`messages`] connect the two.

#[cfg(windows)]
mod console;
pub mod identity;
mod idle;
#[cfg(all(unix, not(target_os = "macos")))]
mod lost_display;
mod media_controls;
pub(crate) use media_controls::hand_over;
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
