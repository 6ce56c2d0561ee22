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
    /// The bytes are no list.
    #[error("{name} is not a playlist: {what}; export it again as m3u, m3u8, pls or cue")]
    NotAList {
        /// The list's name.
        name: String,
        /// What was seen instead.
        what: String,
    },
    /// There is nothing in it.
    #[error("{name} holds no tracks; name files, or a folder or a list that has some")]
    Empty {
        /// The list's or folder's name.
        name: String,
    },
    /// It is the list of a stream's pieces.
    #[error(
        "{name} is the list of a network stream (HLS), which is not supported; save the stream to a file first"
    )]
    Stream {
        /// The list's name.
        name: String,
    },
    /// An entry is an address on a network.
    #[error("{address} in {list} is an address, which is not supported; save what is there to a file first")]
    Address {
        /// The address.
        address: String,
        /// The name of the list that has it.
        list: String,
    },
    /// A list that contains itself, maybe by way of others.
    #[error("{name} contains itself, which is left out; correct the list that names it")]
    Circular {
        /// The list's name.
        name: String,
    },
    /// A list of more bytes than allowed.
    #[error("{name} is larger than a list may be ({limit} bytes); split it")]
    TooLarge {
        /// The list's name.
        name: String,
        /// The limit.
        limit: u64,
    },
    /// More of something than allowed.
    #[error("there are more than {limit} {what}; the others are left out: give fewer at a time")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// Lists in lists, or folders in folders, beyond the limit.
    #[error("{name} lies deeper than {limit} levels and is left out; name it directly")]
    TooDeep {
        /// The name of the list or folder.
        name: String,
        /// The limit.
        limit: usize,
    },
    /// None of the tracks can be played.
    #[error("none of the {count} tracks can be played; check their paths, the last one says: {last}")]
    NothingPlayable {
        /// How many there are.
        count: usize,
        /// What the last one said.
        last: String,
    },
    /// The only track cannot be played.
    #[error(transparent)]
    Track(#[from] DecodeError),
}

/// The name of a file without its folders, on one line.
pub(super) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    crate::song::one_line(&name.to_string_lossy())
}
