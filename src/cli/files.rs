//! The command-line arguments without a flag: songs and at most one scene.

use std::ffi::OsStr;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};

use crate::config::Folders;
use crate::demo_track::DEMO_TRACK;
use crate::export::output::STANDARD;
use crate::export::print::print_message;
use crate::limits;
use crate::scenes::{SceneError, SceneSource, import_shader, is_scene_file, is_shader_file};
use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_player::song::Song;

pub(super) struct Files {
    /// Songs, folders and playlists.
    pub(super) songs: Vec<PathBuf>,
    /// A scene or a shader.
    pub(super) scene: Option<PathBuf>,
}

impl Files {
    pub(super) fn of(files: Vec<PathBuf>) -> anyhow::Result<Self> {
        let (scenes, songs): (Vec<_>, Vec<_>) =
            files.into_iter().partition(|file| is_scene_file(file) || is_shader_file(file));
        if let [first, second, ..] = &scenes[..] {
            bail!("two scenes were given, {} and {}: give one of them", first.display(), second.display());
        }
        Ok(Self { songs, scene: scenes.into_iter().next() })
    }

    /// Makes a scene of a shader, in the folder of the user's scenes.
    pub(super) fn with_imported_shader(self, folders: &Folders) -> anyhow::Result<Self> {
        let Some(shader) = self.scene.as_ref().filter(|scene| is_shader_file(scene)) else { return Ok(self) };
        let folder = folders.own_scenes();
        let folder = folder.ok_or_else(|| SceneError::Shader(shader.clone()))?;
        let imported = import_shader(shader, &folder)?;
        print_message(&format!("imported as {}", imported.scene.display()));
        imported.notes.iter().for_each(|note| print_message(note));
        Ok(Self { scene: Some(imported.scene), ..self })
    }

    pub(super) fn song_and_scene(self) -> anyhow::Result<(Song, Option<PathBuf>)> {
        if let [first, second, ..] = &self.songs[..] {
            bail!("two songs are named, {} and {}: give one of them", first.display(), second.display());
        }
        Ok((song_or_demo(self.songs.into_iter().next())?, self.scene))
    }
}

pub(super) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// Returns the song at the path `file`, without opening it; the demo track if `file` is `None`.
pub(super) fn song_or_demo(file: Option<PathBuf>) -> anyhow::Result<Song> {
    match file {
        None => Ok(DEMO_TRACK),
        Some(file) if is_standard(&file) => song_of_standard_input(),
        Some(file) => Ok(Song::File(file)),
    }
}

/// Reads a song from standard input into memory, because decoders seek in it.
fn song_of_standard_input() -> anyhow::Result<Song> {
    let bytes = standard_input(limits::STANDARD_INPUT_BYTES_MAX, "a song", "mariana analyze - < song.ogg")?;
    // Leak the bytes, once per run: the song is needed until the program ends.
    Ok(Song::Embedded { name: "standard input", bytes: bytes.leak() })
}

/// Returns the scene that `argument` names; for `-`, reads the scene from standard input.
pub(super) fn scene_of(argument: &(impl AsRef<OsStr> + ?Sized)) -> anyhow::Result<SceneSource> {
    if !is_standard(Path::new(argument)) {
        return Ok(SceneSource::find(argument)?);
    }
    let limit = FIELD_LIMITS.scene_bytes_max as u64;
    let bytes = standard_input(limit, "a scene", "mariana check - < my.scene")?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let position = error.utf8_error().valid_up_to();
        anyhow!("the scene on standard input is not text: byte {position} is not UTF-8; send it as UTF-8")
    })?;
    Ok(SceneSource::Formula(text))
}

/// Reads at most `limit` bytes from standard input. Error messages name the expected input `what` and an `example`.
fn standard_input(limit: u64, what: &str, example: &str) -> anyhow::Result<Vec<u8>> {
    let input = std::io::stdin();
    if input.is_terminal() {
        bail!("standard input is a terminal: send {what} to it, such as '{example}'");
    }
    let mut bytes = Vec::new();
    let read = input.lock().take(limit + 1).read_to_end(&mut bytes);
    read.context("standard input cannot be read: name a file")?;
    if bytes.len() as u64 > limit {
        bail!(
            "standard input is larger than {limit} bytes: save the input to a file, and give the file's path"
        );
    }
    Ok(bytes)
}
