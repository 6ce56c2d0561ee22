//! The song inside the program, for users who name none.

use std::path::PathBuf;

use mariana_player::song::Song;

/// "Hadal Lanterns", composed by this project.
pub const DEMO_TRACK: Song = Song::Embedded { name: "demo.ogg", bytes: include_bytes!("../assets/demo.ogg") };

/// The file at `path`, or the demo track if there is none.
pub fn song_or_demo(path: Option<PathBuf>) -> Song {
    path.map_or(DEMO_TRACK, Song::File)
}
