//! The program in a real window, under an X server of the test's own.

mod hostile;
mod key_storm;
mod playlist_window;
mod walls;
mod window;
mod window_assisted;
mod window_changes;
mod window_grounds;
mod window_outputs;
mod window_programs;
mod window_quality;
mod window_scenes;
mod window_settings;
mod window_views;

#[path = "../support/mod.rs"]
mod support;
