//! The files that stand on the command line without a flag: songs and a scene.

use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::demo_track::DEMO_TRACK;
use crate::export::output::STANDARD;
use crate::limits::LIMITS;
use crate::scenes::is_scene_file;
use mariana_player::song::Song;

/// Files by what they are.
pub(super) struct Files {
    /// Songs, and what leads to songs.
    pub(super) songs: Vec<PathBuf>,
    /// The scene.
    pub(super) scene: Option<PathBuf>,
}

impl Files {
    /// Tells scenes, by their ending, from songs.
    pub(super) fn of(files: Vec<PathBuf>) -> anyhow::Result<Self> {
        let (scenes, songs): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| is_scene_file(file));
        if let [first, second, ..] = &scenes[..] {
            bail!("two scenes are named, {} and {}: give one of them", first.display(), second.display());
        }
        Ok(Self { songs, scene: scenes.into_iter().next() })
    }

    /// The song, or the demo track; and the scene. For what is made of one song.
    pub(super) fn song_and_scene(self) -> anyhow::Result<(Song, Option<PathBuf>)> {
        if let [first, second, ..] = &self.songs[..] {
            bail!("two songs are named, {} and {}: give one of them", first.display(), second.display());
        }
        Ok((song_or_demo(self.songs.into_iter().next())?, self.scene))
    }
}

/// Whether a name stands for standard input.
pub(super) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// The song of that name, or the demo track if there is none.
pub(super) fn song_or_demo(file: Option<PathBuf>) -> anyhow::Result<Song> {
    match file {
        None => Ok(DEMO_TRACK),
        Some(file) if is_standard(&file) => song_of_standard_input(),
        Some(file) => Ok(Song::File(file)),
    }
}

/// Reads standard input to its end, which has to be kept: decoders jump back and forth.
fn song_of_standard_input() -> anyhow::Result<Song> {
    let input = std::io::stdin();
    if input.is_terminal() {
        bail!("standard input is a terminal: send a song to it, such as 'mariana analyze - < song.ogg'");
    }
    let limit = LIMITS.standard_input_bytes_max;
    let mut bytes = Vec::new();
    input
        .lock()
        .take(limit + 1)
        .read_to_end(&mut bytes)
        .context("standard input cannot be read: name a file")?;
    if bytes.len() as u64 > limit {
        bail!("standard input is larger than {limit} bytes: save it to a file, and name that");
    }
    // It is read once, and needed until the program ends.
    Ok(Song::Embedded { name: "standard input", bytes: bytes.leak() })
}
