//! The cover image of a song: from the song's file, or from an image file in the song's folder.

use std::fs;
use std::path::{Path, PathBuf};

use mariana_files::atomic_file::folder_of;
use mariana_files::reading::read_at_most;

use super::decode::{Cover, embedded_cover};
use super::limits;
use super::song::Song;

/// Names of cover files without their extension, the most likely first. Case does not matter.
const NAMES: &[&str] = &["cover", "folder", "front", "album", "albumart"];
const EXTENSIONS: &[&str] = &["jpg", "jpeg", "png", "webp", "bmp"];

/// Returns the cover of a song, still encoded. The image in the song's file has priority. A cover that cannot be read
/// counts as missing. This reads files, so it may block.
pub fn cover_of(song: &Song) -> Option<Cover> {
    let embedded = embedded_cover(song).unwrap_or_else(|error| {
        tracing::debug!("the cover inside a song cannot be read: {error}");
        None
    });
    embedded.or_else(|| match song {
        Song::File(path) => beside(path),
        Song::Embedded { .. } => None,
    })
}

fn beside(song: &Path) -> Option<Cover> {
    let mut found: Vec<(usize, PathBuf)> = fs::read_dir(folder_of(song))
        .ok()?
        .take(limits::COVER_FOLDER_FILES_MAX)
        .flatten()
        .filter_map(|entry| Some((rank(&entry.file_name().to_string_lossy())?, entry.path())))
        .collect();
    found.sort();
    found.into_iter().find_map(|(_, path)| read(&path))
}

fn rank(name: &str) -> Option<usize> {
    let (stem, extension) = name.rsplit_once('.')?;
    EXTENSIONS.iter().find(|known| extension.eq_ignore_ascii_case(known))?;
    NAMES.iter().position(|known| stem.eq_ignore_ascii_case(known))
}

fn read(path: &Path) -> Option<Cover> {
    Cover::from_bytes(read_at_most(path, limits::COVER_BYTES_MAX).ok()??)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::CoverKind;

    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n....";
    const JPEG: &[u8] = b"\xff\xd8\xff\xe0....";

    #[test]
    fn a_cover_file_in_the_folder_is_found_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let song = Song::File(folder.path().join("a.wav"));
        mariana_testing::wave::write_wav(
            &folder.path().join("a.wav"),
            8_000,
            1,
            std::iter::repeat_n(0.0, 80),
        );
        assert_eq!(cover_of(&song), None);
        fs::write(folder.path().join("photo.jpg"), JPEG).unwrap();
        assert_eq!(cover_of(&song), None, "any image became the cover");
        fs::write(folder.path().join("Folder.PNG"), PNG).unwrap();
        assert_eq!(cover_of(&song).map(|cover| cover.kind), Some(CoverKind::Png));
        for (name, bytes, kind) in [
            ("cover.webp", b"RIFF\0\0\0\0WEBPVP8 ".as_slice(), CoverKind::WebP),
            ("cover.bmp", b"BM......", CoverKind::Bmp),
        ] {
            fs::write(folder.path().join(name), bytes).unwrap();
            assert_eq!(cover_of(&song).map(|cover| cover.kind), Some(kind), "{name}");
            fs::remove_file(folder.path().join(name)).unwrap();
        }
        // A file that is no image is skipped, and so is a folder with the name of a cover.
        fs::write(folder.path().join("cover.png"), b"<html>").unwrap();
        fs::create_dir(folder.path().join("cover.jpeg")).unwrap();
        assert_eq!(cover_of(&song).map(|cover| cover.kind), Some(CoverKind::Png));
        fs::write(folder.path().join("COVER.jpg"), JPEG).unwrap();
        assert_eq!(cover_of(&song).map(|cover| cover.kind), Some(CoverKind::Jpeg));
        fs::write(folder.path().join("COVER.jpg"), vec![0xff_u8; limits::COVER_BYTES_MAX + 2]).unwrap();
        assert_eq!(cover_of(&song).map(|cover| cover.kind), Some(CoverKind::Png), "an image over the limit");
    }

    #[test]
    fn a_song_that_is_no_file_has_no_cover() {
        assert_eq!(cover_of(&Song::File("/nowhere/at all/x.mp3".into())), None);
        assert_eq!(cover_of(&Song::Embedded { name: "x.ogg", bytes: b"rubbish" }), None);
    }
}
