//! What is wrong with lists of tracks. Every message is one sentence: what, where, what to do.

use std::path::{Path, PathBuf};

use crate::decode::DecodeError;

/// Why a list, or a part of one, cannot be played.
///
/// A malformed list is [`NotAList`](Self::NotAList), [`Empty`](Self::Empty) or [`Circular`](Self::Circular), an
/// unsupported one [`Stream`](Self::Stream) or [`Address`](Self::Address), and the ones past a ceiling of
/// [`crate::limits`] are [`TooLarge`](Self::TooLarge), [`TooMany`](Self::TooMany) and [`TooDeep`](Self::TooDeep).
#[derive(Debug, thiserror::Error)]
pub enum PlaylistError {
    /// A list or a folder cannot be read.
    #[error("{} cannot be read ({source}); check its permissions and the disk", .path.display())]
    Unreadable {
        /// Its path.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The path of a list leads to a pipe, a socket or a device.
    #[error("{} is not a regular file; save the list to a file first", .path.display())]
    NotAFile {
        /// Its path.
        path: PathBuf,
    },
    /// The bytes are not a list.
    #[error("{name} is not a playlist: {what}; export it again as m3u, m3u8, pls or cue")]
    NotAList {
        /// The list's name.
        name: String,
        /// What was seen instead.
        what: String,
    },
    /// The list or folder is empty.
    #[error("{name} holds no tracks; choose files, or a folder or list that has some")]
    Empty {
        /// The list's or folder's name.
        name: String,
    },
    /// The list names the pieces of a stream.
    #[error(
        "{name} is the list of a network stream (HLS), which is not supported; save the stream to a file first"
    )]
    Stream {
        /// The list's name.
        name: String,
    },
    /// An entry is a network address.
    #[error("{address} in {list} is a network address, which is not supported; download it to a file first")]
    Address {
        /// The address.
        address: String,
        /// The name of the list that has it.
        list: String,
    },
    /// A list contains itself, perhaps by way of others.
    #[error("{name} contains itself, and that entry is left out; correct the list that names it")]
    Circular {
        /// The list's name.
        name: String,
    },
    /// A list has more bytes than allowed.
    #[error("{name} is too large for a list (more than {limit} bytes); split it")]
    TooLarge {
        /// The list's name.
        name: String,
        /// The limit.
        limit: u64,
    },
    /// There is more of something than allowed.
    #[error("there are more than {limit} {what}; the rest are left out: open fewer at a time")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// Lists within lists, or folders within folders, are nested deeper than the limit.
    #[error("{name} is nested more than {limit} levels deep and is left out; open it directly")]
    TooDeep {
        /// The name of the list or folder.
        name: String,
        /// The limit.
        limit: usize,
    },
    /// None of the tracks can be played.
    #[error("none of the {count} tracks can be played; check their paths; the last error was: {last}")]
    NothingPlayable {
        /// How many tracks there are.
        count: usize,
        /// The message of the last one.
        last: String,
    },
    /// The only track cannot be played.
    #[error(transparent)]
    Track(#[from] DecodeError),
}

/// The name of a file without its folders, on one line.
pub(super) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    crate::one_line::one_line(&name.to_string_lossy())
}
