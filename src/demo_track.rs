//! The song inside the program, for users who name none.

use mariana_player::song::Song;

/// The name that a file of it would have.
const NAME: &str = "demo.ogg";

/// "Hadal Lanterns", composed by this project.
pub const DEMO_TRACK: Song = Song::Embedded { name: NAME, bytes: include_bytes!("../assets/demo.ogg") };

/// Whether a song is the one inside the program.
pub fn is_demo(song: &Song) -> bool {
    matches!(song, Song::Embedded { name: NAME, .. })
}
