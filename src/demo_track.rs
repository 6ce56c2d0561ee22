//! The built-in song, played if the user names none.

use mariana_player::song::Song;

const NAME: &str = "demo.ogg";

/// "Hadal Lanterns", composed by this project.
pub const DEMO_TRACK: Song = Song::Embedded { name: NAME, bytes: mariana_assets::DEMO_TRACK };

/// True if the song is the built-in one.
pub fn is_demo(song: &Song) -> bool {
    matches!(song, Song::Embedded { name: NAME, .. })
}
