//! Names for new files that replace no other file.

use std::path::{Path, PathBuf};

/// The maximum length of a name made of a title, in characters.
const NAME_MAX: usize = 80;

/// Turns a title into a file name without extension. Characters with a meaning in paths become underscores; without
/// any other character, the name is `otherwise`.
pub fn plain_name(title: &str, otherwise: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || " -_.()&'".contains(c) { c } else { '_' };
    let name: String = title.trim().trim_start_matches('.').chars().map(plain).take(NAME_MAX).collect();
    let name = name.trim_end();
    if name.is_empty() { otherwise.to_owned() } else { name.to_owned() }
}

/// Returns `path`, and then the same path with 2, 3 and so on after the name.
pub fn numbered(path: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let stem = path.file_stem().unwrap_or_default().to_owned();
    let ending = path.extension().map(ToOwned::to_owned);
    let with_number = move |number: u32| {
        let mut name = stem.clone();
        name.push(format!(" {number}"));
        if let Some(ending) = &ending {
            name.push(".");
            name.push(ending);
        }
        name
    };
    let folder = path.to_owned();
    std::iter::once(path.to_owned())
        .chain((2..).map(move |number| folder.with_file_name(with_number(number))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_become_names_in_one_folder() {
        let names = ["AC/DC: Live", "../..", "", "  \u{2009}", "夜に駆ける 🎵", ".hidden", "a\nb"]
            .map(|title| plain_name(title, "video"));
        assert_eq!(names, ["AC_DC_ Live", "_..", "video", "video", "夜に駆ける _", "hidden", "a_b"]);
        assert_eq!(plain_name(&"x".repeat(500), "video").len(), NAME_MAX);
    }

    #[test]
    fn numbers_follow_the_name() {
        let names = |path: &str| numbered(Path::new(path)).take(3).collect::<Vec<_>>();
        assert_eq!(names("/a/b.c.mp4"), ["/a/b.c.mp4", "/a/b.c 2.mp4", "/a/b.c 3.mp4"].map(PathBuf::from));
        assert_eq!(names("b"), ["b", "b 2", "b 3"].map(PathBuf::from));
    }
}
