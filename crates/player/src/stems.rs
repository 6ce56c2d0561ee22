//! The stems of a song: files or tracks with its separated parts.
//!
//! | place, beside `song.flac` | written by |
//! |---|---|
//! | `song.stems/drums.wav` | the user; any audio format |
//! | `separated/<model>/song/drums.wav` | demucs |
//! | the tracks of `song.stem.mp4` or `song.stem.m4a` | Native Instruments' Stem Creator |
//!
//! The first place that has a stem is used. Upper and lower case do not matter in the names of stems. Links that lead out
//! of the song's folder are refused: a folder from a stranger must not make Mariana read other files.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use mariana_files::atomic_file::folder_of;
use mariana_music::PART_NAMES;

use crate::decode::{DecodeError, Decoder};
use crate::limits;
use crate::playlist::is_audio;
use crate::song::Song;

/// The parts in the tracks of a stem file, after the track with the mix.
const TRACKS: [&str; 4] = ["drums", "bass", "other", "vocals"];

/// A stem of a song.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stem {
    /// Index of the part in [`PART_NAMES`].
    pub part: usize,
    path: PathBuf,
    /// Index among the file's audio tracks; `None` for a file with one stem.
    track: Option<usize>,
}

impl Stem {
    /// Opens the stem for decoding from its start.
    ///
    /// # Errors
    /// Fails if the file cannot be decoded.
    pub fn open(&self) -> Result<Decoder, DecodeError> {
        match self.track {
            Some(track) => Decoder::open_track(&self.path, track),
            None => Decoder::open(&self.path),
        }
    }

    /// Name of the part.
    pub fn name(&self) -> &'static str {
        PART_NAMES.get(self.part).copied().unwrap_or_default()
    }

    /// The stem's file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Returns the stems of a song, in the order of [`PART_NAMES`], and a message about everything that is wrong with them.
/// Both are empty for a song without stems.
pub fn stems_of(song: &Song) -> (Vec<Stem>, Vec<String>) {
    let Song::File(path) = song else { return (Vec::new(), Vec::new()) };
    let mut errors = Vec::new();
    for folder in folders(path) {
        let known = errors.len();
        match in_folder(&folder, folder_of(path), &mut errors) {
            Ok(stems) if stems.is_empty() && errors.len() > known => {}
            Ok(stems) if stems.is_empty() => errors.push(format!(
                "{} has no stems: name its audio files drums, bass, vocals and other, for example drums.wav",
                folder.display()
            )),
            Ok(stems) => return (stems, errors),
            Err(_) => errors.push(format!(
                "cannot read the stems in {}: check the folder's permissions",
                folder.display()
            )),
        }
    }
    let mut stems = Vec::new();
    if is_stem_file(path) {
        for (part, name) in PART_NAMES.iter().enumerate() {
            let track = TRACKS.iter().position(|track| track == name).map(|track| track + 1);
            stems.push(Stem { part, path: path.clone(), track });
        }
    }
    (stems, errors)
}

/// Returns the command that separates a song into stems at a place where [`stems_of`] finds them.
pub fn separating_command(song: &Path) -> String {
    let folder = song.parent().unwrap_or(Path::new("")).join(SEPARATED);
    let quoted = |path: &Path| format!("'{}'", path.display().to_string().replace('\'', r"'\''"));
    format!("demucs --out {} {}", quoted(&folder), quoted(song))
}

/// True if a folder has stems by its name. Playlists leave such folders out.
pub fn is_folder_of_stems(path: &Path) -> bool {
    let above = path.parent().and_then(Path::parent).and_then(Path::file_name);
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(STEMS))
        || above == Some(OsStr::new(SEPARATED))
}

const STEMS: &str = "stems";
const SEPARATED: &str = "separated";

/// The folders that may have the stems of a song and exist.
fn folders(song: &Path) -> Vec<PathBuf> {
    let mut folders = vec![song.with_extension(STEMS)];
    let name = song.file_stem().unwrap_or_default();
    let separated = song.with_file_name(SEPARATED);
    let models = fs::read_dir(separated).into_iter().flatten().flatten().take(limits::STEM_FILES_MAX);
    let mut models: Vec<PathBuf> = models.map(|model| model.path().join(name)).collect();
    models.sort();
    folders.append(&mut models);
    folders.retain(|folder| folder.is_dir());
    folders
}

fn in_folder(folder: &Path, of_song: &Path, errors: &mut Vec<String>) -> io::Result<Vec<Stem>> {
    let root = of_song.canonicalize()?;
    let is_inside = |path: &&PathBuf| path.canonicalize().is_ok_and(|path| path.starts_with(&root));
    let entries = fs::read_dir(folder)?.flatten().take(limits::STEM_FILES_MAX);
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    let mut stems: Vec<Stem> = Vec::new();
    for (part, name) in PART_NAMES.iter().enumerate() {
        let is_stem = |path: &&PathBuf| {
            path.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case(name)) && is_audio(path)
        };
        let (inside, outside): (Vec<_>, Vec<_>) = files.iter().filter(is_stem).partition(is_inside);
        errors.extend(outside.into_iter().map(|stem| {
            format!(
                "{} is not read, because it leads out of the folder {}: copy the stem into that folder",
                stem.display(),
                of_song.display()
            )
        }));
        let mut of_part = inside.into_iter();
        let Some(used) = of_part.next() else { continue };
        stems.push(Stem { part, path: used.clone(), track: None });
        errors.extend(of_part.map(|unused| {
            format!(
                "{} is not used, because {} is the stem of the same part: remove one of them",
                unused.display(),
                used.display()
            )
        }));
    }
    Ok(stems)
}

