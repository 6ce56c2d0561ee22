//! Pictures of the show, saved as PNGs without panels.
//!
//! The next frame is drawn in the size and quality of the picture, with everything that belongs to the show: fades,
//! brightness and the limit of flashes. The frame is read back without waiting, and another thread encodes and writes
//! the picture.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use mariana_work::{Awaited, once};

use super::waker::Waker;
use crate::atomic_file::AtomicFile;
use crate::clock;
use crate::export::still::png;
use crate::file_names::plain_name;
use crate::gpu::{Gl, GpuError, PictureReader, Renderer};
use crate::limits;
use crate::placement::Placement;
use crate::session::drawing_pace::drawn_size;
use crate::session::dynamic_resolution::Level;

/// Interval at which a picture that is being read back is looked for.
const LOOK: Duration = Duration::from_millis(3);
/// Number of looks at the end of the session, about a second.
const LOOKS_MAX: usize = 330;

#[derive(Default)]
pub(super) struct Pictures {
    wanted: Option<Wanted>,
    pub(super) reading: Option<(PictureReader, PathBuf)>,
    /// Messages about the pictures that are being written.
    writing: Vec<Awaited<String>>,
}

#[derive(Clone, Copy)]
struct Wanted {
    /// Size of the picture relative to the window.
    scale: u32,
    /// Time at which the wish is given up, because no frame can be drawn.
    until: Instant,
}

impl Pictures {
    /// Returns the level and size of the next frame, for a window of `whole` pixels: those of a wanted picture, if any.
    pub(super) fn level(&self, level: Level, whole: (u32, u32), side_max: u32) -> (Level, (u32, u32)) {
        match self.wanted {
            None => (level, drawn_size(level, whole, side_max)),
            Some(wanted) => (Level::STILL, wanted.size(whole, side_max)),
        }
    }

    /// Waits until all pictures are written. The driver gets a second to hand over the last one.
    pub(super) fn finish(&mut self, waker: &Waker) {
        for _ in 0..LOOKS_MAX {
            if self.reading.is_none() {
                break;
            }
            self.update(clock::now(), waker);
            std::thread::sleep(LOOK);
        }
        self.writing.drain(..).for_each(|mut picture| drop(picture.within(Duration::MAX)));
    }

    /// Asks for a picture of the present frame at `scale` times the size of the window.
    pub(super) fn request(&mut self, scale: u32) {
        let until = clock::now() + Duration::from_secs_f64(2.0 * limits::PICTURE_SECONDS_MAX);
        self.wanted = Some(Wanted { scale, until });
    }

    /// Reads back the finished frame if a picture is wanted. `whole` is the size of the window, and `file` the path of
    /// the picture.
    ///
    /// # Errors
    /// Fails with a message.
    pub(super) fn save(
        &mut self,
        gl: &Gl,
        renderer: &mut Renderer,
        whole: (u32, u32),
        file: impl FnOnce() -> Option<PathBuf>,
    ) -> Result<(), String> {
        let Some(wanted) = self.wanted.take() else { return Ok(()) };
        let file = file().ok_or("there is no folder for pictures: set XDG_PICTURES_DIR or HOME")?;
        let size = wanted.size(whole, gl.info().texture_side_max);
        let reader =
            read(gl, renderer, size).map_err(|error| format!("the picture was not saved: {error}"))?;
        self.reading = reader.map(|reader| (reader, file));
        Ok(())
    }

    /// Writes a picture that has been read back. Returns when to call again, and messages about pictures.
    pub(super) fn update(&mut self, now: Instant, waker: &Waker) -> (Option<Instant>, Vec<String>) {
        let mut messages = Vec::new();
        if self.wanted.take_if(|wanted| wanted.until < now).is_some() {
            messages.push("the picture was not saved: no frame could be drawn".to_owned());
        }
        if let Some((reader, file)) = &mut self.reading
            && let Some(rgba) = reader.drain()
        {
            let (size, file) = (reader.size(), std::mem::take(file));
            self.reading = None;
            match once("picture", waker.waking(), move || write(&rgba, size, &file)) {
                Ok(picture) => self.writing.push(picture),
                Err(error) => messages.push(format!("the picture was not saved: {error}")),
            }
        }
        messages.extend(self.writing.iter_mut().filter_map(|picture| picture.poll()?.ok()));
        self.writing.retain(Awaited::is_awaited);
        (self.reading.is_some().then(|| now + LOOK), messages)
    }
}

impl Wanted {
    fn size(self, whole: (u32, u32), side_max: u32) -> (u32, u32) {
        let (width, height) = whole;
        let side = |side: u32| side.saturating_mul(self.scale);
        drawn_size(Level::STILL, (side(width), side(height)), side_max)
    }
}

fn read(gl: &Gl, renderer: &mut Renderer, size: (u32, u32)) -> Result<Option<PictureReader>, GpuError> {
    let mut reader = PictureReader::new(gl, size)?;
    let whole = Placement::default();
    let is_sent = renderer.send_placed(&mut reader, &whole.map(), whole.part())?;
    Ok(is_sent.then_some(reader))
}

/// Returns a message about the written picture.
fn write(rgba: &[u8], size: (u32, u32), file: &std::path::Path) -> String {
    let written = png(rgba, size).map_err(|error| error.to_string()).and_then(|bytes| {
        AtomicFile::create_with_folder(file)
            .and_then(|file| file.write_beside(&bytes))
            .map_err(|error| format!("{error}; {}", error.remedy()))
    });
    match written {
        Ok(file) => format!("saved as {}", file.display()),
        Err(error) => format!("the picture was not saved: {error}"),
    }
}

/// A name such as "Song 1.23.png" for a picture at `time` seconds.
pub(super) fn picture_name(title: &str, time: f64) -> PathBuf {
    let seconds = time.max(0.0) as u64;
    let name = plain_name(&format!("{title} {}.{:02}", seconds / 60, seconds % 60), "picture");
    PathBuf::from(name + ".png")
}
