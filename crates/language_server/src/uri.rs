//! Converts between `file:` addresses and paths.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// Returns the path of a `file:` address; `None` for other addresses.
pub(crate) fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    // A host name other than `localhost` is a share of the network.
    let (host, path) = rest.split_at(rest.find('/')?);
    let path = decoded(path)?;
    if path.contains('\0') {
        return None;
    }
    // `/C:/folder` is a path of Windows.
    let drive = path
        .get(1..3)
        .is_some_and(|two| two.ends_with(':') && two.starts_with(|c: char| c.is_ascii_alphabetic()));
    match (host, drive) {
        ("" | "localhost", true) => path.get(1..).map(PathBuf::from),
        ("" | "localhost", false) => Some(PathBuf::from(path)),
        _ => Some(PathBuf::from(format!("//{}{path}", decoded(host)?))),
    }
}

fn decoded(text: &str) -> Option<String> {
    percent_decode_str(text).decode_utf8().ok().map(Cow::into_owned)
}

/// Returns the `file:` address of a path; `None` for a path that is not UTF-8.
pub(crate) fn uri_of(path: &Path) -> Option<String> {
    let text = path.to_str()?.replace('\\', "/");
    let scheme = if text.starts_with("//") { "file:" } else { "file://" };
    let root = if text.starts_with('/') { "" } else { "/" };
    Some(format!("{scheme}{root}{}", utf8_percent_encode(&text, ESCAPED)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_addresses_and_back() {
        for (path, uri) in [
            ("/home/ä b/x.scene", "file:///home/%C3%A4%20b/x.scene"),
            ("C:/a/x.scene", "file:///C%3A/a/x.scene"),
            ("/a%20b/#1?.scene", "file:///a%2520b/%231%3F.scene"),
        ] {
            assert_eq!(uri_of(Path::new(path)).as_deref(), Some(uri));
            assert_eq!(path_of(uri), Some(PathBuf::from(path)));
        }
        assert_eq!(path_of("file://localhost/x"), Some("/x".into()));
        assert_eq!(path_of("file:///c:/x%zz%4"), Some("c:/x%zz%4".into()));
        assert_eq!(path_of("file://server/share/x"), Some("//server/share/x".into()));
        for other in
            ["untitled:Untitled-1", "file:", "file://", "", "http://a/b", "file:///a%00b", "file:///%ff"]
        {
            assert_eq!(path_of(other), None, "{other}");
        }
    }
}
