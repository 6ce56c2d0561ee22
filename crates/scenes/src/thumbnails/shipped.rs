//! Thumbnails of the shipped scenes, drawn by `cargo xtask thumbnails`.

use mariana_assets::THUMBNAILS;

/// Returns the thumbnail of a shipped scene as a JPEG; `None` for an unknown name.
pub fn shipped(name: &str) -> Option<&'static [u8]> {
    THUMBNAILS.get_file(format!("{name}.jpg")).map(|file| file.contents())
}

/// Returns the moving thumbnail of a shipped scene as an animated WebP; `None` for an unknown name.
pub(super) fn shipped_loop(name: &str) -> Option<&'static [u8]> {
    THUMBNAILS.get_file(format!("{name}.webp")).map(|file| file.contents())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped_names;

    #[test]
    fn every_shipped_scene_has_a_thumbnail_and_there_are_no_others() {
        for extension in ["jpg", "webp"] {
            let files = THUMBNAILS.files().map(|file| file.path());
            let files = files.filter(|path| path.extension().is_some_and(|found| found == extension));
            let mut names: Vec<_> = files.map(|path| path.with_extension("").display().to_string()).collect();
            names.sort();
            assert_eq!(names, shipped_names(), "run cargo xtask thumbnails");
        }
        assert_eq!(THUMBNAILS.files().count(), 2 * shipped_names().len());
    }
}
