//! `mariana still`: one moment of a song as an image file.

use std::io::Cursor;
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::{ColorType, ImageFormat};

use super::alpha::straight;
use super::error::{ExportError, refuse};
use super::output::{Output, is_folder, refuse_the_song, write_standard};
use super::painter::{SceneChoice, held_of};
use super::panorama;
use super::path_store::{PathStore, SharedStore};
use super::paths::PathWatch;
use super::show_painter::ShowPainter;
use super::showing::Showing;
use super::shutter::Shutter;
use super::song_features::SongFeatures;
use crate::atomic_file::AtomicFile;
use crate::frame::held_inputs::Setting;
use crate::frame::{Frame, FrameOptions};
use crate::probing::{Scenery, ray_diagram};
use crate::scenes::{ReadyScene, SceneSource};
use mariana_field::world::{Alignment, BlendKind};
use mariana_music::{Gain, Sound};
use mariana_player::song::Song;

/// Options of a still.
#[derive(Debug, Clone)]
pub struct StillRequest {
    /// The song.
    pub song: Song,
    /// The moment, in seconds.
    pub at: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Automatic gain.
    pub gain: Gain,
    /// The image file, whose extension selects PNG, JPEG or WebP.
    pub output: Output,
    /// The scene.
    pub scene: SceneChoice,
    /// The show to draw instead of the scene.
    pub show: Option<Showing>,
    /// A second scene, blended with the first.
    pub blend: Option<Blend>,
    /// Inputs that are held at a value.
    pub set: Vec<Setting>,
    /// The pixel whose ray is drawn as a diagram over the image, from the upper left corner.
    pub ray: Option<(u32, u32)>,
    /// The shutter, for an image that is shown for [`STILL_SECONDS`].
    pub shutter: Shutter,
}

impl StillRequest {
    /// A still of a scene without further options.
    pub fn of(song: Song, at: f64, size: (u32, u32), scene: SceneChoice, output: Output) -> Self {
        Self {
            song,
            at,
            size,
            gain: Gain::default(),
            output,
            scene,
            show: None,
            blend: None,
            set: Vec::new(),
            ray: None,
            shutter: Shutter::MOMENT,
        }
    }
}

/// The time for which a still's shutter is open at 360 degrees: a frame of a video with 60 frames a second.
pub const STILL_SECONDS: f64 = 1.0 / 60.0;

/// A second scene, and its fraction in the blend with the first scene.
#[derive(Debug, Clone)]
pub struct Blend {
    /// The scene.
    pub into: SceneSource,
    /// Kind of the blend.
    pub kind: BlendKind,
    /// Fraction of the second scene, 0..1; 0 and 1 show a single scene.
    pub fraction: f32,
}

impl Blend {
    fn of(&self, from: ReadyScene, at: f64, sound: &Sound) -> Result<ReadyScene, ExportError> {
        if self.fraction <= 0.0 {
            return Ok(from);
        }
        let to = self.into.ready()?;
        if self.fraction >= 1.0 {
            return Ok(to);
        }
        let camera = |scene: &ReadyScene| Frame::new(&scene.world, at, sound.clone(), (1, 1)).values.camera;
        let alignment = Alignment::of(&camera(&from), &camera(&to));
        Ok(from.blended(&to, self.kind, &alignment, self.fraction)?)
    }
}

/// Draws and writes the still. All runs on one machine give the same bytes. `watch` receives the progress of a still by
/// paths of light. If `watch` ends the still early, or something ends the process, the next call with the same request
/// continues the paths.
///
/// # Errors
/// Fails if the song or a scene cannot be read, the driver reports an error, or the output cannot be written.
pub fn write_still(request: &StillRequest, watch: PathWatch) -> Result<(), ExportError> {
    // Create the file first, so that an unwritable file is reported before the work.
    let (format, file) = match &request.output {
        Output::Path(path) => {
            let format = format_of(path)?;
            if request.scene.alpha && format == ImageFormat::Jpeg {
                return refuse_alpha(&request.output, "a name that ends in .png or .webp");
            }
            refuse_the_song(&request.song, path)?;
            (format, Some(AtomicFile::create(path)?))
        }
        Output::Standard => (ImageFormat::Png, None),
    };
    let store = match (&request.output, request.scene.paths) {
        (Output::Path(path), Some(_)) => {
            Some(PathStore::shared(path, &request.song, request.at, request.size, watch.save_every)?)
        }
        _ => None,
    };
    let rgba = drawn(request, watch, store.clone())?;
    let pixels = Pixels::of(&rgba, request.scene.alpha);
    let bytes =
        panorama::marked(pixels.encoded(format, request.size)?, &request.scene.projection, request.size);
    match file {
        Some(file) => file.write(&bytes)?,
        None => write_standard(&bytes).map(|_| ())?,
    }
    store.iter().for_each(|store| store.borrow().finish());
    Ok(())
}

