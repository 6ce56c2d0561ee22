//! The window: the only room that uses winit. Its events come in on one thread ([`window_thread`]); the show runs on
//! another ([`show`]).

mod accessibility;
mod announcer;
mod clipboard;
pub mod corner_hands;
mod desk_picture;
mod direction;
mod drawing_pace;
mod dynamic_resolution;
pub mod editor;
mod feeds;
pub mod file_browser;
mod frame_times;
pub mod hands;
pub mod identity;
mod listening;
#[cfg(all(unix, not(target_os = "macos")))]
mod lost_display;
mod masters;
mod media_controls;
pub mod monitors;
mod output;
pub mod overlay;
pub mod pacing;
mod pointer;
mod pointer_rest;
mod probing;
mod recording;
mod reports;
pub mod scene_browser;
pub mod settings_panel;
mod show;
mod sound;
mod stage;
mod text_query;
mod title;
mod translate;
mod typing_times;
mod user_input;
mod wallpaper;
mod window;
mod window_screen;
mod window_thread;

pub use crate::session::SessionError;
pub use show::run;
