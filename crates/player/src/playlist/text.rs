//! Splitting of lists and lyrics into lines in any encoding, and resolution of a list's references.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use encoding_rs::Encoding;
use percent_encoding::percent_decode;
use unicode_normalization::UnicodeNormalization;

use crate::encoding::{encoding_of, utf16_encoding_of};
use crate::limits;

/// The target of a list's entry: an address, or a path as written in the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reference {
    /// A file, list or folder.
    Path(PathBuf),
    /// A network address.
    Address(String),
}

/// Lines of a list or of lyrics, trimmed and not empty. They are bytes, because names in old lists have any encoding.
pub(crate) struct Lines {
    pub(crate) lines: Vec<Vec<u8>>,
    /// The encoding of lines that are not UTF-8.
    encoding: &'static Encoding,
}

impl Lines {
    /// Splits `bytes` into lines; `None` if they are not text.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let bytes: Cow<'_, [u8]> = match bytes {
            [0xef, 0xbb, 0xbf, rest @ ..] => rest.into(),
            _ if bytes.contains(&0) => {
                let (text, _, is_malformed) = utf16_encoding_of(bytes).decode(bytes);
                if is_malformed || text.contains(|c: char| c.is_control() && !c.is_whitespace()) {
                    return None;
                }
                text.into_owned().into_bytes().into()
            }
            _ => bytes.into(),
        };
        let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
        let lines = lines.map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
        let lines = lines.take(limits::PLAYLIST_LOOKS_MAX).map(<[u8]>::to_vec).collect();
        Some(Self { lines, encoding: encoding_of(&bytes) })
    }

    /// Decodes a part of a line.
    pub(crate) fn decode(&self, bytes: &[u8]) -> String {
        match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => self.encoding.decode_without_bom_handling(bytes).0.into_owned(),
        }
    }

    /// Resolves an entry of a list in the folder `base`. On systems whose file names are bytes, the list's bytes are
    /// tried first. If no file has this name, backslashes count as separators, and percent signs as the escapes of
    /// addresses. Accents are tried in both normal forms of Unicode.
    pub(super) fn resolve(&self, base: &Path, bytes: &[u8]) -> Reference {
        let text = self.decode(bytes);
        let unescaped: Vec<u8> = percent_decode(bytes).collect();
        if let Some((scheme, rest)) = text.split_once("://")
            && scheme.len() > 1
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
        {
            let local = rest.strip_prefix("localhost").unwrap_or(rest);
            if !scheme.eq_ignore_ascii_case("file") || !local.starts_with('/') {
                return Reference::Address(text);
            }
            let local: Vec<u8> = percent_decode(local.as_bytes()).collect();
            let path = path_of(&local);
            let spelt = spellings(base, &self.decode(&local)).find(|path| path.exists());
            return Reference::Path(if path.exists() { path } else { spelt.unwrap_or(path) });
        }
        let other_names = [text.replace('\\', "/"), self.decode(&unescaped)];
        let mut names = [base.join(path_of(bytes))]
            .into_iter()
            .chain(spellings(base, &text))
            .chain(other_names.iter().flat_map(|name| spellings(base, name)));
        Reference::Path(names.find(|path| path.exists()).unwrap_or_else(|| base.join(&text)))
    }
}

/// The paths that `name` may mean in different normal forms of Unicode.
fn spellings(base: &Path, name: &str) -> impl Iterator<Item = PathBuf> {
    [name.to_owned(), name.nfc().collect(), name.nfd().collect()]
        .map(|name: String| base.join(name))
        .into_iter()
}

#[cfg(unix)]
fn path_of(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    PathBuf::from(std::ffi::OsStr::from_bytes(bytes))
}

