//! The state of a session's music lists that lasts while the lists are closed.

use std::path::PathBuf;

use super::waker::Waker;
use crate::config::Folders;
use mariana_player::tags::TagLibrary;

/// The name of the cache file of tags.
const TAGS: &str = "tags.jsonl";

pub(super) struct MusicLists {
    pub(super) tags: TagLibrary,
    /// The folder of the files that were opened last.
    pub(super) last_folder: Option<PathBuf>,
}

impl MusicLists {
    /// Starts the thread that reads tags. Without the thread, lists show the names of files.
    pub(super) fn start(folders: &Folders, waker: &Waker) -> Self {
        let cache = folders.cache.as_ref().map(|cache| cache.join(TAGS));
        let tags = TagLibrary::start(cache, waker.waking()).unwrap_or_else(|error| {
            tracing::warn!("cannot read the tags of tracks ahead: {error}");
            TagLibrary::default()
        });
        Self { tags, last_folder: None }
    }
}
