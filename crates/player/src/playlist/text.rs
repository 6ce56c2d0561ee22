//! Splitting of lists and lyrics into lines in any encoding, and resolution of a list's references.

use std::path::{Path, PathBuf};

use crate::limits::LIMITS;

/// The target of a list's entry: an address, or a path as written in the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reference {
    /// A file, list or folder.
    Path(PathBuf),
    /// A network address.
    Address(String),
}

/// Returns the trimmed lines as bytes, because names in old lists have any encoding; `None` if `bytes` is not text.
pub(crate) fn lines(bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
    let utf16 = |from: fn([u8; 2]) -> u16| {
        let units = bytes.get(2..).unwrap_or_default().chunks_exact(2);
        let units = units.map(|pair| from([pair[0], pair[1]]));
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>()
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => utf16(u16::from_le_bytes).into_bytes(),
        [0xfe, 0xff, ..] => utf16(u16::from_be_bytes).into_bytes(),
        [0xef, 0xbb, 0xbf, rest @ ..] => rest.to_vec(),
        _ => bytes.to_vec(),
    };
    if text.contains(&0) {
        return None;
    }
    let lines = text.split(|byte| matches!(byte, b'\n' | b'\r'));
    let lines = lines.map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    Some(lines.take(LIMITS.playlist_looks_max).map(<[u8]>::to_vec).collect())
}

/// Decodes as UTF-8 if valid, otherwise as Latin-1, in which every byte is a character.
pub(crate) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// Resolves an entry of a list in the folder `base`. On systems whose file names are bytes, the list's bytes are tried
/// first. If no file has this name, backslashes count as separators.
pub(super) fn resolve(base: &Path, bytes: &[u8]) -> Reference {
    let text = decode(bytes);
    if let Some((scheme, rest)) = text.split_once("://")
        && scheme.len() > 1
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    {
        let local = rest.strip_prefix("localhost").unwrap_or(rest);
        return match scheme.eq_ignore_ascii_case("file") && local.starts_with('/') {
            true => Reference::Path(path_of(&unescaped(local))),
            false => Reference::Address(text),
        };
    }
    let as_bytes = base.join(path_of(bytes));
    let as_text = base.join(&text);
    let with_slashes = base.join(text.replace('\\', "/"));
    let there = [&as_bytes, &as_text, &with_slashes].into_iter().find(|path| path.exists());
    Reference::Path(there.unwrap_or(&as_text).clone())
}

#[cfg(unix)]
fn path_of(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    PathBuf::from(std::ffi::OsStr::from_bytes(bytes))
}

#[cfg(not(unix))]
fn path_of(bytes: &[u8]) -> PathBuf {
    let text = decode(bytes);
    // The path "/C:/music" of an address means "C:/music".
    let drive = text.strip_prefix('/').filter(|rest| rest.get(1..2) == Some(":"));
    PathBuf::from(drive.unwrap_or(&text))
}

fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let escaped = after.get(..2).filter(|_| *first == b'%');
        let value = escaped
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(value.unwrap_or(*first));
        rest = if value.is_some() { &after[2..] } else { after };
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(bytes: &[u8]) -> Option<Vec<String>> {
        Some(lines(bytes)?.iter().map(|line| decode(line)).collect())
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

    proptest! {
        #[test]
        fn no_input_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            for line in lines(&bytes).unwrap_or_default() {
                prop_assert!(!line.contains(&b'\n') && !line.contains(&0));
                let _ = resolve(Path::new("/nowhere"), &line);
            }
        }
    }
}
