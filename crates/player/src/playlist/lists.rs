//! Parsers for the formats of playlist files.
//! - M3U and M3U8: a path on each line; lines that begin with `#` are comments or directives of other programs. A
//!   line `#EXTINF:seconds,title` describes the next path.
//! - PLS: `FileN=path` under `[playlist]`, ordered by the number.
//! - CUE: tracks within files, each from one index to the next; see [`cue`].

use std::path::Path;

use super::cue::{self, DISC_FRAMES};
use super::error::{PlaylistError, name_of};
use super::text::{Lines, Reference};
use crate::decode::TrackTags;
use crate::limits;

/// A part of a file, in compact disc frames (75 per second).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// The first frame.
    pub start: u64,
    /// The end of the part (exclusive). `None` is the end of the file.
    pub end: Option<u64>,
}

impl Cut {
    /// Start and end in seconds; the end of the file is infinite.
    pub fn seconds(self) -> (f64, f64) {
        let seconds = |disc: u64| disc as f64 / DISC_FRAMES as f64;
        (seconds(self.start), self.end.map_or(f64::INFINITY, seconds))
    }
}

/// An item of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// The path or address.
    pub reference: Reference,
    /// The part of the file to play; `None` for the whole file.
    pub cut: Option<Cut>,
    /// What the list says about the track.
    pub tags: TrackTags,
}

impl Item {
    fn whole(reference: Reference) -> Self {
        Self { reference, cut: None, tags: TrackTags::default() }
    }
}

/// The kinds of lists. They are recognised by file extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// M3U or M3U8 in any encoding.
    M3u,
    /// PLS.
    Pls,
    /// A cue sheet.
    Cue,
}

impl Kind {
    /// Returns the kind of the list at `path` by its extension; `None` if the extension belongs to no kind.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "m3u" | "m3u8" => Some(Self::M3u),
            "pls" => Some(Self::Pls),
            "cue" => Some(Self::Cue),
            _ => None,
        }
    }

    /// Parses the bytes of the list at `path`.
    ///
    /// # Errors
    /// Fails if the bytes are not a list, or if the list is empty or of an unsupported kind.
    pub fn read(self, path: &Path, bytes: &[u8]) -> Result<Vec<Item>, PlaylistError> {
        let name = || name_of(path);
        let malformed = |what: &str| {
            let remedy = "export it again as m3u, m3u8, pls or cue";
            PlaylistError(format!("{} is not a playlist: {what}; {remedy}", name()))
        };
        let text = Lines::of(bytes).ok_or_else(|| malformed("it is not text"))?;
        let base = path.parent().unwrap_or(Path::new(""));
        let items = match self {
            Self::M3u if text.lines.iter().any(|line| line.starts_with(b"#EXT-X-")) => {
                return Err(PlaylistError(format!(
                    "{} is the list of a network stream (HLS), which is not supported; save the stream to a file first",
                    name()
                )));
            }
            Self::M3u => m3u(base, &text),
            Self::Pls => pls(base, &text).ok_or_else(|| malformed("it has no line '[playlist]'"))?,
            Self::Cue => cue::read(base, &text).ok_or_else(|| malformed("it has no line 'FILE'"))?,
        };
        if items.is_empty() { Err(PlaylistError::empty(&name())) } else { Ok(items) }
    }
}

fn m3u(base: &Path, text: &Lines) -> Vec<Item> {
    let mut items = Vec::new();
    let mut reported = None;
    for line in &text.lines {
        if let Some(about) = line.strip_prefix(b"#EXTINF:") {
            reported = Some(text.decode(about));
        } else if !line.starts_with(b"#") {
            let mut item = Item::whole(text.resolve(base, line));
            if let Some((seconds, title)) =
                reported.take().as_deref().and_then(|reported| reported.split_once(','))
            {
                // Some programs write attributes after the seconds.
                let seconds =
                    seconds.split_whitespace().next().and_then(|seconds| seconds.parse::<f64>().ok());
                let believed = |seconds: &f64| *seconds > 0.0 && *seconds <= limits::CLAIMED_DURATION_MAX;
                item.tags.duration = seconds.filter(believed);
                item.tags.title = Some(title.trim().to_owned()).filter(|title| !title.is_empty());
            }
            items.push(item);
        }
    }
    items
}

fn pls(base: &Path, text: &Lines) -> Option<Vec<Item>> {
    if !text.lines.iter().any(|line| line.eq_ignore_ascii_case(b"[playlist]")) {
        return None;
    }
    let mut numbered: Vec<(u64, Item)> =
        text.lines.iter().filter_map(|line| pls_file(base, text, line)).collect();
    // The sort is stable, so entries without a usable number stay in order, at the end.
    numbered.sort_by_key(|(number, _)| *number);
    Some(numbered.into_iter().map(|(_, item)| item).collect())
}

