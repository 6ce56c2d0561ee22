//! Small pictures of scenes, each drawn once and kept from run to run by what the scene is made of.
//!
//! **A picture is drawn by a process of its own**, at the lowest priority and on one thread: the program itself renders
//! a still. So a scene that is too dear, or that a driver does not survive, costs the show nothing, and no context of
//! the show has to do with it. Only scenes that somebody looks at are drawn, one after the other, the newest wish
//! first.

use std::collections::VecDeque;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use directories::ProjectDirs;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _, ImageReader, RgbaImage};

use crate::atomic_file::AtomicFile;
use crate::limits::LIMITS;
use crate::scenes::{SceneSource, first_comment};

/// Size of a picture in pixels.
const SIZE: (u32, u32) = (320, 180);
/// The moment of the demo track that pictures show, in seconds: loud, and in the middle of a phrase.
const MOMENT: &str = "47.3";
/// Goes up when pictures of the same scene look different than before.
const VERSION: u32 = 1;
/// Quality of a picture as a JPEG, of 100: a few steps of it fit into what a phone loads at once.
const JPEG_QUALITY: u8 = 82;
/// How often a process is looked at.
const INTERVAL: Duration = Duration::from_millis(20);

/// What was found out about a scene.
#[derive(Debug)]
pub struct Looked {
    /// The scene.
    pub source: SceneSource,
    /// What was found out.
    pub about: About,
}

/// See [`Looked`].
#[derive(Debug)]
pub enum About {
    /// What it says about itself.
    Comment(String),
    /// Its picture, and the same as a JPEG for those who are not in this window.
    Picture(Arc<RgbaImage>, Arc<[u8]>),
    /// Why there is no picture.
    NoPicture(String),
}

/// See the module. Dropping it ends the process that draws.
#[derive(Debug)]
pub struct Thumbnails {
    wishes: Arc<Wishes>,
    looked: Receiver<Looked>,
}

#[derive(Debug, Default)]
struct Wishes {
    waiting: Mutex<VecDeque<Wish>>,
    changed: Condvar,
    over: AtomicBool,
}

/// What is to be found out about a scene.
#[derive(Debug)]
enum Wish {
    Comment(SceneSource),
    Picture(SceneSource),
}

impl Wishes {
    fn lock(&self) -> MutexGuard<'_, VecDeque<Wish>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The newest wish, once there is one; none at the end.
    fn next(&self) -> Option<Wish> {
        let waiting = self.changed.wait_while(self.lock(), |waiting| waiting.is_empty() && !self.is_over());
        waiting.unwrap_or_else(PoisonError::into_inner).pop_back().filter(|_| !self.is_over())
    }

    fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

impl Thumbnails {
    /// Starts the thread that looks; `wake` is called when it has found something.
    ///
    /// # Errors
    /// There is no thread.
    pub fn start(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let wishes = Arc::new(Wishes::default());
        let (sender, looked) = channel();
        let of_thread = wishes.clone();
        std::thread::Builder::new().name("thumbnails".into()).spawn(move || {
            let folder = ProjectDirs::from("", "", "mariana").map(|of| of.cache_dir().join("thumbnails"));
            if let Some(folder) = &folder {
                forget_oldest(folder);
            }
            while let Some(wish) = of_thread.next() {
                let (source, about) = match wish {
                    Wish::Comment(source) => {
                        let about = comment_of(&source);
                        (source, about)
                    }
                    Wish::Picture(source) => {
                        let about = picture_of(&source, folder.as_deref(), &of_thread);
                        (source, about)
                    }
                };
                let _ = sender.send(Looked { source, about });
                wake();
            }
        })?;
        Ok(Self { wishes, looked })
    }

    /// Wants to know what scenes say about themselves. That takes little, so it comes before all pictures.
    pub fn ask_for_comments<'a>(&mut self, sources: impl DoubleEndedIterator<Item = &'a SceneSource>) {
        self.wishes.lock().extend(sources.rev().cloned().map(Wish::Comment));
        self.wishes.changed.notify_one();
    }

