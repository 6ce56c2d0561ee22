//! `mariana show`: writes the director's show for a song to a file that can be edited.

use super::error::ExportError;
use super::output::{Output, refuse_the_song, refuse_to_replace, write_standard};
use super::structure::{structure_of, summary};
use crate::atomic_file::AtomicFile;
use crate::scenes::SceneSource;
use crate::show::{PreparedShow, ShowSource};
use mariana_player::song::Song;

/// Writes the director's show of a song with some of these scenes, and returns the number of its entries.
///
/// # Errors
/// Fails if the song cannot be decoded, no scene can be shown, or the output cannot be written.
pub fn write_show_file(song: &Song, scenes: &[SceneSource], output: &Output) -> Result<usize, ExportError> {
    let file = match output {
        Output::Path(path) => {
            refuse_the_song(song, path)?;
            refuse_to_replace(path, None)?;
            Some(AtomicFile::create(path)?)
        }
        Output::Standard => None,
    };
    let (name, structure) = structure_of(song)?;
    let (prepared_show, _) = PreparedShow::of_song(&ShowSource::Auto, &structure, scenes)?;
    let comments = [
        format!("A show for {name}: {}", summary(&structure)),
        "at WHEN SCENE [camera NAME] [cut | fade, melt or portal over LENGTH]; set PARAMETER = A -> B over LENGTH".to_owned(),
    ];
    let text = prepared_show.text(&comments);
    match file {
        Some(file) => file.write(text.as_bytes())?,
        None => write_standard(text.as_bytes()).map(drop)?,
    }
    Ok(prepared_show.clips().len())
}
