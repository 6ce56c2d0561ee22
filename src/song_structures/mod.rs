//! What is known of whole songs: their structures ([`SongStructure`]), computed by decoding the songs and cached on
//! disk, and their lyrics.
//!
//! A song with a decoding error has the structure of the part before the error. A song that cannot be opened has no
//! structure: scenes read 0 for all its values. Errors are only logged, because the player reports them.

mod reader;

use std::sync::Arc;

use crate::cached_files::{CachedFiles, FileKey};
use crate::config::Folders;
use crate::limits;
use mariana_music::{STRUCTURE_VERSION, SongListener, SongMoment, SongStructure};
use mariana_player::lyrics::{Lyrics, LyricsError};
use mariana_player::song::Song;
use mariana_player::source::FrameSource;
use mariana_player::track::Content;

pub use reader::SongReader;

/// Returns the cache of structures in the cache folder of `folders`, if there is one. Its files contain JSON.
pub fn structure_cache(folders: &Folders) -> CachedFiles {
    let folder = folders.cache.as_ref().map(|cache| cache.join("songs"));
    let (bytes_max, kept_max) = (limits::STRUCTURE_BYTES_MAX, limits::STRUCTURES_KEPT_MAX);
    CachedFiles { folder, ending: "song", bytes_max, kept_max }
}

/// Returns the key of a song's bytes, the played part and the version of the analysis ([`CachedFiles::key`]).
fn key_of(content: &Content, cache: &CachedFiles, go_on: &dyn Fn() -> bool) -> Option<FileKey> {
    let about = (STRUCTURE_VERSION, content.cut.map(|cut| (cut.start, cut.end)));
    cache.key(about, [&content.song], go_on)
}

/// Returns the structure of a song, from the cache or by decoding the song now.
pub fn structure_of(song: &Song, cache: &CachedFiles) -> SongStructure {
    let content = Content { song: song.clone(), cut: None };
    find(&content, cache, &|| true).flatten().unwrap_or_default()
}

/// What is known of a whole song.
#[derive(Debug, Default, PartialEq)]
pub struct ReadSong {
    /// The song's structure.
    pub structure: Arc<SongStructure>,
    /// The song's lyrics; without lines if it has none.
    pub lyrics: Arc<Lyrics>,
}

impl ReadSong {
    /// Returns the place of `time` seconds in the song and in its lyrics.
    pub fn moment(&self, time: f64) -> SongMoment {
        let mut moment = self.structure.moment(time);
        self.lyrics.mark(time, &mut moment);
        moment
    }
}

/// Returns the lyrics of a song. Most songs have none; lyrics that cannot be read are only logged.
pub fn lyrics_of(song: &Song) -> Lyrics {
    Lyrics::of_song(song).unwrap_or_else(|error| {
        if !matches!(error, LyricsError::None { .. }) {
            tracing::info!("a song has no lyrics: {error}");
        }
        Lyrics::default()
    })
}

/// Returns the structure of `content`, from the cache if it is there. The inner `None` means that the content cannot be
/// opened; the outer `None` means that `go_on` returned false.
fn find(content: &Content, cache: &CachedFiles, go_on: &dyn Fn() -> bool) -> Option<Option<SongStructure>> {
    let key = key_of(content, cache, go_on);
    if let Some(kept) = key.and_then(|key| cache.load(key, |text| serde_json::from_slice(text).ok())) {
        return Some(Some(kept));
    }
    if !go_on() {
        return None;
    }
    let mut source = match content.open() {
        Ok(source) => source,
        Err(error) => {
            tracing::info!("a song cannot be analysed: {error}");
            return Some(None);
        }
    };
    let structure = listen(&mut *source, go_on)?;
    // After an error, the next run analyses the song again.
    if let Some((key, text)) = key.zip(serde_json::to_vec(&structure).ok()) {
        cache.save(key, &text);
    }
    Some(Some(structure))
}

/// Analyses a source up to its end or an error. Returns `None` if `go_on` returns false.
fn listen(source: &mut dyn FrameSource, go_on: &dyn Fn() -> bool) -> Option<SongStructure> {
    let mut listener = SongListener::new(source.sample_rate());
    let mut block = Vec::new();
    while go_on() {
        block.clear();
        match source.next_block(&mut block) {
            Ok(1..) => listener.push(&block),
            Ok(0) => return Some(listener.finish()),
            Err(error) => {
                tracing::info!("the structure of a song ends at a decoding error: {error}");
                return Some(listener.finish());
            }
        }
    }
    None
}

#[cfg(test)]
mod tests;