    /// Wants pictures: the first of these first, before those that were wanted earlier.
    pub fn ask_for_pictures(&mut self, sources: Vec<SceneSource>) {
        self.wishes.lock().extend(sources.into_iter().rev().map(Wish::Picture));
        self.wishes.changed.notify_one();
    }

    /// Wants pictures once nobody wants anything else: the first of these first, behind those that were wanted so earlier.
    pub fn ask_for_pictures_later(&mut self, sources: Vec<SceneSource>) {
        let mut waiting = self.wishes.lock();
        sources.into_iter().map(Wish::Picture).for_each(|wish| waiting.push_front(wish));
        drop(waiting);
        self.wishes.changed.notify_one();
    }

    /// What was found out next, if anything.
    pub fn poll(&mut self) -> Option<Looked> {
        self.looked.try_recv().ok()
    }
}

impl Drop for Thumbnails {
    fn drop(&mut self) {
        self.wishes.over.store(true, Ordering::Relaxed);
        self.wishes.changed.notify_all();
    }
}

fn comment_of(source: &SceneSource) -> About {
    let text = source.text().unwrap_or_default();
    About::Comment(first_comment(&text).collect::<Vec<_>>().join(" "))
}

/// The picture of a scene: the one that is kept, or a new one.
fn picture_of(source: &SceneSource, folder: Option<&Path>, wishes: &Wishes) -> About {
    let found = || -> Result<RgbaImage, String> {
        let text = source.text().map_err(|error| error.to_string())?;
        let key = key_of(source, &text)?;
        let kept = folder.map(|folder| folder.join(format!("{key:016x}.png")));
        if let Some(image) = kept.as_deref().and_then(|path| read_png(path).ok()) {
            return Ok(image);
        }
        let bytes = draw(source, wishes)?;
        let image = decode(&bytes).map_err(|error| error.to_string())?;
        if let Some(path) = &kept {
            keep(path, &bytes);
        }
        Ok(image)
    };
    match found() {
        Ok(image) => {
            let jpeg = jpeg_of(&image).into();
            About::Picture(Arc::new(image), jpeg)
        }
        Err(reason) => About::NoPicture(reason),
    }
}

/// A number of everything that a scene is made of.
///
/// # Errors
/// The scene has mistakes; the first of them.
fn key_of(source: &SceneSource, text: &str) -> Result<u64, String> {
    let compiled = source.compile().map_err(|error| error.to_string())?;
    let mut hasher = DefaultHasher::new();
    (VERSION, env!("CARGO_PKG_VERSION"), text).hash(&mut hasher);
    // Whatever it includes and whatever pictures it shows: their names and bytes. Its own file is the first.
    for path in source.files(Some(&compiled)).into_iter().skip(1) {
        let mut bytes = Vec::new();
        let read = fs::File::open(&path)
            .and_then(|file| file.take(LIMITS.texture_bytes_max as u64).read_to_end(&mut bytes));
        (path.file_name(), read.is_ok(), bytes).hash(&mut hasher);
    }
    match compiled.diagnostics.first() {
        None => Ok(hasher.finish()),
        Some(mistake) => Err(mistake.message.clone()),
    }
}

/// Draws a picture of a scene in a process of its own and returns the PNG's bytes.
///
/// # Errors
/// Why there is none, as a sentence.
fn draw(source: &SceneSource, wishes: &Wishes) -> Result<Vec<u8>, String> {
    let cannot = |error: io::Error| format!("it cannot be drawn ({error})");
    let place = tempfile::tempdir().map_err(cannot)?;
    let file = place.path().join("picture.png");
    let scene = match source {
        SceneSource::Blend(blend) => return draw(&blend.to.source, wishes),
        SceneSource::Shipped(name) => name.into(),
        SceneSource::File(path) => path.clone().into_os_string(),
        SceneSource::Formula(text) => text.into(),
    };
    let mut option = std::ffi::OsString::from("--scene=");
    option.push(scene);
    let mut command = Command::new(std::env::current_exe().map_err(cannot)?);
    command.args(["still", "--at", MOMENT, "--size", &format!("{}x{}", SIZE.0, SIZE.1), "-o"]).arg(&file);
    command.arg(option).env("LP_NUM_THREADS", "1");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = Drawing(command.spawn().map_err(cannot)?);
    lower_priority(&child.0);
    let until = Instant::now() + Duration::from_secs_f64(LIMITS.thumbnail_seconds_max);
    loop {
        match child.0.try_wait().map_err(cannot)? {
            Some(status) if status.success() => return fs::read(&file).map_err(cannot),
            Some(_) => return Err("it cannot be drawn".to_owned()),
            None if wishes.is_over() => return Err(String::new()),
            None if Instant::now() > until => {
                return Err(format!("drawing it takes over {} s", LIMITS.thumbnail_seconds_max));
            }
            None => std::thread::sleep(INTERVAL),
        }
    }
}

