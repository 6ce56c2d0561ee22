//! Prepares a scene for drawing: reads, compiles and checks it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Cursor;
use std::mem::take;
use std::path::PathBuf;
use std::sync::Arc;

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Rgba, RgbaImage};
use mariana_assets::TEXTURES;
use mariana_field::graph::FrameInputs;
use mariana_field::lang::{Compiled, Diagnostic, Scene, Sources, Span, TextureRef, nearest};
use mariana_field::region::RegionPlan;
use mariana_field::world::{Alignment, BlendError, BlendKind, TapeBuffers, World};

use super::folder::{Folder, Refusal, ends_with_one_of};
use super::shapes::ShapeCache;
use super::sources::{TextureSource, VIDEO_ENDINGS, find_videos, is_video};
use super::{DraftTexts, FoundMistakes, NumberEdits, SceneError, SceneSource};
use crate::limits::{self, TEXTURE_PIXELS_MAX, TEXTURE_SIDE_MAX};

/// A compiled scene with its tape programs.
#[derive(Debug, Clone)]
pub struct ReadyScene {
    /// The world.
    pub world: Arc<World>,
    /// The tape programs.
    pub buffers: Arc<TapeBuffers>,
    /// The plan for building region trees.
    pub plan: Arc<RegionPlan>,
    /// True if the text is already displayed, and edited numbers now are constants instead of inputs.
    pub settles: bool,
    /// The warnings about the text; empty for a blend.
    pub warnings: Arc<FoundMistakes>,
}

impl ReadyScene {
    /// Prepares a world.
    fn of(world: World) -> Self {
        let buffers = Arc::new(world.tape_buffers());
        let plan = Arc::new(RegionPlan::new(&world));
        Self { world: Arc::new(world), buffers, plan, settles: false, warnings: Arc::default() }
    }

    /// Blends this scene with the scene `to`, which is moved to `alignment`. The default fraction of `to` is
    /// `fraction`, 0..1; each frame can override this.
    ///
    /// # Errors
    /// Fails if the two scenes together exceed a limit.
    pub fn blended(
        &self,
        to: &Self,
        kind: BlendKind,
        alignment: &Alignment,
        fraction: f32,
    ) -> Result<Self, BlendError> {
        Ok(Self::of(World::blend(&self.world, &to.world, kind, alignment, fraction)?))
    }
}

impl SceneSource {
    /// Reads, compiles and prepares a scene.
    ///
    /// # Errors
    /// Fails if a file or image cannot be read, if the text has mistakes (with all diagnostics), or if the scene
    /// exceeds a limit.
    pub fn ready(&self) -> Result<ReadyScene, SceneError> {
        self.ready_with(&mut TextureCache::default(), &mut NumberEdits::default(), &DraftTexts::default()).0
    }

    /// Prepares `text` as if it were the scene's text.
    ///
    /// # Errors
    /// Fails like [`SceneSource::ready`].
    pub fn ready_as(&self, text: &str) -> Result<ReadyScene, SceneError> {
        let compiled = self.compile_as(text, &mut NumberEdits::default(), &DraftTexts::default());
        self.prepare(compiled, &mut TextureCache::default())
    }

    /// Prepares a scene with cached textures. Numbers that `edits` finds changed become inputs, and `drafts` replace
    /// files. Also returns the files that the scene depends on, even after a failure.
    pub fn ready_with(
        &self,
        textures: &mut TextureCache,
        edits: &mut NumberEdits,
        drafts: &DraftTexts,
    ) -> (Result<ReadyScene, SceneError>, Vec<PathBuf>) {
        if let Self::Blend(blend) = self {
            return blend.ready_with(textures, drafts);
        }
        match self.compile_following(edits, drafts) {
            Ok(compiled) => {
                let files = self.files(Some(&compiled));
                let ready = self.prepare(compiled, textures);
                (ready.map(|ready| ReadyScene { settles: edits.settled, ..ready }), files)
            }
            Err(error) => (Err(error), self.files(None)),
        }
    }

    /// Reads and compiles a scene. Fails if the text has mistakes.
    ///
    /// # Errors
    /// Fails like [`SceneSource::ready`].
    pub fn checked(&self) -> Result<Scene, SceneError> {
        self.scene_of(&mut self.compile()?)
    }

    fn scene_of(&self, compiled: &mut Compiled) -> Result<Scene, SceneError> {
        let Compiled { scene, diagnostics, sources, .. } = compiled;
        scene.take().ok_or_else(|| self.mistakes(take(diagnostics), take(sources)))
    }

