//! Keeps the paths of a still in a folder next to it, so that the same command continues after an interruption.
//!
//! A still by paths is drawn in pieces: areas of exposures. The folder `STILL.pieces` has a file for each piece that has
//! been begun: a line with its record, the paths, and a hash of both. The files are written now and then, and by
//! [`PathStore::interrupt`]; [`PathStore::finish`] deletes them when the still is finished.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::error::ExportError;
use super::fingerprint::{Fingerprint, song_hash};
use super::output::pieces_of;
use super::print::print_message;
use crate::atomic_file::{AtomicFile, Unwritable};
use crate::frame::Frame;
use crate::gpu::path_state::PIXEL_BYTES_MAX;
use crate::gpu::{GlInfo, KeptPaths, PathOrder};
use mariana_player::song::Song;

/// Begins a file.
const MARK: &str = "mariana paths ";
/// The ending of the files' names.
const ENDING: &str = "paths";
/// Maximum length of a record, in bytes.
const RECORD_MAX: usize = 4096;

/// The store of an image, which its renderer and the writer of its file share.
pub(super) type SharedStore = Rc<RefCell<PathStore>>;

pub(super) struct PathStore {
    still: PathBuf,
    folder: PathBuf,
    image: ImageRecord,
    every: Duration,
    /// The number of the next piece, and the record of the current one.
    next: u64,
    piece: Option<PieceRecord>,
    begun: Instant,
    /// The time of the last save, or of the begin of the piece.
    saved: Instant,
    /// True after a message that pieces are continued, or cannot be.
    has_told_begin: bool,
    /// The result of the save after an interruption.
    interrupted: Option<Result<(), Unwritable>>,
    has_warned: bool,
}

/// The description of an image in the files of its pieces.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct ImageRecord {
    program: String,
    driver: String,
    /// Hash of the song's bytes.
    song: u64,
    at: f64,
    size: (u32, u32),
}

/// The description of a piece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct PieceRecord {
    image: ImageRecord,
    /// Hashes of the scene's programs and textures, and of all numbers of the frame.
    scene: u64,
    frame: u64,
    number: u64,
    pixels: usize,
    first: u32,
    samples: u32,
    noise: f32,
}

impl PieceRecord {
    /// The difference of the image in the file from this one, in words; `None` if this image can continue its
    /// paths.
    fn difference(&self, file: &Self) -> Option<&'static str> {
        let (own, other) = (&self.image, &file.image);
        let differences = [
            (own.program != other.program, "by another version of Mariana"),
            (own.driver != other.driver, "by another graphics driver"),
            (own.song != other.song, "of another song"),
            (own.at != other.at, "of another moment"),
            (own.size != other.size, "of another size"),
            (
                (self.scene, self.frame, self.number, self.pixels)
                    != (file.scene, file.frame, file.number, file.pixels),
                "of another scene or with other settings",
            ),
            (file.samples > self.samples || file.first != self.first, "with other --samples"),
            (file.noise < self.noise, "with a lower --noise"),
        ];
        differences.into_iter().find_map(|(is_other, words)| is_other.then_some(words))
    }
}

impl PathStore {
    /// The store of the still at `path`, which shows a moment of a song in a size. Paths are saved after the time
    /// `every`.
    ///
    /// # Errors
    /// Fails if the song cannot be read.
    pub(super) fn shared(
        path: &Path,
        song: &Song,
        at: f64,
        size: (u32, u32),
        every: Duration,
    ) -> Result<SharedStore, ExportError> {
        let now = Instant::now();
        let (program, song) = (env!("CARGO_PKG_VERSION").to_owned(), song_hash(song)?);
        let image = ImageRecord { program, driver: String::new(), song, at, size };
        Ok(Rc::new(RefCell::new(Self {
            still: path.to_owned(),
            folder: pieces_of(path),
            image,
            every,
            next: 0,
            piece: None,
            begun: now,
            saved: now,
            has_told_begin: false,
            interrupted: None,
            has_warned: false,
        })))
    }

