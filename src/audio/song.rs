//! What is played: a file of the user's, or the built-in demo track.

use std::path::{Path, PathBuf};

use super::decode::{DecodeError, Decoder};

/// "Hadal Lanterns", made by `examples/compose_demo`.
static DEMO_TRACK: &[u8] = include_bytes!("../../assets/demo.ogg");

/// A song that can be opened any number of times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Song {
    /// The demo track inside the program.
    Demo,
    /// A file.
    File(PathBuf),
}

impl Song {
    /// The file at `path`, or the demo track if there is none.
    pub fn from_argument(path: Option<&Path>) -> Self {
        path.map_or(Song::Demo, |path| Song::File(path.to_owned()))
    }

    /// Opens it for decoding from its start.
    ///
    /// # Errors
    /// What [`Decoder::open`] says about the file.
    pub fn open(&self) -> Result<Decoder, DecodeError> {
        match self {
            Song::Demo => Decoder::from_bytes("demo.ogg", DEMO_TRACK),
            Song::File(path) => Decoder::open(path),
        }
    }

    /// The encoded demo track, for a program that wants a file of its own; none for a file.
    pub fn embedded_bytes(&self) -> Option<&'static [u8]> {
        match self {
            Song::Demo => Some(DEMO_TRACK),
            Song::File(_) => None,
        }
    }
}

/// What a song is called: artist and title where the file tells them, else the file's name.
pub fn display_name(decoder: &Decoder) -> String {
    let info = decoder.info();
    track_name(info.artist.as_deref(), info.title.as_deref(), &info.name)
}

/// What to call a track of that artist and title in a file of that name.
pub(super) fn track_name(artist: Option<&str>, title: Option<&str>, file: &str) -> String {
    let tag = |tag: Option<&str>| tag.map(one_line).filter(|tag| !tag.is_empty());
    match (tag(artist), tag(title)) {
        (Some(artist), Some(title)) => format!("{artist} - {title}"),
        (None, Some(title)) => title,
        _ => one_line(file),
    }
}

/// The text without control characters, which files may hold: a title with a NUL stops window systems.
pub(super) fn one_line(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn a_nul_or_an_escape_in_a_tag_reaches_no_title() {
        assert_eq!(one_line("AAA\0BBBB"), "AAA BBBB");
        assert_eq!(one_line(" \u{1b}[31mred\r\nline "), "[31mred line");
        assert_eq!(one_line("\0\n"), "");
    }
}