fn drawn(
    request: &StillRequest,
    watch: PathWatch,
    store: Option<SharedStore>,
) -> Result<Vec<u8>, ExportError> {
    let (width, height) = request.size;
    if let Some((x, y)) = request.ray.filter(|(x, y)| *x >= width || *y >= height) {
        return refuse(format!(
            "the pixel {x},{y} is outside the image of {width}x{height} pixels: choose a pixel, counted from 0,0 at \
             the upper left"
        ));
    }
    let mut song = SongFeatures::open_with(&request.song, request.at, request.gain)?;
    let mut sound = song.require(request.at)?;
    let (mut painter, scene) = match &request.show {
        Some(show) => {
            let prepared_show = show.prepared_show(&mut song, request.at)?;
            (ShowPainter::open(&request.scene, prepared_show, &request.set)?, None)
        }
        None => {
            let mut ready = request.scene.source.ready()?;
            if let Some(blend) = &request.blend {
                ready = blend.of(ready, request.at, &sound)?;
            }
            (ShowPainter::of_scene(&request.scene, ready.clone(), &request.set)?, Some(ready))
        }
    };
    painter.graphs().for_each(|graph| song.know_for(graph));
    painter.headless_renderer.set_song(&song)?;
    painter.headless_renderer.watch_paths(watch, store);
    sound = song.placed(request.at, sound);
    let held = painter.held_at(&mut song, request.at, request.at)?;
    let exposures = request.shutter.exposures(&mut song, request.at, sound.clone(), STILL_SECONDS)?;
    painter.draw(request.at, exposures, held, request.size)?;
    let mut rgba = painter.read();
    if let Some(((x, y), ready)) = request.ray.zip(scene) {
        let held = held_of(&ready.world.scene, &request.set)?;
        let options = FrameOptions { params: &[], held: &held, camera: None };
        let frame = Frame::staged(&ready.world, request.at, sound, request.size, &options);
        let middle = |pixel: u32, side: u32| (f64::from(pixel) + 0.5) / f64::from(side);
        let scenery = Scenery::new(request.scene.source.clone(), ready, frame);
        let at = [middle(x, width), middle(y, height)];
        if let Some(diagram) = ray_diagram(&scenery, at, request.size, &|| true) {
            diagram.draw_over(&mut rgba);
        }
    }
    Ok(rgba)
}

/// JPEG quality from 1 to 100. At this quality, differences are invisible at full size.
const JPEG_QUALITY: u8 = 93;

/// Returns the format that the path's extension names; PNG for a path without an extension.
fn format_of(path: &Path) -> Result<ImageFormat, ExportError> {
    if is_folder(path) {
        return refuse(format!(
            "{} is a folder, but a still is one file: give -o a name that ends in .png or .jpg or .webp",
            path.display()
        ));
    }
    let Some(ending) = path.extension() else { return Ok(ImageFormat::Png) };
    // The image crate also knows the ending of moving PNGs.
    match ImageFormat::from_extension(ending).filter(|_| !ending.eq_ignore_ascii_case("apng")) {
        Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) => Ok(format),
        _ => refuse(format!(
            "{} cannot be written: stills are PNGs, JPEGs or WebPs, so give -o a name that ends in .png or .jpg \
                 or .webp",
            path.display()
        )),
    }
}

/// Refuses a transparent image in a format that does not support it.
pub(super) fn refuse_alpha<T>(output: &Output, instead: &str) -> Result<T, ExportError> {
    refuse(format!("{output} cannot be transparent, which --alpha requires: give -o {instead}"))
}

pub(super) struct Pixels {
    bytes: Vec<u8>,
    has_alpha: bool,
}

impl Pixels {
    /// Converts RGBA bytes: to straight colours if they are premultiplied, or else to RGB.
    pub(super) fn of(rgba: &[u8], has_alpha: bool) -> Self {
        let bytes = match has_alpha {
            true => straight(rgba),
            false => rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        };
        Self { bytes, has_alpha }
    }

    /// Encodes the image. A WebP is lossless.
    fn encoded(&self, format: ImageFormat, size: (u32, u32)) -> Result<Vec<u8>, ExportError> {
        let (width, height) = size;
        let color = if self.has_alpha { ColorType::Rgba8 } else { ColorType::Rgb8 };
        let mut file = Cursor::new(Vec::new());
        if format == ImageFormat::Jpeg {
            let mut encoder = JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY);
            encoder.encode(&self.bytes, width, height, color.into())?;
        } else {
            image::write_buffer_with_format(&mut file, &self.bytes, width, height, color, format)?;
        }
        Ok(file.into_inner())
    }

    pub(super) fn write_png(&self, path: &Path, size: (u32, u32)) -> Result<(), ExportError> {
        Ok(AtomicFile::create(path)?.write(&self.encoded(ImageFormat::Png, size)?)?)
    }
}

/// Encodes an opaque RGBA image, top row first, as a PNG without alpha.
///
/// # Errors
/// [`ExportError::Encode`] if the number of bytes does not fit the size.
pub fn png(rgba: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ExportError> {
    Pixels::of(rgba, false).encoded(ImageFormat::Png, size)
}