    pub(super) fn know_driver(&mut self, driver: &GlInfo) {
        self.image.driver = format!("{} {} {}", driver.vendor, driver.renderer, driver.version);
    }

    /// Begins the next piece, of a scene with the given hash. Returns the paths that were kept of it.
    pub(super) fn begin(
        &mut self,
        scene: u64,
        frame: &Frame,
        pixels: usize,
        order: &PathOrder,
    ) -> Option<KeptPaths> {
        let mut inputs = Fingerprint::default();
        inputs.add(frame);
        let piece = PieceRecord {
            image: self.image.clone(),
            scene,
            frame: inputs.number(),
            number: self.next,
            pixels,
            first: order.first,
            samples: order.samples,
            noise: order.noise,
        };
        let read = read(&self.file(self.next), &piece);
        self.piece = Some(piece);
        self.next += 1;
        self.saved = Instant::now();
        let words = match &read {
            Ok(_) => Some(format!("continuing the paths in {}", self.folder.display())),
            Err(words) => words.clone(),
        };
        if let Some(words) = words.filter(|_| !self.has_told_begin) {
            self.has_told_begin = true;
            print_message(&words);
        }
        read.ok()
    }

    /// Saves the current piece if it is time.
    pub(super) fn save_in_time(&mut self, kept: &dyn Fn() -> KeptPaths) {
        if self.saved.elapsed() >= self.every {
            self.save_or_warn(kept);
        }
    }

    /// Saves the current piece, which is finished, if other pieces follow and the image has taken some time.
    pub(super) fn end(&mut self, is_last: bool, kept: &dyn Fn() -> KeptPaths) {
        if !is_last && self.begun.elapsed() >= self.every {
            self.save_or_warn(kept);
        }
    }

    /// Saves the current piece, because the image is finished early.
    pub(super) fn interrupt(&mut self, kept: &dyn Fn() -> KeptPaths) {
        self.interrupted = Some(self.save(kept));
    }

    /// Deletes the pieces of a finished image, or reports how an interrupted one continues. Call this when the image is
    /// written.
    pub(super) fn finish(&self) {
        match &self.interrupted {
            None => self.remove(),
            Some(Ok(())) => print_message(&format!(
                "{} shows the paths so far: run the same command again to continue them",
                self.still.display()
            )),
            Some(Err(error)) => {
                print_message(&format!(
                    "{} shows the paths so far, which cannot be continued: {error}",
                    self.still.display()
                ));
            }
        }
    }

    fn remove(&self) {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return };
        for entry in entries.flatten() {
            if entry.path().extension().is_some_and(|ending| ending == ENDING) {
                // Pieces that cannot be removed only take room.
                let _ = std::fs::remove_file(entry.path());
            }
        }
        // A folder with files of the user stays.
        let _ = std::fs::remove_dir(&self.folder);
    }

    fn save_or_warn(&mut self, kept: &dyn Fn() -> KeptPaths) {
        if let Err(error) = self.save(kept)
            && !self.has_warned
        {
            self.has_warned = true;
            print_message(&format!(
                "an interruption would lose the paths, because {error}: check the folder"
            ));
        }
    }

    fn save(&mut self, kept: &dyn Fn() -> KeptPaths) -> Result<(), Unwritable> {
        let Some(piece) = &self.piece else { return Ok(()) };
        let path = self.file(self.next.saturating_sub(1));
        let saved = AtomicFile::create_with_folder(&path)
            .and_then(|file| file.write(&sealed(piece, &kept().bytes())));
        self.saved = Instant::now();
        saved
    }

    fn file(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{number:08}")).with_extension(ENDING)
    }
}

/// The content of a file.
fn sealed(piece: &PieceRecord, paths: &[u8]) -> Vec<u8> {
    // A record of numbers and names can always be written.
    let line = format!("{MARK}{}\n", serde_json::to_string(piece).unwrap_or_default());
    let mut bytes = [line.as_bytes(), paths].concat();
    bytes.extend(seal_of(&bytes));
    bytes
}

