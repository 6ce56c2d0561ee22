//! Structures of whole songs ([`SongStructure`]), computed by decoding the songs, and cached on disk.
//!
//! A song with a decoding error has the structure of the part before the error. A song that cannot be opened has no
//! structure: scenes read 0 for all its values. Errors are only logged, because the player reports them.

mod cache;
mod cached_files;
mod reader;

use mariana_music::{SongListener, SongStructure};
use mariana_player::song::Song;
use mariana_player::source::{FrameSource, SourceError};
use mariana_player::track::Content;

pub use cache::StructureCache;
pub use cached_files::{CachedFiles, FileKey};
pub use reader::SongReader;

/// Returns the structure of a song, from the cache or by decoding the song now.
pub fn structure_of(song: &Song, cache: &StructureCache) -> SongStructure {
    let open =
        || Some(song.open().map(|decoder| Box::new(decoder) as Box<dyn FrameSource>).map_err(Into::into));
    let content = Content { song: song.clone(), cut: None };
    find(Some(&content), open, cache, &|| true).flatten().unwrap_or_default()
}

/// Returns the structure of `content` from the cache, or of the source that `open` returns. The inner `None` means
/// that the source cannot be opened; the outer `None` means that `go_on` returned false.
fn find(
    content: Option<&Content>,
    open: impl FnOnce() -> Option<Result<Box<dyn FrameSource>, SourceError>>,
    cache: &StructureCache,
    go_on: &dyn Fn() -> bool,
) -> Option<Option<SongStructure>> {
    let key = content.and_then(|content| cache.key(content, go_on));
    if let Some(kept) = key.and_then(|key| cache.load(key)) {
        return Some(Some(kept));
    }
    if !go_on() {
        return None;
    }
    let mut source = match open() {
        Some(Ok(source)) => source,
        Some(Err(error)) => {
            tracing::info!("a song cannot be analysed: {error}");
            return Some(None);
        }
        None => return Some(None),
    };
    let structure = listen(&mut *source, go_on)?;
    if let Some(key) = key {
        cache.save(key, &structure);
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
