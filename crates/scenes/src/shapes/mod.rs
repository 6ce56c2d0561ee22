//! Texts and pictures as shapes: grids of signed distances, baked when a scene is loaded.
//!
//! ```text
//! text → fonts → outline ─┐
//! SVG ──────────→ outline ┼→ coverage of fine pixels → distances → flat enough patches → grid
//! PNG, JPEG ──────────────┘
//! ```
//!
//! A text has 64 points per height of a capital letter, a picture 256 points per height; fewer if it is long. Grids are
//! cached by their sources' content, so that an edit elsewhere in a scene is quick.

mod distance;
mod glyphs;
mod lettering;
mod outline;
mod svg;

use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, LazyLock, Mutex};

use image::RgbaImage;
use kurbo::{Affine, Rect};
use mariana_field::graph::{AtlasShape, SHAPE_COLUMNS, ShapeAtlas, ShapeGrid};
use mariana_field::lang::{Diagnostic, Scene, ShapeRef, ShapeSource, Span, TextBaker, nearest};
use mariana_render::system_fonts::SystemFonts;
use mariana_work::lock;

use super::SceneSource;
use super::folder::{Folder, Refusal, ends_with_one_of};
use super::sources::is_video;
use super::world::{decode, image_bytes};
use crate::limits;
use distance::FINER;
use lettering::{Font, Fonts, LINE};
use outline::{Coverage, Filling, Steps, TooMuchWork};
use svg::Drawing;

/// Points of a text's grid per height of a capital letter.
const TEXT_POINTS: f64 = 64.0;
/// Points of a picture's grid per height.
const IMAGE_POINTS: f64 = 256.0;
/// Maximum number of columns of a picture's grid, without its rim.
const IMAGE_COLUMNS_MAX: f64 = 1024.0;
/// Points around a text or picture.
const RIM: usize = 8;
/// Columns and rows of the grid of a song's text, and its points per height of a capital letter.
const SONG_GRID: (usize, usize) = (1024, 224);
const SONG_POINTS: f64 = 64.0;
/// Lines into which a song's text may be broken.
const SONG_LINES_MAX: usize = 3;
/// Endings of font files.
const FONT_ENDINGS: [&str; 4] = ["ttf", "otf", "ttc", "otc"];

/// Bakes texts and pictures, and keeps the grids of the last scene. Loading a scene again bakes only what has changed, and
/// returns the same atlas if nothing has.
#[derive(Debug, Default)]
pub(super) struct ShapeCache {
    kept: Kept,
    last: Option<(Vec<u64>, ShapeAtlas)>,
}

/// What one scene uses, by keys of the content.
#[derive(Debug, Default)]
struct Kept {
    grids: HashMap<u64, ShapeGrid>,
    fonts: HashMap<u64, Arc<Font>>,
}

/// Returns an entry of the current scene, or of the scene before.
fn known<T: Clone>(now: &HashMap<u64, T>, before: &HashMap<u64, T>, key: u64) -> Option<T> {
    now.get(&key).or_else(|| before.get(&key)).cloned()
}

impl TextBaker for Font {
    fn bake(&self, text: &str) -> ShapeGrid {
        song_grid(text, self)
    }
}

/// The fonts of the system, which are read when they are first needed.
fn system_fonts<T>(read: impl FnOnce(&mut SystemFonts) -> T) -> T {
    static FONTS: LazyLock<Mutex<SystemFonts>> = LazyLock::new(Mutex::default);
    read(&mut lock(&FONTS))
}