fn is_stem_file(path: &Path) -> bool {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    name.ends_with(".stem.mp4") || name.ends_with(".stem.m4a")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(stems: &[Stem]) -> Vec<(&str, String, Option<usize>)> {
        let name = |stem: &Stem| stem.path.file_name().unwrap().to_string_lossy().into_owned();
        stems.iter().map(|stem| (stem.name(), name(stem), stem.track)).collect()
    }

    #[test]
    fn stems_are_found_beside_the_song_and_in_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = |path: &str| {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, "").unwrap();
            path
        };
        let song = Song::File(file("My.song.flac"));
        assert!(matches!(stems_of(&song), (stems, errors) if stems.is_empty() && errors.is_empty()));
        file("separated/htdemucs/My.song/other.mp3");
        file("separated/htdemucs/My.song/vocals.mp3");
        let (stems, errors) = stems_of(&song);
        assert_eq!(
            places(&stems),
            [("vocals", "vocals.mp3".into(), None), ("other", "other.mp3".into(), None)]
        );
        assert!(errors.is_empty(), "{errors:?}");
        for stem in ["DRUMS.Wav", "drums.flac", "bass.txt", "bass 2.wav"] {
            file(&format!("My.song.stems/{stem}"));
        }
        let (stems, errors) = stems_of(&song);
        assert_eq!(places(&stems), [("drums", "DRUMS.Wav".into(), None)]);
        assert!(errors.len() == 1 && errors[0].contains("the stem of the same part"), "{errors:?}");

        let song = Song::File(file("set.STEM.mp4"));
        let tracks: Vec<_> = stems_of(&song).0.iter().map(|stem| (stem.name(), stem.track)).collect();
        assert_eq!(tracks, [("drums", Some(1)), ("bass", Some(2)), ("vocals", Some(4)), ("other", Some(3))]);

        let song = Song::File(file("bare.wav"));
        file("bare.stems/mix.wav");
        let (stems, errors) = stems_of(&song);
        assert!(stems.is_empty() && errors[0].contains("drums.wav"), "{errors:?}");
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_song_s_folder_were_read_as_stems() {
        use std::os::unix::fs::symlink;
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("music");
        fs::create_dir_all(folder.join("a.stems")).unwrap();
        for file in ["secret.wav", "music/a.wav", "music/b.wav", "music/kept.wav"] {
            fs::write(place.path().join(file), "").unwrap();
        }
        symlink(place.path().join("secret.wav"), folder.join("a.stems/drums.wav")).unwrap();
        symlink(folder.join("kept.wav"), folder.join("a.stems/bass.wav")).unwrap();
        let (stems, errors) = stems_of(&Song::File(folder.join("a.wav")));
        assert_eq!(places(&stems), [("bass", "bass.wav".into(), None)], "a link inside the folder is read");
        let told = errors.concat();
        assert!(
            errors.len() == 1 && told.contains("drums.wav is not read") && told.contains("copy"),
            "{told}"
        );
        // A linked folder leads out too.
        fs::create_dir(place.path().join("others")).unwrap();
        fs::write(place.path().join("others/vocals.wav"), "").unwrap();
        symlink(place.path().join("others"), folder.join("b.stems")).unwrap();
        let (stems, errors) = stems_of(&Song::File(folder.join("b.wav")));
        assert!(stems.is_empty() && errors.len() == 1, "{errors:?}");
        assert!(errors[0].contains("leads out of the folder"), "{errors:?}");
        // The song itself may be a link.
        symlink(place.path().join("secret.wav"), folder.join("c.wav")).unwrap();
        fs::create_dir(folder.join("c.stems")).unwrap();
        fs::write(folder.join("c.stems/vocals.wav"), "").unwrap();
        assert_eq!(stems_of(&Song::File(folder.join("c.wav"))).0.len(), 1);
    }

    #[test]
    fn folders_of_stems_are_recognised_and_the_command_writes_them() {
        for (path, is_stems) in [
            ("a/song.stems", true),
            ("a/song.Stems", true),
            ("a/separated/htdemucs/song", true),
            ("a/separated/htdemucs", false),
            ("a/stems", false),
        ] {
            assert_eq!(is_folder_of_stems(Path::new(path)), is_stems, "{path}");
        }
        let command = separating_command(Path::new("/m/it's.flac"));
        assert_eq!(command, r"demucs --out '/m/separated' '/m/it'\''s.flac'");
    }
}
