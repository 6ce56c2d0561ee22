//! Thumbnails of scenes. The thumbnails of shipped scenes are part of the program ([`shipped`]). All other thumbnails
//! are drawn once and cached. The key is a hash of the scene's text, includes and textures.
//!
//! A separate `mariana` process draws each thumbnail as a still, on one thread with the lowest priority, so that a
//! slow scene or a crash of the driver does not affect the show. The newest request is answered first. Requests that
//! need no drawing are answered while another scene is drawn.

mod drawing;

use std::collections::VecDeque;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _, ImageReader, RgbaImage};
use mariana_files::Folders;
use mariana_work::{Latest, Shared, latest};

use crate::limits;
use crate::{SceneSource, first_comment};
use drawing::draw;
pub use drawing::{LOOP_FRAMES, LOOP_RATE, LOOP_SIZE, shipped};
use mariana_files::atomic_file::AtomicFile;
use mariana_files::caches::make_room;
use mariana_files::reading::read_at_most;

/// Size of a thumbnail in pixels.
pub const SIZE: (u32, u32) = (320, 180);
/// Time in the demo track for thumbnails, in seconds: a loud moment in the middle of a phrase.
pub const MOMENT: f64 = 47.3;
/// Part of the cache key. Increase it when the drawing of thumbnails changes.
const VERSION: u32 = 1;
/// JPEG quality, 0..=100. Several thumbnails of this quality fit into one message to a phone.
const JPEG_QUALITY: u8 = 82;

/// An answer about a scene.
#[derive(Debug)]
pub struct Looked {
    /// The scene.
    pub source: SceneSource,
    /// The answer.
    pub about: About,
}

/// The content of a [`Looked`].
#[derive(Debug)]
pub enum About {
    /// What the scene's text says about the scene.
    Description(Description),
    /// The thumbnail, and the same image as a JPEG for phones.
    Picture(Arc<RgbaImage>, Arc<[u8]>),
    /// The reason for a missing thumbnail.
    NoPicture(String),
    /// The frames of the moving thumbnail; empty if the scene has none.
    Motion(Vec<Arc<RgbaImage>>),
}

/// What a scene's text says about the scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Description {
    /// The comment at the start of the text.
    pub comment: String,
    /// The moods of the block `about`.
    pub moods: Vec<String>,
    /// The energy of the music that the scene suits, from 0 to 1; `None` if the scene does not say it.
    pub energy: Option<(f32, f32)>,
}

/// The thread that provides thumbnails and descriptions of scenes. Dropping this ends the process that draws.
#[derive(Debug)]
pub struct Thumbnails {
    requests: Latest<Waiting>,
    looked: Receiver<Looked>,
}

/// Requests; the last entry is the newest.
type Waiting = VecDeque<Request>;

#[derive(Debug, Clone, PartialEq)]
enum Request {
    Description(SceneSource),
    Picture(SceneSource),
    Motion(SceneSource),
}

impl Request {
    /// True if the answer needs no drawing.
    fn is_quick(&self) -> bool {
        match self {
            Self::Description(_) | Self::Motion(_) => true,
            Self::Picture(source) => jpeg_shipped_with(source).is_some(),
        }
    }
}

/// Takes the newest quick request. Without one, takes the newest request.
fn pop(waiting: &mut Waiting) -> Option<Request> {
    pop_quick(waiting).or_else(|| waiting.pop_back())
}

fn pop_quick(waiting: &mut Waiting) -> Option<Request> {
    let newest = waiting.iter().rposition(Request::is_quick)?;
    waiting.remove(newest)
}

impl Thumbnails {
    /// Starts the thread that answers requests. It calls `wake` after each answer.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(folders: &Folders, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let folder = folders.cache.as_ref().map(|cache| cache.join("thumbnails"));
        let program = folders.program.clone();
        let (answers, looked) = channel();
        let mut untidy = folder.clone();
        let work = move |request, requests: &Shared<Waiting>| {
            if let Some(folder) = untidy.take() {
                make_room(&folder, &["png"], |_| 1, limits::THUMBNAILS_KEPT_MAX as u64);
            }
            let (folder, program) = (folder.as_deref(), program.as_deref());
            Thumbnailer { requests, folder, program, answers: &answers, wake: &wake }.answer(request);
        };
        let requests = latest("thumbnails", Waiting::new(), pop, work)?;
        Ok(Self { requests, looked })
    }

    /// Requests the descriptions of scenes.
    pub fn request_descriptions<'a>(&mut self, sources: impl DoubleEndedIterator<Item = &'a SceneSource>) {
        let requests = sources.rev().cloned().map(Request::Description);
        self.requests.change(|waiting| waiting.extend(requests));
    }

    /// Requests the moving thumbnail of a scene.
    pub fn request_motion(&mut self, source: SceneSource) {
        self.requests.change(|waiting| waiting.push_back(Request::Motion(source)));
    }

    /// Requests thumbnails in this order, before all earlier requests.
    pub fn request_pictures(&mut self, sources: Vec<SceneSource>) {
        let requests = sources.into_iter().rev().map(Request::Picture);
        self.requests.change(|waiting| waiting.extend(requests));
    }

    /// Requests thumbnails in this order, after all other requests.
    pub fn request_pictures_later(&mut self, sources: Vec<SceneSource>) {
        let requests = sources.into_iter().map(Request::Picture);
        self.requests.change(|waiting| requests.for_each(|request| waiting.push_front(request)));
    }

    /// Returns the next answer, if there is one.
    pub fn poll(&mut self) -> Option<Looked> {
        self.looked.try_recv().ok()
    }
}