    /// Reads and compiles a scene, and bakes the texts and pictures that its shapes read.
    ///
    /// # Errors
    /// Fails like [`SceneSource::ready`].
    pub fn baked(&self) -> Result<Scene, SceneError> {
        let mut compiled = self.compile()?;
        let mut scene = self.scene_of(&mut compiled)?;
        let baked = ShapeCache::default().load(self, &mut scene);
        baked.map(|()| scene).map_err(|wrong| self.mistakes(wrong, compiled.sources))
    }

    /// Finds the videos of a compiled scene, loads its textures, and bakes the texts and pictures that its shapes read.
    /// Returns the scene, its textures and its warnings.
    ///
    /// # Errors
    /// Fails if the text has mistakes, with all diagnostics, or if an image or text cannot be read.
    pub fn with_pictures(
        &self,
        mut compiled: Compiled,
        textures: &mut TextureCache,
    ) -> Result<(Scene, Vec<Arc<RgbaImage>>, FoundMistakes), SceneError> {
        let mut scene = self.scene_of(&mut compiled)?;
        find_videos(self.file().map(Folder::of).as_ref(), &mut scene);
        let mut mistakes = |wrong| self.mistakes(wrong, take(&mut compiled.sources));
        let pictures = textures.load(self, &scene).map_err(&mut mistakes)?;
        textures.shapes.load(self, &mut scene).map_err(mistakes)?;
        let warnings = FoundMistakes { diagnostics: compiled.warnings, sources: compiled.sources };
        Ok((scene, pictures, warnings))
    }

    fn prepare(&self, compiled: Compiled, textures: &mut TextureCache) -> Result<ReadyScene, SceneError> {
        let (scene, pictures, mut warnings) = self.with_pictures(compiled, textures)?;
        let world = World::new(&self.name(), scene, pictures)?;
        warnings.diagnostics.extend(world.warning().into_iter().chain(world.feedback_warning()));
        Ok(ReadyScene { warnings: Arc::new(warnings), ..ReadyScene::of(world) })
    }

    fn mistakes(&self, diagnostics: Vec<Diagnostic>, sources: Sources) -> SceneError {
        SceneError::Mistakes { name: self.name(), found: Box::new(FoundMistakes { diagnostics, sources }) }
    }
}

// Loads blends of two scenes.

/// A scene and the camera that shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenScene {
    /// The scene.
    pub source: SceneSource,
    /// Name of a camera. `None` or an unknown name selects the scene's default camera.
    pub camera: Option<String>,
}

/// A transition from one scene to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneBlend {
    /// The outgoing scene.
    pub from: SeenScene,
    /// The incoming scene.
    pub to: SeenScene,
    /// The kind of the blend.
    pub kind: BlendKind,
    /// The time at which both cameras are aligned, in milliseconds of the song.
    pub aligned_at: u64,
}

impl SeenScene {
    fn seen(&self, ready: ReadyScene) -> ReadyScene {
        match camera_number(&ready.world, self.camera.as_deref()) {
            Some(camera) => ReadyScene { world: Arc::new(ready.world.seen_by(camera)), ..ready },
            None => ready,
        }
    }
}

impl SceneBlend {
    /// Blends the two loaded scenes. The last parameter of the blended scene is the fraction of the second scene.
    ///
    /// # Errors
    /// Fails if the two scenes together exceed a limit.
    pub fn of(&self, from: ReadyScene, to: ReadyScene) -> Result<ReadyScene, SceneError> {
        let (from, to) = (self.from.seen(from), self.to.seen(to));
        // Use the cameras' values in silence, because values in music depend on where playback began.
        let camera = |scene: &ReadyScene| {
            let params = scene.world.scene.params.iter().map(|param| param.default).collect();
            let time = self.aligned_at as f32 / 1000.0;
            scene.world.frame_tape.values(&FrameInputs { time, params, ..FrameInputs::default() }).camera
        };
        let alignment = Alignment::of(&camera(&from), &camera(&to));
        Ok(from.blended(&to, self.kind, &alignment, 0.0)?)
    }

    /// Loads and blends both scenes. Also returns the files that the blend depends on.
    pub(super) fn ready_with(
        &self,
        textures: &mut TextureCache,
        drafts: &DraftTexts,
    ) -> (Result<ReadyScene, SceneError>, Vec<PathBuf>) {
        let mut read =
            |seen: &SeenScene| seen.source.ready_with(textures, &mut NumberEdits::default(), drafts);
        let ((from, mut files), (to, others)) = (read(&self.from), read(&self.to));
        files.extend(others);
        (from.and_then(|from| self.of(from, to?)), files)
    }
}