impl ShapeCache {
    /// Bakes [`Scene::shapes`]. Texts of the song are empty, and get a baker.
    ///
    /// # Errors
    /// Fails with a diagnostic for each text or picture that cannot be baked, with its position in the text.
    pub(super) fn load(&mut self, source: &SceneSource, scene: &mut Scene) -> Result<(), Vec<Diagnostic>> {
        let (mut keys, mut shapes, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
        let before = std::mem::take(&mut self.kept);
        for shape in &mut scene.shapes {
            match self.kept.grid(&before, source, shape) {
                Ok((key, grid)) => {
                    keys.push(key);
                    shapes.push(AtlasShape { grid, changes: changes(&shape.source) });
                }
                Err(diagnostic) => wrong.push(diagnostic),
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        if let Some((last, atlas)) = &self.last
            && *last == keys
        {
            scene.atlas = atlas.clone();
            return Ok(());
        }
        let Some(atlas) = ShapeAtlas::new(shapes) else {
            let span = scene.shapes.first().map(|shape| shape.span).unwrap_or_default();
            let message = "the texts and pictures need more room than there is";
            return Err(vec![Diagnostic::over_limit(span, message).hint("use fewer or shorter ones")]);
        };
        scene.atlas = atlas.clone();
        self.last = Some((keys, atlas));
        Ok(())
    }
}

impl Kept {
    fn grid(
        &mut self,
        before: &Self,
        source: &SceneSource,
        shape: &mut ShapeRef,
    ) -> Result<(u64, ShapeGrid), Diagnostic> {
        let span = shape.span;
        let mut hasher = DefaultHasher::new();
        shape.source.hash(&mut hasher);
        let (font, bytes) = match &shape.source {
            ShapeSource::Text { font, .. } | ShapeSource::Song { font, .. } => {
                let (key, font) = self.font(before, source, font.as_deref(), span)?;
                key.hash(&mut hasher);
                (Some(font), None)
            }
            ShapeSource::Image(name) => {
                let bytes = picture_bytes(source, name, span)?;
                bytes.hash(&mut hasher);
                (None, Some(bytes))
            }
        };
        let key = hasher.finish();
        if let (true, Some(font)) = (changes(&shape.source), &font) {
            shape.baker = Some(font.clone());
        }
        let grid = match (known(&self.grids, &before.grids, key), &shape.source, font, bytes) {
            (Some(grid), ..) => grid,
            (None, ShapeSource::Text { text, .. }, Some(font), _) => text_grid(text, span, &font)?,
            (None, ShapeSource::Image(name), _, Some(bytes)) => image_grid(name, span, &bytes)?,
            _ => no_words(),
        };
        self.grids.insert(key, grid.clone());
        Ok((key, grid))
    }

    /// Returns a font, and a key of its content.
    fn font(
        &mut self,
        before: &Self,
        source: &SceneSource,
        name: Option<&str>,
        span: Span,
    ) -> Result<(u64, Arc<Font>), Diagnostic> {
        let mut hasher = DefaultHasher::new();
        name.hash(&mut hasher);
        let file = name.filter(|name| is_font_file(name));
        let bytes = file.map(|name| font_bytes(source, name, span)).transpose()?;
        bytes.hash(&mut hasher);
        let key = hasher.finish();
        let font = match (known(&self.fonts, &before.fonts, key), name, bytes) {
            (Some(font), ..) => font,
            (None, None, _) => Arc::new(Font::own()),
            (None, Some(name), Some(bytes)) => Arc::new(Font::of(bytes, 0).ok_or_else(|| {
                let message = format!("`{name}` is damaged, or it is no font with outlines");
                Diagnostic::new(span, message).hint("use a TrueType or OpenType font")
            })?),
            (None, Some(name), None) => Arc::new(system_font(name, span)?),
        };
        self.fonts.insert(key, font.clone());
        Ok((key, font))
    }
}

/// Reads a font of the system.
fn system_font(name: &str, span: Span) -> Result<Font, Diagnostic> {
    let found = system_fonts(|fonts| fonts.named(name).ok_or_else(|| fonts.families()));
    let (data, index) = found.map_err(|families| {
        let hint = match nearest(name, families.iter().map(String::as_str)) {
            Some(similar) => {
                format!("did you mean `{similar}`? A font's file in the scene's folder works on every system")
            }
            None => {
                "put the font's file into the scene's folder, and write its name with its ending".to_owned()
            }
        };
        Diagnostic::new(span, format!("this system has no font `{name}`")).hint(hint)
    })?;
    Font::of(data, index).ok_or_else(|| {
        let message = format!("the font `{name}` of this system has no outlines");
        Diagnostic::new(span, message).hint("use another font")
    })
}

/// The file that a shape reads from the scene's folder.
pub(super) fn file_of(shape: &ShapeRef) -> Option<&str> {
    match &shape.source {
        ShapeSource::Image(name) => Some(name),
        ShapeSource::Text { font, .. } | ShapeSource::Song { font, .. } => {
            font.as_deref().filter(|name| is_font_file(name))
        }
    }
}

fn is_font_file(name: &str) -> bool {
    ends_with_one_of(name, &FONT_ENDINGS)
}

fn changes(source: &ShapeSource) -> bool {
    matches!(source, ShapeSource::Song { .. })
}

fn picture_bytes(source: &SceneSource, name: &str, span: Span) -> Result<Cow<'static, [u8]>, Diagnostic> {
    if is_video(name) {
        let message = format!("`{name}` is a video, and a shape needs a picture that does not move");
        let wrong = Diagnostic::unsupported(span, message);
        return Err(wrong.hint("name a PNG, JPEG or SVG file"));
    }
    image_bytes(source, name, span)
}

fn font_bytes(source: &SceneSource, name: &str, span: Span) -> Result<Vec<u8>, Diagnostic> {
    let Some(file) = source.file() else {
        let message = format!("`{name}` is a file, and only a scene in a file can use fonts of its folder");
        return Err(Diagnostic::new(span, message).hint("save the scene as a file next to the font"));
    };
    Folder::of(file).bytes(name, limits::FONT_BYTES_MAX).map_err(|refusal| {
        let kind = if let Refusal::TooLarge(_) = refusal { Diagnostic::over_limit } else { Diagnostic::new };
        let hint = match refusal {
            Refusal::TooLarge(_) => "use a font with fewer letters",
            Refusal::Unreadable(_) | Refusal::NotText(_) => "check the file's permissions",
            Refusal::Leaves | Refusal::LinkOut | Refusal::Missing | Refusal::NoFile => {
                "put the font's file into the scene's folder"
            }
        };
        kind(span, format!("the font `{name}` cannot be read: {refusal}")).hint(hint)
    })
}

/// Bakes one line of text.
fn text_grid(text: &str, span: Span, font: &Font) -> Result<ShapeGrid, Diagnostic> {
    // A damaged font can make its reader panic.
    let line = catch_unwind(AssertUnwindSafe(|| {
        system_fonts(|system| Fonts::for_text(font, text, system)).line(text)
    }));
    let Ok(line) = line else {
        return Err(Diagnostic::new(span, "the font of this text is damaged").hint("use another font"));
    };
    if !line.missing.is_empty() {
        let letters: String = line.missing.iter().collect();
        let message = format!("no font of this system has the letters `{letters}`");
        let hint = "install a font that has them, or write other letters";
        return Err(Diagnostic::new(span, message).hint(hint));
    }
    let Some(bounds) = line.bounds() else {
        return Err(Diagnostic::new(span, "this text draws nothing").hint("write letters that have a shape"));
    };
    // The middle of the line, and of capital letters, is the origin.
    let moved = Affine::translate((-0.5 * line.width, -0.5));
    let bounds = moved.transform_rect_bbox(bounds);
    let half = (bounds.x0.abs().max(bounds.x1.abs()), bounds.y0.abs().max(bounds.y1.abs()));
    let room = (SHAPE_COLUMNS - 1 - 2 * RIM) as f64;
    // A font with towers for letters gets no more points than a picture.
    let per_unit = TEXT_POINTS.min(room / (2.0 * half.0)).min(IMAGE_POINTS / (2.0 * half.1));
    let points = |half: f64| (2.0 * half * per_unit).ceil() as usize + 2 * RIM;
    let size = (points(half.0), points(half.1));
    let coverage = covered(&(moved * line.path), per_unit, size).map_err(|TooMuchWork| {
        Diagnostic::over_limit(span, "the letters of this text have too many edges")
            .hint("use a plainer font, or fewer letters")
    })?;
    distance::grid(&coverage, size, per_unit as f32).ok_or_else(|| {
        Diagnostic::new(span, "this text cannot be drawn").hint("use another font or a shorter text")
    })
}

/// Returns the coverage of a path whose origin is the middle of a grid and whose y points up.
fn covered(path: &kurbo::BezPath, per_unit: f64, size: (usize, usize)) -> Result<Coverage, TooMuchWork> {
    let (width, height) = (FINER * size.0, FINER * size.1);
    let middle = Affine::translate((0.5 * width as f64, 0.5 * height as f64));
    let pixels = middle * Affine::scale(per_unit * FINER as f64) * path;
    Coverage::of(&pixels, Filling::Turning, width, height, &mut Steps(limits::LAYERS_MAX * width * height))
}

/// Bakes a text of the song, broken into lines that fit. Letters that no font has are left out.
fn song_grid(text: &str, font: &Font) -> ShapeGrid {
    let (columns, rows) = SONG_GRID;
    let text: String = text.chars().take(limits::SONG_LETTERS_MAX).collect();
    let text = text.replace(char::is_control, " ");
    let bake = || {
        let fonts = system_fonts(|system| Fonts::for_text(font, &text, system));
        let room = (columns - 2 * RIM) as f64 / SONG_POINTS;
        let whole = fonts.line(text.trim());
        let count = ((whole.width / room).ceil() as usize).clamp(1, SONG_LINES_MAX);
        let lines: Vec<_> = broken(text.trim(), count).into_iter().map(|line| fonts.line(line)).collect();
        let mut path = kurbo::BezPath::new();
        let middle = 0.5 * (lines.len() as f64 - 1.0) * LINE;
        for (number, line) in lines.into_iter().enumerate() {
            let at = (-0.5 * line.width, middle - number as f64 * LINE - 0.5);
            path.extend(Affine::translate(at) * line.path);
        }
        let bounds = kurbo::Shape::bounding_box(&path);
        let tall = (rows - 2 * RIM) as f64 / SONG_POINTS;
        let half = (bounds.x0.abs().max(bounds.x1.abs()), bounds.y0.abs().max(bounds.y1.abs()));
        let scale = (0.5 * room / half.0).min(0.5 * tall / half.1).min(1.0);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        let coverage = covered(&(Affine::scale(scale) * path), SONG_POINTS, SONG_GRID).ok()?;
        distance::grid(&coverage, SONG_GRID, SONG_POINTS as f32)
    };
    // A damaged font can make its reader panic; its text is then empty.
    let baked = (!text.trim().is_empty()).then(|| catch_unwind(AssertUnwindSafe(bake)).ok().flatten());
    baked.flatten().unwrap_or_else(no_words)
}

/// The grid of a song's text without letters.
fn no_words() -> ShapeGrid {
    ShapeGrid::empty(SONG_GRID.0, SONG_GRID.1, SONG_POINTS as f32)
}

/// Breaks a text between words into at most `count` lines of similar lengths.
fn broken(text: &str, count: usize) -> Vec<&str> {
    let letters = text.chars().count();
    let mut lines = Vec::new();
    let mut rest = text;
    for left in (1..=count).rev() {
        let wanted = rest.chars().count().div_ceil(left);
        if left == 1 || letters == 0 {
            break;
        }
        // The break that is nearest to the wanted length.
        let breaks = rest.char_indices().enumerate().filter(|(_, (_, letter))| letter.is_whitespace());
        let Some((_, (at, _))) = breaks.min_by_key(|(number, _)| number.abs_diff(wanted)) else { break };
        let (line, after) = rest.split_at(at);
        lines.push(line.trim());
        rest = after.trim_start();
    }
    lines.push(rest.trim());
    lines.retain(|line| !line.is_empty());
    lines
}

fn image_grid(name: &str, span: Span, bytes: &[u8]) -> Result<ShapeGrid, Diagnostic> {
    let unusable = || {
        let message = format!("the picture `{name}` is too long and narrow for a shape");
        Diagnostic::over_limit(span, message).hint("crop it")
    };
    if svg::is_svg(name, bytes) {
        let refused = |(reason, over_limit): svg::Refused| {
            let kind = if over_limit { Diagnostic::over_limit } else { Diagnostic::new };
            let hint = if over_limit { "simplify the drawing" } else { "save it as a plain SVG with paths" };
            kind(span, format!("the drawing `{name}` cannot be used: {reason}")).hint(hint)
        };
        let drawing = Drawing::of(bytes).map_err(refused)?;
        let Some((size, per_unit)) = size_of(drawing.view.width(), drawing.view.height()) else {
            return Err(unusable());
        };
        let (width, height) = (FINER * size.0, FINER * size.1);
        // The drawing's y points down.
        let view = drawing.view;
        let scale = per_unit * FINER as f64 / view.height();
        let place = Affine::translate((0.5 * width as f64, 0.5 * height as f64))
            * Affine::scale_non_uniform(scale, -scale)
            * Affine::translate(-view.center().to_vec2());
        let coverage = drawing.coverage(place, width, height).map_err(refused)?;
        let coverage = within(coverage, place.transform_rect_bbox(view));
        return distance::grid(&coverage, size, per_unit as f32).ok_or_else(unusable);
    }
    let picture = decode(name, span, bytes)?;
    let Some((size, per_unit)) = size_of(f64::from(picture.width()), f64::from(picture.height())) else {
        return Err(unusable());
    };
    distance::grid(&coverage_of(&picture, size, per_unit), size, per_unit as f32).ok_or_else(unusable)
}

/// Returns the grid's size and its points per height of a picture of this size; `None` if the picture is too long or too
/// narrow.
fn size_of(width: f64, height: f64) -> Option<((usize, usize), f64)> {
    let aspect = width / height;
    let per_unit = IMAGE_POINTS.min(IMAGE_COLUMNS_MAX / aspect);
    let points = |size: f64| (size * per_unit).ceil() as usize;
    let size = (points(aspect), points(1.0));
    let fits = aspect.is_finite() && size.0 >= RIM && size.1 >= RIM;
    fits.then_some(((size.0 + 2 * RIM, size.1 + 2 * RIM), per_unit))
}

/// Uncovers the pixels outside of a rectangle.
fn within(mut coverage: Coverage, view: Rect) -> Coverage {
    for (row, line) in coverage.values.chunks_exact_mut(coverage.width).enumerate() {
        let is_row = (view.y0..view.y1).contains(&(row as f64 + 0.5));
        for (column, value) in line.iter_mut().enumerate() {
            if !is_row || !(view.x0..view.x1).contains(&(column as f64 + 0.5)) {
                *value = 0.0;
            }
        }
    }
    coverage
}

/// Returns the opacity of a picture if it is transparent anywhere, else its brightness, in the middle of the fine pixels
/// of a grid.
fn coverage_of(picture: &RgbaImage, size: (usize, usize), per_unit: f64) -> Coverage {
    let is_opaque = picture.pixels().all(|pixel| pixel.0[3] == 255);
    let solid = |pixel: [u8; 4]| {
        let [red, green, blue, alpha] = pixel.map(|channel| f32::from(channel) / 255.0);
        if is_opaque { 0.2126 * red + 0.7152 * green + 0.0722 * blue } else { alpha }
    };
    let plane: Vec<f32> = picture.pixels().map(|pixel| solid(pixel.0)).collect();
    let (across, down) = (picture.width() as usize, picture.height() as usize);
    let at = |x: usize, y: usize| plane.get(y * across + x).copied().unwrap_or_default();
    let (width, height) = (FINER * size.0, FINER * size.1);
    let pixels_per_pixel = f64::from(picture.height()) / (per_unit * FINER as f64);
    // An edge between two pixels of a small picture is as sharp as one between two fine pixels.
    let contrast = (1.0 / pixels_per_pixel).max(1.0) as f32;
    let mut coverage = Coverage::none(width, height);
    for (row, line) in coverage.values.chunks_exact_mut(width).enumerate() {
        // The grid's rows go up, and the picture's rows go down.
        let y = 0.5 * down as f64 - (row as f64 + 0.5 - 0.5 * height as f64) * pixels_per_pixel;
        for (column, value) in line.iter_mut().enumerate() {
            let x = 0.5 * across as f64 + (column as f64 + 0.5 - 0.5 * width as f64) * pixels_per_pixel;
            let mean = mean(&at, x, y, pixels_per_pixel, across, down);
            *value = (0.5 + (mean - 0.5) * contrast).clamp(0.0, 1.0);
        }
    }
    coverage
}

/// Returns the mean of a square of pixels around a place, of at least one pixel; 0 outside of the picture.
fn mean(at: &impl Fn(usize, usize) -> f32, x: f64, y: f64, side: f64, width: usize, height: usize) -> f32 {
    let half = 0.5 * side.max(1.0);
    let range = |middle: f64, count: usize| {
        let (low, high) = (middle - half, middle + half);
        let pixels = low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(count);
        pixels.map(move |pixel| (pixel, high.min((pixel + 1) as f64) - low.max(pixel as f64)))
    };
    let mut sum = 0.0;
    for (row, tall) in range(y, height) {
        for (column, wide) in range(x, width) {
            sum += f64::from(at(column, row)) * tall * wide;
        }
    }
    (sum / (4.0 * half * half)) as f32
}

#[cfg(test)]
mod tests;
