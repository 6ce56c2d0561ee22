//! The program in a real window, on a private X server or on a Wayland compositor.

mod hostile;
mod key_storm;
mod playlist_window;
mod stay_awake;
mod walls;
mod window;
mod window_answers;
mod window_assisted;
mod window_grounds;
mod window_outputs;
mod window_settings;

#[path = "../support/mod.rs"]
mod support;
