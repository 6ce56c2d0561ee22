//! What whole songs are made of ([`SongStructure`]), found by decoding them, and kept from run to run.
//!
//! A song that breaks off has the structure of what comes before that, and one that cannot be decoded at all has none:
//! scenes then read 0. Neither is worth more than a sentence in the log, because whoever plays the song tells what is
//! wrong with it.

mod cache;
mod reader;

use mariana_music::{SongListener, SongStructure};
use mariana_player::song::Song;
use mariana_player::source::{FrameSource, SourceError};
use mariana_player::track::Content;

pub use cache::StructureCache;
pub use reader::SongReader;

/// The structure of a song, at once: the one that is kept, or a new one.
pub fn structure_of(song: &Song, cache: &StructureCache) -> SongStructure {
    let open =
        || Some(song.open().map(|decoder| Box::new(decoder) as Box<dyn FrameSource>).map_err(Into::into));
    let content = Content { song: song.clone(), cut: None };
    find(Some(&content), open, cache, &|| true).flatten().unwrap_or_default()
}

/// The kept structure of `content`, or that of the source that `open` gives; none of what cannot be opened. None at
/// all once `go_on` says so.
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
            tracing::info!("the structure of a song is not known: {error}");
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

/// Listens to a source to its end, or to where it breaks off. None once `go_on` says so.
fn listen(source: &mut dyn FrameSource, go_on: &dyn Fn() -> bool) -> Option<SongStructure> {
    let mut listener = SongListener::new(source.sample_rate());
    let mut block = Vec::new();
    while go_on() {
        block.clear();
        match source.next_block(&mut block) {
            Ok(1..) => listener.push(&block),
            Ok(0) => return Some(listener.finish()),
            Err(error) => {
                tracing::info!("the structure of a song is that of its beginning: {error}");
                return Some(listener.finish());
            }
        }
    }
    None
}

#[cfg(test)]
mod tests;