fn seal_of(bytes: &[u8]) -> [u8; 8] {
    let mut fingerprint = Fingerprint::default();
    fingerprint.add_bytes(bytes);
    fingerprint.number().to_le_bytes()
}

/// Reads the paths of a piece, as far as a previous run has kept them.
///
/// # Errors
/// The reason in words why the file is of no use; `None` if there is no file.
fn read(file: &Path, piece: &PieceRecord) -> Result<KeptPaths, Option<String>> {
    let name = file.display();
    let unreadable = |error: io::Error| match error.kind() {
        ErrorKind::NotFound => None,
        _ => Some(format!("{name} cannot be read ({error}): these paths start anew")),
    };
    let damaged = || Some(format!("{name} is damaged: these paths start anew"));
    // Pieces of larger images are longer, but only their record is of interest.
    let most = piece.pixels.saturating_mul(PIXEL_BYTES_MAX).saturating_add(RECORD_MAX);
    let mut bytes = Vec::new();
    File::open(file).and_then(|file| file.take(most as u64).read_to_end(&mut bytes)).map_err(unreadable)?;
    let line = bytes.iter().take(RECORD_MAX).position(|byte| *byte == b'\n').ok_or_else(damaged)?;
    let (line, _) = bytes.split_at(line);
    let found = line.strip_prefix(MARK.as_bytes()).and_then(|json| serde_json::from_slice(json).ok());
    let found: PieceRecord = found.ok_or_else(damaged)?;
    if let Some(difference) = piece.difference(&found) {
        let folder = file.parent().unwrap_or(file).display();
        return Err(Some(format!(
            "the paths in {folder} are of an image {difference}: the paths start anew"
        )));
    }
    let (content, seal) = bytes.split_last_chunk::<8>().ok_or_else(damaged)?;
    let paths = content.get(line.len() + 1..).filter(|_| seal_of(content) == *seal);
    let kept = paths.and_then(|paths| KeptPaths::of_bytes(paths, piece.pixels));
    let mut kept = kept.ok_or_else(damaged)?;
    if (found.samples, found.noise) != (piece.samples, piece.noise) {
        kept.reopen();
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece() -> PieceRecord {
        let image = ImageRecord { program: "1.0".into(), size: (2, 1), ..ImageRecord::default() };
        PieceRecord { image, scene: 1, frame: 2, number: 0, pixels: 2, first: 0, samples: 16, noise: 0.1 }
    }

    #[test]
    fn differences_of_images_have_words() {
        let difference = |change: fn(&mut PieceRecord)| {
            let mut file = piece();
            change(&mut file);
            piece().difference(&file)
        };
        assert_eq!(difference(|_| ()), None);
        assert_eq!(difference(|file| (file.samples, file.noise) = (8, 0.2)), None);
        let words = [
            difference(|file| file.image.program = "1.1".into()),
            difference(|file| file.image.driver = "another".into()),
            difference(|file| file.image.song = 1),
            difference(|file| file.image.at = 0.1),
            difference(|file| file.image.size = (1, 2)),
            difference(|file| file.scene = 3),
            difference(|file| file.number = 1),
            difference(|file| file.first = 16),
            difference(|file| file.samples = 17),
            difference(|file| file.noise = 0.0),
        ];
        let wanted = [
            "version",
            "driver",
            "song",
            "moment",
            "size",
            "scene",
            "scene",
            "--samples",
            "--samples",
            "--noise",
        ];
        for (words, wanted) in words.into_iter().zip(wanted) {
            assert!(words.is_some_and(|words| words.contains(wanted)), "{words:?}, {wanted}");
        }
    }

    #[test]
    fn a_file_longer_than_any_paths_is_read_only_as_far_as_needed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("00000000.paths");
        let file = File::create(&path).unwrap();
        file.set_len(1 << 40).unwrap();
        let words = read(&path, &piece()).err().flatten();
        assert!(words.is_some_and(|words| words.contains("is damaged")));
    }
}