/// Returns the index of the camera with that name in a world.
pub fn camera_number(world: &World, camera: Option<&str>) -> Option<usize> {
    let wanted = camera?;
    world.scene.cameras.iter().position(|(name, _)| name == wanted)
}

// Textures of scenes.
//
// A scene file can use images (PNG and JPEG) and videos only from its own folder. If the folder has no image of that name, the
// shipped image is used, so that a copy of a shipped scene works anywhere. Shipped scenes and formulas can use only
// shipped images.
//
// A texture whose picture changes during the song ([`TextureSource`]) is loaded as a grey image, which stays until the
// first picture comes.

const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The color of a moving texture without a picture: a grey that reflects 18 % of the light.
pub const NEUTRAL: Rgba<u8> = Rgba([118, 118, 118, 255]);
/// Drivers may compile other programs for sides that are powers of two, which sides of videos rarely are.
const NEUTRAL_SIDE: u32 = 6;

/// Loads textures and caches the decoded ones of the last scene. Loading a scene again decodes only changed images
/// and returns the same [`Arc`] for unchanged images.
#[derive(Debug, Default)]
pub struct TextureCache {
    pictures: HashMap<u64, Arc<RgbaImage>>,
    shapes: ShapeCache,
}

impl TextureCache {
    /// Loads the images of [`Scene::textures`] in the same order. Pixels are sRGB with straight alpha, top row first.
    /// Images that this scene does not use are dropped.
    ///
    /// # Errors
    /// Fails with a diagnostic for each image that cannot be read. The diagnostic has the image's position in the
    /// text. The cache keeps the readable images.
    pub fn load(
        &mut self,
        source: &SceneSource,
        scene: &Scene,
    ) -> Result<Vec<Arc<RgbaImage>>, Vec<Diagnostic>> {
        let mut kept = HashMap::new();
        let (mut pictures, mut wrong) = (Vec::new(), Vec::new());
        for texture in &scene.textures {
            match self.picture(source, texture, &mut kept) {
                Ok(picture) => pictures.push(picture),
                Err(diagnostic) => wrong.push(diagnostic),
            }
        }
        self.pictures = kept;
        if wrong.is_empty() {
            return Ok(pictures);
        }
        wrong.sort_by_key(|diagnostic| diagnostic.span);
        Err(wrong)
    }

    fn picture(
        &mut self,
        source: &SceneSource,
        texture: &TextureRef,
        kept: &mut HashMap<u64, Arc<RgbaImage>>,
    ) -> Result<Arc<RgbaImage>, Diagnostic> {
        let mut hasher = DefaultHasher::new();
        if texture.is_last_frame() {
            // The renderer replaces it by its own texture.
            return Ok(Arc::new(RgbaImage::new(NEUTRAL_SIDE, NEUTRAL_SIDE)));
        }
        let bytes = if let Some(of) = TextureSource::of(texture) {
            if of.is_file() {
                let file = source.file().ok_or(Refusal::Missing);
                let found = file.and_then(|file| Folder::of(file).file(&texture.name));
                found.map_err(|refusal| refused(source, &texture.name, texture.span, &refusal))?;
            }
            // Each source has its own image, because textures of equal images are shared.
            of.hash(&mut hasher);
            None
        } else {
            let bytes = image_bytes(source, &texture.name, texture.span)?;
            match &bytes {
                Cow::Owned(bytes) => bytes.hash(&mut hasher),
                // Shipped images never change, so hash only the name.
                Cow::Borrowed(_) => texture.name.hash(&mut hasher),
            }
            Some(bytes)
        };
        let key = hasher.finish();
        let picture = match (kept.get(&key).or_else(|| self.pictures.get(&key)), bytes) {
            (Some(picture), _) => picture.clone(),
            (None, Some(bytes)) => Arc::new(decode(&texture.name, texture.span, &bytes)?),
            (None, None) => Arc::new(RgbaImage::from_pixel(NEUTRAL_SIDE, NEUTRAL_SIDE, NEUTRAL)),
        };
        kept.insert(key, Arc::clone(&picture));
        Ok(picture)
    }
}

/// Reads an image from the scene's folder. Without it, returns the shipped image, which is borrowed.
pub(super) fn image_bytes(
    source: &SceneSource,
    name: &str,
    span: Span,
) -> Result<Cow<'static, [u8]>, Diagnostic> {
    let own = source.file().map(|file| Folder::of(file).bytes(name, limits::TEXTURE_BYTES_MAX));
    match (own, shipped(name)) {
        (Some(Ok(bytes)), _) => Ok(Cow::Owned(bytes)),
        (None | Some(Err(Refusal::Missing)), Some(bytes)) => Ok(Cow::Borrowed(bytes)),
        (None, None) => Err(missing(source, name, span)),
        (Some(Err(refusal)), _) => Err(refused(source, name, span, &refusal)),
    }
}