fn pls_file(base: &Path, text: &Lines, line: &[u8]) -> Option<(u64, Item)> {
    let equals = line.iter().position(|byte| *byte == b'=')?;
    let (key, value) = (line.get(..equals)?.trim_ascii(), line.get(equals + 1..)?.trim_ascii());
    let number = key.get(4..).filter(|_| key[..4].eq_ignore_ascii_case(b"file"))?;
    let number = std::str::from_utf8(number).ok().and_then(|digits| digits.parse().ok());
    (!value.is_empty()).then(|| (number.unwrap_or(u64::MAX), Item::whole(text.resolve(base, value))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn paths(name: &str, text: &str) -> Result<Vec<String>, String> {
        let path = Path::new("/m").join(name);
        let items = Kind::of(&path).unwrap().read(&path, text.as_bytes()).map_err(|e| e.to_string())?;
        let shown = |item: Item| match item.reference {
            Reference::Path(path) => path.to_string_lossy().into_owned(),
            Reference::Address(address) => format!("<{address}>"),
        };
        Ok(items.into_iter().map(shown).collect())
    }

    #[test]
    fn lists_name_their_files_in_order() {
        let m3u = "#EXTM3U\r\n#EXTINF:123,Some One - A Song\r\na b.mp3\r\n\r\n../c.ogg\r\nhttp://x/y\r\n";
        assert_eq!(paths("x.m3u", m3u).unwrap(), ["/m/a b.mp3", "/m/../c.ogg", "<http://x/y>"]);
        let pls = "[Playlist]\nFile10=ten.mp3\nfile2=two=2.mp3\nTitle2=Two\nFile99999999999999999999=far.mp3\n\
                   FileX=x.mp3\nFile3=\nLength2=7\nNumberOfEntries=4000000000\nVersion=2\n";
        assert_eq!(paths("x.PLS", pls).unwrap(), ["/m/two=2.mp3", "/m/ten.mp3", "/m/far.mp3", "/m/x.mp3"]);
    }

    #[test]
    fn an_m3u_gives_titles_and_lengths() {
        let text = b"#EXTM3U\n#EXTINF:123,Some One - A Song\n#EXTVLCOPT:x\na.mp3\nb.mp3\n\
                     #EXTINF:-1 tvg-id=\"x\",Radio, live\nc.mp3\n#EXTINF:inf,\nd.mp3\n#EXTINF:5\ne.mp3\n";
        let items = Kind::M3u.read(Path::new("/m/x.m3u"), text).unwrap();
        let reported: Vec<_> =
            items.iter().map(|item| (item.tags.title.as_deref(), item.tags.duration)).collect();
        let song = (Some("Some One - A Song"), Some(123.0));
        assert_eq!(reported, [song, (None, None), (Some("Radio, live"), None), (None, None), (None, None)]);
    }

    #[test]
    fn malformed_empty_and_unsupported_lists_are_distinguished() {
        for (name, text, part) in [
            ("x.m3u", "a\0b", "not a playlist"),
            ("x.m3u8", "#EXTM3U\n", "holds no tracks"),
            ("x.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:10\nsegment1.ts\n", "HLS"),
            ("x.pls", "File1=a.mp3", "[playlist]"),
            ("x.pls", "[playlist]\nNumberOfEntries=3\n", "holds no tracks"),
            ("x.cue", "TITLE \"x\"\n", "FILE"),
        ] {
            let error = paths(name, text).unwrap_err();
            assert!(error.contains(part) && error.contains(name), "{error}");
        }
        assert_eq!(Kind::of(Path::new("a/song.flac")), None);
        assert_eq!(Kind::of(Path::new("m3u")), None);
    }

    proptest! {
        #[test]
        fn no_input_panics(bytes in prop::collection::vec(any::<u8>(), 0..300),
                                 text in "(?s)(\\[playlist\\]\n|FILE \"a\" WAVE\n|TRACK 01 AUDIO\n|INDEX 01 |File|[0-9:=\"]|.){0,60}") {
            for name in ["x.m3u", "x.pls", "x.cue"] {
                let path = Path::new(name);
                for bytes in [&bytes[..], text.as_bytes()] {
                    if let Err(error) = Kind::of(path).unwrap().read(path, bytes) {
                        prop_assert!(error.to_string().contains(name));
                    }
                }
            }
        }
    }
}