#[cfg(not(unix))]
fn path_of(bytes: &[u8]) -> PathBuf {
    let text = crate::encoding::decode(bytes);
    // The path "/C:/music" of an address means "C:/music".
    let drive = text.strip_prefix('/').filter(|rest| rest.get(1..2) == Some(":"));
    PathBuf::from(drive.unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(bytes: &[u8]) -> Option<Vec<String>> {
        let text = Lines::of(bytes)?;
        Some(text.lines.iter().map(|line| text.decode(line)).collect())
    }

    fn resolve(base: &Path, entry: &[u8]) -> Reference {
        Lines::of(entry).unwrap().resolve(base, entry)
    }

    #[test]
    fn encodings_are_recognised() {
        let wanted = Some(vec!["Größe.mp3".to_owned(), "b".to_owned()]);
        let utf16 = |mark: [u8; 2], to: fn(u16) -> [u8; 2]| {
            let units = "Größe.mp3\r\nb".encode_utf16().flat_map(to);
            mark.into_iter().chain(units).collect::<Vec<u8>>()
        };
        assert_eq!(read("Größe.mp3\n b \n".as_bytes()), wanted);
        assert_eq!(read("\u{feff}Größe.mp3\rb".as_bytes()), wanted);
        assert_eq!(read(b"Gr\xf6\xdfe.mp3\r\n\r\nb"), wanted);
        assert_eq!(read(&utf16([0xff, 0xfe], u16::to_le_bytes)), wanted);
        assert_eq!(read(&utf16([0xfe, 0xff], u16::to_be_bytes)), wanted);
        assert_eq!(read(&utf16([0xff, 0xfe], u16::to_le_bytes)[2..]), wanted);
        // In Shift-JIS a second byte may be a backslash. Short names need the other lines of the list.
        let shift_jis = encoding_rs::SHIFT_JIS.encode("表示.mp3\n音楽/テストの歌.mp3").0;
        assert_eq!(read(&shift_jis), Some(vec!["表示.mp3".to_owned(), "音楽/テストの歌.mp3".to_owned()]));
        assert_eq!(read(b"RIFF\x24\0\0\0WAVE"), None);
    }

    #[test]
    fn addresses_and_paths_are_distinguished() {
        let base = Path::new("/music");
        let path = |text: &str| Reference::Path(PathBuf::from(text));
        assert_eq!(resolve(base, b"a/b.mp3"), path("/music/a/b.mp3"));
        assert_eq!(resolve(base, b"/x.mp3"), path("/x.mp3"));
        assert_eq!(resolve(base, b"file:///a%20b%C3%A9%zz"), path("/a bé%zz"));
        assert_eq!(resolve(base, b"FILE://localhost/a"), path("/a"));
        for address in ["http://radio/x", "file://server/share", "rtmp+x://y"] {
            assert_eq!(resolve(base, address.as_bytes()), Reference::Address(address.into()));
        }
        assert_eq!(resolve(base, "AC://DC".as_bytes()), Reference::Address("AC://DC".into()));
        assert_eq!(resolve(base, "what?://".as_bytes()), path("/music/what?://"));
    }

    #[cfg(unix)]
    #[test]
    fn existing_paths_are_preferred() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path();
        std::fs::create_dir(base.join("cd")).unwrap();
        let raw = path_of(b"gr\xfcn.mp3");
        for name in [Path::new("cd/ä.mp3"), Path::new("c\\d.mp3"), &raw] {
            std::fs::write(base.join(name), b"x").unwrap();
        }
        let found = |bytes: &[u8]| match resolve(base, bytes) {
            Reference::Path(path) => path.strip_prefix(base).unwrap().to_owned(),
            other => panic!("{other:?}"),
        };
        assert_eq!(found(b"cd\\\xe4.mp3"), Path::new("cd/ä.mp3"));
        assert_eq!(found(b"c\\d.mp3"), Path::new("c\\d.mp3"));
        assert_eq!(found(b"gr\xfcn.mp3"), raw);
    }

    #[test]
    fn escaped_names_and_other_normal_forms_find_their_files() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path();
        let decomposed = "Corazo\u{301}n.wav";
        for name in ["my song #1.wav", "100%25.wav", decomposed] {
            std::fs::write(base.join(name), b"x").unwrap();
        }
        let found = |entry: &str, name: &str| {
            let Reference::Path(path) = resolve(base, entry.as_bytes()) else {
                panic!("{entry} is an address")
            };
            assert!(path.exists() && path.ends_with(name), "{entry}: {}", path.display());
        };
        found("my%20song%20%231.wav", "my song #1.wav");
        found("100%25.wav", "100%25.wav");
        found("Coraz\u{f3}n.wav", decomposed);
        found("Coraz%C3%B3n.wav", decomposed);
        found(&format!("file://{}/Coraz%C3%B3n.wav", base.display()), decomposed);
    }

    proptest! {
        #[test]
        fn no_input_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            if let Some(text) = Lines::of(&bytes) {
                for line in &text.lines {
                    prop_assert!(!line.contains(&b'\n') && !line.contains(&0));
                    let _ = text.resolve(Path::new("/nowhere"), line);
                }
            }
        }
    }
}