fn shipped(name: &str) -> Option<&'static [u8]> {
    TEXTURES.get_file(name).map(|file| file.contents())
}

fn shipped_names() -> Vec<String> {
    let mut names: Vec<String> =
        TEXTURES.files().filter_map(|file| Some(file.path().to_str()?.to_owned())).collect();
    names.sort();
    names
}

fn missing(source: &SceneSource, name: &str, span: Span) -> Diagnostic {
    if let SceneSource::Blend(blend) = source {
        return missing(&blend.to.source, name, span);
    }
    let is_video = is_video(name);
    let (shipped, endings) =
        if is_video { (Vec::new(), &VIDEO_ENDINGS[..]) } else { (shipped_names(), &ENDINGS[..]) };
    let (message, advice) = match source {
        SceneSource::File(_) if is_video => {
            (format!("there is no video `{name}` in the scene's folder"), "put the video there".to_owned())
        }
        _ if is_video => (
            format!("`{name}` is a video, and only a scene in a file can use videos"),
            "save the scene as a file next to the video".to_owned(),
        ),
        SceneSource::File(_) => (
            format!("there is no image `{name}` in the scene's folder"),
            format!("put it there, or use a shipped image: {}", shipped.join(", ")),
        ),
        SceneSource::Shipped(_) | SceneSource::Formula(_) | SceneSource::Blend(_) => (
            format!("there is no shipped image `{name}`"),
            format!("use one of {}, or save the scene as a file next to your images", shipped.join(", ")),
        ),
    };
    let mut names = source.file().map_or_else(Vec::new, |file| Folder::of(file).beside(name));
    names.retain(|name| ends_with_one_of(name, endings));
    names.sort();
    let similar = nearest(name, names.iter().chain(&shipped).map(String::as_str));
    Diagnostic::new(span, message).hint(advice).did_you_mean(similar)
}

fn refused(source: &SceneSource, name: &str, span: Span, refusal: &Refusal) -> Diagnostic {
    let is_video = is_video(name);
    let what = if is_video { "video" } else { "image" };
    let message = format!("the {what} `{name}` cannot be read: {refusal}");
    let hint = match refusal {
        Refusal::Missing => return missing(source, name, span),
        Refusal::Leaves | Refusal::LinkOut if is_video => "copy the video into the scene's folder",
        Refusal::Leaves | Refusal::LinkOut => "copy the image into the scene's folder",
        Refusal::NoFile if is_video => "name a video file",
        Refusal::NoFile => "name a PNG or JPEG file",
        Refusal::Unreadable(_) | Refusal::NotText(_) => "check the file's permissions",
        Refusal::TooLarge(_) => "scale it down, or save it with stronger compression",
    };
    let over_limit = matches!(refusal, Refusal::TooLarge(_));
    let kind = if over_limit { Diagnostic::over_limit } else { Diagnostic::new };
    kind(span, message).hint(hint)
}

/// Decodes a PNG or JPEG after checking the size in its header.
pub(super) fn decode(name: &str, span: Span, bytes: &[u8]) -> Result<RgbaImage, Diagnostic> {
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        Ok(other) => {
            let message = format!("`{name}` is an image in the unsupported format {other:?}");
            return Err(Diagnostic::unsupported(span, message).hint("save it as PNG or JPEG"));
        }
        Err(_) => {
            let message = format!("`{name}` is not an image in a known format");
            return Err(Diagnostic::new(span, message).hint("name a PNG or JPEG file"));
        }
    };
    let damaged = |error: image::ImageError| {
        Diagnostic::new(span, format!("the image `{name}` is damaged: {error}")).hint("save it again")
    };
    let mut decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let (side, pixels) = (TEXTURE_SIDE_MAX, TEXTURE_PIXELS_MAX);
    if width > side || height > side || u64::from(width) * u64::from(height) > pixels {
        let message = format!("the image `{name}` is too large: {width} x {height} pixels");
        let hint = format!("scale it down to at most {side} pixels a side and {pixels} in total");
        return Err(Diagnostic::over_limit(span, message).hint(hint));
    }
    // Apply the orientation from the metadata.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    picture.apply_orientation(orientation);
    Ok(picture.into_rgba8())
}
