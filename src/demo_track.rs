//! The song inside the program, for users who name none.

use mariana_player::song::Song;

/// "Hadal Lanterns", composed by this project.
pub const DEMO_TRACK: Song = Song::Embedded { name: "demo.ogg", bytes: include_bytes!("../assets/demo.ogg") };
