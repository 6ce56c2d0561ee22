//! The program on the command line, and the files that it reads.

mod cli;
mod cli_bad_input;
mod editors;
mod installing;
mod interrupted;
mod meshes;
mod moving_textures;
mod outputs;
mod packages;
mod pages;
mod paths;
mod playlists;
mod scene_commands;
mod scene_reload;
mod scene_textures;
mod setting_up;
mod shows;
mod song_numbers;
mod standard_streams;
mod stems;
mod video_parts;
mod videos;

#[path = "../support/mod.rs"]
mod support;