/// A process that ends when nobody waits for it any more.
struct Drawing(Child);

impl Drop for Drawing {
    fn drop(&mut self) {
        // One that has ended already cannot be killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(target_os = "linux")]
fn lower_priority(child: &Child) {
    let lowered = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw);
    let _ = rustix::process::setpriority_process(lowered, 19);
}

#[cfg(not(target_os = "linux"))]
fn lower_priority(_: &Child) {}

fn read_png(path: &Path) -> image::ImageResult<RgbaImage> {
    decode(&fs::read(path)?)
}

/// A picture of exactly the size that is drawn here: what lies in the folder may be anything.
fn decode(bytes: &[u8]) -> image::ImageResult<RgbaImage> {
    let mut reader = ImageReader::new(io::Cursor::new(bytes));
    reader.set_format(image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(SIZE.0), Some(SIZE.1));
    reader.limits(limits);
    Ok(reader.decode()?.into_rgba8())
}

/// A picture as a JPEG; empty if it cannot be one.
fn jpeg_of(image: &RgbaImage) -> Vec<u8> {
    let rgb: Vec<u8> = image.pixels().flat_map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]).collect();
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
    let written = encoder.write_image(&rgb, image.width(), image.height(), ExtendedColorType::Rgb8);
    if written.is_ok() { jpeg } else { Vec::new() }
}

/// Keeps a picture for the next run. One that cannot be kept is drawn again then.
fn keep(path: &Path, bytes: &[u8]) {
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).map_err(|error| error.to_string());
    let written = written.and_then(|()| {
        AtomicFile::create(path).and_then(|file| file.write(bytes)).map_err(|error| error.to_string())
    });
    if let Err(reason) = written {
        tracing::debug!("a small picture cannot be kept: {reason}");
    }
}

/// Removes the oldest pictures beyond the limit.
fn forget_oldest(folder: &Path) {
    let Ok(listing) = fs::read_dir(folder) else { return };
    let mut files: Vec<(std::time::SystemTime, PathBuf)> = listing
        .flatten()
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
        .collect();
    files.sort();
    let surplus = files.len().saturating_sub(LIMITS.thumbnails_kept_max);
    for (_, path) in files.into_iter().take(surplus) {
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_known_by_everything_that_the_scene_is_made_of() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a.scene", "include \"part.scene\"\nobject a { shape = ball(p) }\n");
        let source = SceneSource::File(folder.path().join("a.scene"));
        let key = || key_of(&source, &source.text().unwrap());
        assert!(key().is_err(), "what it includes is missing");
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
    fn what_lies_in_the_folder_may_be_anything() {
        assert!(decode(b"").is_err() && decode(b"\x89PNG\r\n\x1a\nrubbish").is_err());
        let encoded = |width, height| {
            let mut bytes = io::Cursor::new(Vec::new());
            image::RgbaImage::new(width, height).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            bytes.into_inner()
        };
        assert_eq!(decode(&encoded(SIZE.0, SIZE.1)).unwrap().dimensions(), SIZE);
        assert!(decode(&encoded(5_000, 10)).is_err(), "larger than any that was kept");
    }

    #[test]
    fn a_picture_for_phones_is_a_jpeg_of_few_bytes() {
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

    #[test]
    fn only_the_oldest_beyond_the_limit_are_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        for name in 0..3 {
            fs::write(folder.path().join(name.to_string()), "x").unwrap();
        }
        forget_oldest(folder.path());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
        forget_oldest(&folder.path().join("missing"));
    }
}
