//! Checks paths in a scene: a path must be relative, have `/` between folders, and stay inside the scene's folder.

/// Returns the path without `.` and doubled `/`. For an invalid path, returns a message and a hint.
pub(super) fn checked(path: &str) -> Result<String, (&'static str, &'static str)> {
    if path.trim().is_empty() {
        return Err(("this file has no name", "write the file's name in the quotes"));
    }
    if path.contains(char::is_control) {
        return Err(("a file's name must not contain control characters", "rename the file"));
    }
    if path.contains('\\') {
        return Err(("folders are separated by `/` on every system", "write `/` instead of `\\`"));
    }
    let inside = "put the file into the scene's folder and write its path relative to that folder";
    if path.starts_with('/') || path.contains(':') {
        return Err(("a scene cannot read absolute paths", inside));
    }
    let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") {
        return Err(("a scene cannot read anything outside its own folder", inside));
    }
    if parts.is_empty() {
        return Err(("this file has no name", "write the file's name in the quotes"));
    }
    Ok(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::checked;

    #[test]
    fn nothing_leads_out_of_the_folder() {
        for good in ["a.scene", "sub/a.scene", "./a.scene", "a..b", "sub//./a.scene"] {
            assert!(checked(good).is_ok(), "{good}");
        }
        assert_eq!(checked("./sub//./a").unwrap(), "sub/a");
        for bad in
            ["", " ", ".", "/etc/passwd", "../a", "a/../../b", "C:\\a", "C:/a", "..\\a", "a\0b", "file:///a"]
        {
            assert!(checked(bad).is_err(), "{bad:?}");
        }
    }
}