struct Thumbnailer<'a> {
    requests: &'a Shared<Waiting>,
    /// The cache; `None` if the system has no cache folder.
    folder: Option<&'a Path>,
    program: Option<&'a Path>,
    answers: &'a Sender<Looked>,
    wake: &'a dyn Fn(),
}

impl Thumbnailer<'_> {
    fn answer(&self, request: Request) {
        let (source, about) = match &request {
            Request::Description(source) => (source, About::Description(description_of(source))),
            Request::Motion(source) => (source, About::Motion(drawing::frames_of(source))),
            Request::Picture(source) => (source, self.picture_of(source)),
        };
        let _ = self.answers.send(Looked { source: source.clone(), about });
        (self.wake)();
    }

    /// Answers requests that need no drawing, while a process draws.
    fn answer_quick(&self) {
        loop {
            // The lock is released before the answer.
            let Some(quick) = pop_quick(&mut self.requests.lock()) else { return };
            self.answer(quick);
        }
    }

    /// Returns the thumbnail of a scene: shipped, cached or new.
    fn picture_of(&self, source: &SceneSource) -> About {
        let found = match jpeg_shipped_with(source) {
            Some(jpeg) => image::load_from_memory_with_format(jpeg, image::ImageFormat::Jpeg)
                .map(|image| (image.into_rgba8(), jpeg.into()))
                .map_err(|error| error.to_string()),
            None => self.kept_or_drawn(source).map(|image| {
                let jpeg = jpeg_of(&image).into();
                (image, jpeg)
            }),
        };
        match found {
            Ok((image, jpeg)) => About::Picture(Arc::new(image), jpeg),
            Err(reason) => About::NoPicture(reason),
        }
    }

    fn kept_or_drawn(&self, source: &SceneSource) -> Result<RgbaImage, String> {
        let key = key_of(source)?;
        let kept = self.folder.map(|folder| folder.join(format!("{key:016x}.png")));
        if let Some(image) = kept.as_deref().and_then(|path| decode(&fs::read(path).ok()?).ok()) {
            return Ok(image);
        }
        let bytes = draw(self.program, source, || {
            self.answer_quick();
            self.requests.is_over()
        });
        let bytes = bytes.map_err(|error| format!("the thumbnail cannot be drawn ({error})"))?;
        let image = decode(&bytes).map_err(|error| error.to_string())?;
        if let Some(path) = &kept {
            keep(path, &bytes);
        }
        Ok(image)
    }
}

/// A scene with mistakes has only a comment.
fn description_of(source: &SceneSource) -> Description {
    let text = source.text().unwrap_or_default();
    let comment = first_comment(&text).collect::<Vec<_>>().join(" ");
    let about = source.compile().ok().and_then(|compiled| compiled.scene).map(|scene| scene.about);
    let Some(about) = about else { return Description { comment, ..Description::default() } };
    let energy = Some(about.energy).filter(|energy| *energy != (0.0, 1.0));
    Description { comment, moods: about.moods, energy }
}

fn jpeg_shipped_with(source: &SceneSource) -> Option<&'static [u8]> {
    match source {
        SceneSource::Shipped(name) => shipped(name),
        SceneSource::File(_) | SceneSource::Formula(_) => None,
        SceneSource::Blend(blend) => jpeg_shipped_with(&blend.to.source),
    }
}

/// Returns a hash of everything the scene depends on.
///
/// # Errors
/// Fails with the first mistake in the scene.
fn key_of(source: &SceneSource) -> Result<u64, String> {
    let text = source.text().map_err(|error| error.to_string())?;
    let compiled = source.compile().map_err(|error| error.to_string())?;
    let mut hasher = DefaultHasher::new();
    (VERSION, env!("CARGO_PKG_VERSION"), text).hash(&mut hasher);
    // Hash the includes and textures. The first file is the scene itself, whose text is in the hash already.
    for path in source.files(Some(&compiled)).into_iter().skip(1) {
        let bytes = read_at_most(&path, limits::TEXTURE_BYTES_MAX).ok();
        (path.file_name(), bytes).hash(&mut hasher);
    }
    match compiled.diagnostics.first() {
        None => Ok(hasher.finish()),
        Some(mistake) => Err(mistake.message.clone()),
    }
}

/// Decodes a PNG that is no larger than a thumbnail: a user may put any file into the cache folder.
fn decode(bytes: &[u8]) -> image::ImageResult<RgbaImage> {
    let mut reader = ImageReader::with_format(io::Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(SIZE.0), Some(SIZE.1));
    reader.limits(limits);
    Ok(reader.decode()?.into_rgba8())
}

