//! Errors of track lists. Each message is one sentence: what happened, where, and what to do.

use std::path::{Path, PathBuf};

use crate::decode::DecodeError;

/// The errors that prevent playback of a list or a part of one.
#[derive(Debug, thiserror::Error)]
pub enum PlaylistError {
    /// A list or a folder cannot be read.
    #[error("{} cannot be read ({source}); check its permissions and the disk", .path.display())]
    Unreadable {
        /// The path of the list or folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The path of a list leads to a pipe, a socket or a device.
    #[error("{} is not a regular file; save the list to a file first", .0.display())]
    NotAFile(PathBuf),
    /// The file's content is not a list.
    #[error("{name} is not a playlist: {what}; export it again as m3u, m3u8, pls or cue")]
    NotAList {
        /// The list's name.
        name: String,
        /// A description of the content.
        what: String,
    },
    /// The list or folder is empty.
    #[error("{0} holds no tracks; choose files, or a folder or list with tracks")]
    Empty(String),
    /// The list describes the segments of a network stream.
    #[error(
        "{0} is the list of a network stream (HLS), which is not supported; save the stream to a file first"
    )]
    Stream(String),
    /// An entry is a network address.
    #[error("{address} in {list} is a network address, which is not supported; download it to a file first")]
    Address {
        /// The address.
        address: String,
        /// The name of the list that contains the address.
        list: String,
    },
    /// A list contains itself, directly or through other lists.
    #[error("{0} contains itself, so this entry was left out; remove the entry")]
    Circular(String),
    /// A list is larger than the limit.
    #[error("{name} is too large for a list (more than {limit} bytes); split the list")]
    TooLarge {
        /// The list's name.
        name: String,
        /// The limit, in bytes.
        limit: usize,
    },
    /// A number of items exceeds the limit.
    #[error("there are more than {limit} {what}, so the rest was left out; open fewer at once")]
    TooMany {
        /// The name of the items.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// Lists within lists, or folders within folders, are nested deeper than the limit.
    #[error("{name} is nested more than {limit} levels deep, so it was left out; open {name} directly")]
    TooDeep {
        /// The name of the list or folder.
        name: String,
        /// The limit.
        limit: usize,
    },
    /// All tracks are unplayable.
    #[error("none of the {count} tracks can be played; check their paths; the last error was: {last}")]
    NothingPlayable {
        /// The number of tracks.
        count: usize,
        /// The last track's error message.
        last: String,
    },
    /// The only track cannot be played.
    #[error(transparent)]
    Track(#[from] DecodeError),
}

pub(super) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    crate::one_line::one_line(&name.to_string_lossy())
}