/// Encodes an image as a JPEG; empty if encoding fails.
pub fn jpeg_of(image: &RgbaImage) -> Vec<u8> {
    let rgb: Vec<u8> = image.pixels().flat_map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]).collect();
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
    let written = encoder.write_image(&rgb, image.width(), image.height(), ExtendedColorType::Rgb8);
    if written.is_ok() { jpeg } else { Vec::new() }
}

/// Writes a thumbnail to the cache. If that fails, the next run draws it again.
fn keep(path: &Path, bytes: &[u8]) {
    if let Err(error) = AtomicFile::create_with_folder(path).and_then(|file| file.write(bytes)) {
        tracing::debug!("a thumbnail cannot be cached: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cache_key_covers_everything_the_scene_depends_on() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a.scene", "include \"part.scene\"\nobject a { shape = ball(p) }\n");
        let source = SceneSource::File(folder.path().join("a.scene"));
        let key = || key_of(&source);
        assert!(key().is_err(), "the include is missing");
        write("part.scene", "fn ball(q) = length(q) - 1\n");
        let first = key().unwrap();
        assert_eq!(key(), Ok(first));
        write("part.scene", "fn ball(q) = length(q) - 2\n");
        let second = key().unwrap();
        assert_ne!(first, second);
        write("a.scene", "include \"part.scene\"\nobject b { shape = ball(p) }\n");
        assert!(![first, second].contains(&key().unwrap()));
    }

    #[test]
    fn shipped_thumbnails_need_no_drawing() {
        let (woken, wakes) = channel();
        let mut thumbnails = Thumbnails::start(&Folders::default(), move || {
            let _ = woken.send(());
        })
        .unwrap();
        let all: Vec<_> = crate::shipped_names().into_iter().map(SceneSource::Shipped).collect();
        // No process of this test can draw a still.
        thumbnails.request_pictures(all.clone());
        for source in all {
            wakes.recv_timeout(std::time::Duration::from_secs(60)).unwrap();
            let looked = thumbnails.poll().unwrap();
            assert_eq!(looked.source, source);
            let About::Picture(image, jpeg) = looked.about else { panic!("{:?}", looked) };
            assert_eq!((image.dimensions(), &*jpeg), (SIZE, jpeg_shipped_with(&source).unwrap()));
        }
    }

    #[test]
    fn quick_requests_come_before_slow_ones() {
        let file = |name: &str| SceneSource::File(name.into());
        let orb = SceneSource::Shipped("orb".into());
        let mut waiting = Waiting::default();
        waiting.extend([Request::Picture(file("a")), Request::Picture(orb.clone())]);
        waiting.extend([Request::Description(file("a")), Request::Picture(file("b"))]);
        let quick: Vec<_> = std::iter::from_fn(|| pop_quick(&mut waiting)).collect();
        assert_eq!(quick, [Request::Description(file("a")), Request::Picture(orb)]);
        let slow: Vec<_> = std::iter::from_fn(|| pop(&mut waiting)).collect();
        assert_eq!(slow, [file("b"), file("a")].map(Request::Picture));
    }

    #[test]
    fn a_description_has_the_moods_and_the_energy_of_the_scene() {
        let about = description_of(&SceneSource::Shipped("moonrise".into()));
        assert!(about.moods.contains(&"calm".to_owned()) && !about.comment.is_empty(), "{about:?}");
        assert!(about.energy.is_some_and(|(least, most)| least < 0.1 && most < 0.5), "{about:?}");
        let nothing = description_of(&SceneSource::Formula("length(p) - 1".into()));
        assert_eq!((nothing.moods.len(), nothing.energy), (0, None));
        assert_eq!(description_of(&SceneSource::File("no such file".into())), Description::default());
    }

    #[test]
    fn damaged_and_oversized_files_in_the_cache_are_errors() {
        assert!(decode(b"").is_err() && decode(b"\x89PNG\r\n\x1a\nrubbish").is_err());
        let encoded = |width, height| {
            let mut bytes = io::Cursor::new(Vec::new());
            image::RgbaImage::new(width, height).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            bytes.into_inner()
        };
        assert_eq!(decode(&encoded(SIZE.0, SIZE.1)).unwrap().dimensions(), SIZE);
        assert!(decode(&encoded(5_000, 10)).is_err(), "larger than a thumbnail");
    }

    #[test]
    fn a_thumbnail_for_phones_is_a_small_jpeg() {
        let noise = RgbaImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            let hash = (x * 7_919 + y * 104_729).wrapping_mul(2_654_435_761);
            image::Rgba([(hash >> 8) as u8, (hash >> 16) as u8, (hash >> 24) as u8, 255])
        });
        let jpeg = jpeg_of(&noise);
        assert!(
            jpeg.len() <= mariana_remote::limits::LIMITS.picture_bytes_max,
            "{} bytes of noise",
            jpeg.len()
        );
        let read = image::load_from_memory_with_format(&jpeg, image::ImageFormat::Jpeg).unwrap();
        assert_eq!((read.width(), read.height()), SIZE);
    }
}
