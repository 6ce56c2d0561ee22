//! Errors of exports: stills, videos, analyses and measurements.

use std::path::PathBuf;

use crate::atomic_file::Unwritable;
use crate::frame::held_inputs::OutOfRange;
use crate::gpu::error::GpuError;
use crate::scenes::SceneError;
use crate::show::ShowError;
use mariana_field::world::{BlendError, WorldError};
use mariana_player::decode::DecodeError;

/// An error of an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The song cannot be decoded.
    #[error(transparent)]
    Decode(#[from] DecodeError),
    /// The frame cannot be drawn.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene cannot be read or has mistakes.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene cannot be prepared.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Two scenes cannot be blended.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// The requested moment is after the song's end.
    #[error("{name} ends at {end:.2} s: choose a time before the end instead of {asked} s")]
    AfterTheEnd {
        /// The song.
        name: String,
        /// The requested time, in seconds.
        asked: f64,
        /// The song's length, in seconds.
        end: f64,
    },
    /// The output cannot be written.
    #[error("{} cannot be written ({reason}): choose another path with -o; no file was changed", .path.display())]
    Unwritable {
        /// The output.
        path: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// A temporary file cannot be written: an input for ffmpeg, ffmpeg's messages or the frames of a loop's seam.
    #[error(
        "temporary files cannot be written in {} ({reason}): set TMPDIR to a folder with enough space",
        .folder.display()
    )]
    Temporary {
        /// The folder for temporary files.
        folder: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// The output is the song itself.
    #[error("{} is the song itself: choose another path with -o", .path.display())]
    OverTheSong {
        /// The output.
        path: PathBuf,
    },
    /// The song cannot be read.
    #[error("the song cannot be read ({reason}): check its path and permissions")]
    UnreadableSong {
        /// The system's error.
        reason: String,
    },
    /// A video that cannot be rendered in parts.
    #[error("{reason} cannot be rendered in parts: {instead}")]
    NotInParts {
        /// The obstacle.
        reason: &'static str,
        /// The remedy.
        instead: &'static str,
    },
    /// A part without frames.
    #[error("the video has only {total} frames, too few for {parts} parts: choose fewer parts with --part")]
    EmptyPart {
        /// Frames of the video.
        total: u64,
        /// The number of parts.
        parts: u64,
    },
    /// Parts cannot be joined into this output.
    #[error("parts cannot be joined into {output}: give -o a name that ends in .mp4, .mkv, .mov or .webm")]
    JoinFormat {
        /// The output.
        output: String,
    },
    /// No parts were given.
    #[error("there are no parts to join: name their files after --join")]
    NoParts,
    /// A part that cannot be read.
    #[error("{} cannot be read ({reason}): check the name of the part", .path.display())]
    UnreadablePart {
        /// The file.
        path: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// A file that is no part.
    #[error("{} is no finished part of a video: name files that 'mariana video --part' has written, and let unfinished parts finish", .path.display())]
    NoPart {
        /// The file.
        path: PathBuf,
    },
    /// The output is one of the parts.
    #[error("{} is one of the parts: choose another path with -o", .path.display())]
    OverThePart {
        /// The output.
        path: PathBuf,
    },
    /// Parts of different videos.
    #[error(
        "{} has {difference} than {}: render it again with the flags of the other parts",
        .path.display(),
        .other.display()
    )]
    OtherPart {
        /// A part.
        path: PathBuf,
        /// The first part.
        other: PathBuf,
        /// What differs.
        difference: &'static str,
    },
    /// A part is missing.
    #[error("part {number} of {of} is missing: render it with --part {number}/{of}, or name its file")]
    MissingPart {
        /// The number of the part.
        number: u64,
        /// The number of parts.
        of: u64,
    },
    /// A part was named twice.
    #[error("two files are part {number}: name each part once")]
    TwicePart {
        /// The number of the part.
        number: u64,
    },
    /// The song is not the song of the parts.
    #[error("the parts were made for another song: name the song from which they were rendered")]
    OtherSong,
    /// A still in an unsupported format.
    #[error(
        "{} cannot be written: stills are PNGs, JPEGs or WebPs, so give -o a name that ends in .png or .jpg or .webp",
        .path.display()
    )]
    StillFormat {
        /// The output.
        path: PathBuf,
    },
    /// The pixel of a ray is outside the image.
    #[error(
        "the pixel {x},{y} is outside the image of {width}x{height} pixels: choose a pixel, counted from 0,0 at the upper left"
    )]
    RayOutside {
        /// Column of the pixel.
        x: u32,
        /// Row of the pixel.
        y: u32,
        /// Width of the image.
        width: u32,
        /// Height of the image.
        height: u32,
    },
    /// A setting names an input that no scene has.
    #[error("no input is called '{name}': choose one of {inputs} for --set")]
    NoInput {
        /// The name.
        name: String,
        /// The names of all inputs.
        inputs: String,
    },
    /// A value outside an input's range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// No scene is shown at the start of the video.
    #[error(
        "the video begins at {start} s, but its first scene begins at {from} s: give this scene an earlier time"
    )]
    NothingAtFirst {
        /// Start of the first scene, in seconds.
        from: f64,
        /// Start of the video, in seconds.
        start: f64,
    },
    /// The rest of the song is too short for a loop.
    #[error(
        "a loop of {length} s and its seam need {needed:.2} s of the song, but only {left:.2} s are left: choose an \
         earlier --start or a shorter --duration"
    )]
    LoopTooLong {
        /// Requested length of the loop, in seconds.
        length: f64,
        /// Length of song that the loop and its seam need, in seconds.
        needed: f64,
        /// Length of the song after the start of the loop, in seconds.
        left: f64,
    },
    /// The system cannot start a thread.
    #[error("no thread can be started ({0}): close other programs")]
    Thread(std::io::Error),
    /// The image encoder reported an error.
    #[error("the image could not be encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// Transparency was requested for a scene that draws its own sky.
    #[error(
        "--alpha leaves out the sky, but the scene {scene} draws its own: remove the `color` of its `sky`"
    )]
    OwnSky {
        /// The scene.
        scene: String,
    },
    /// Transparency was requested in a format that does not support it.
    #[error("{output} cannot be transparent, which --alpha requires: give -o {instead}")]
    NoAlpha {
        /// The output.
        output: String,
        /// A valid output.
        instead: &'static str,
    },
    /// A codec that the video's format does not support.
    #[error(
        "{} does not support {codec}: choose {takes} with --codec, or give -o a name that ends in .mp4 or .mkv",
        .path.display()
    )]
    CodecFormat {
        /// The output.
        path: PathBuf,
        /// The requested codec.
        codec: &'static str,
        /// The codecs that the format supports.
        takes: &'static str,
    },
    /// ffmpeg is not installed.
    #[error(
        "a video needs ffmpeg, which was not found ({0}): install ffmpeg, or give -o a folder ending in '/' for stills"
    )]
    NoEncoder(std::io::Error),
    /// ffmpeg failed.
    #[error(
        "ffmpeg could not write {} ({message}): give -o a path with enough space and a name that ends in .mp4, .mkv \
         or .mov", .path.display()
    )]
    Encoder {
        /// The output.
        path: PathBuf,
        /// The last message of ffmpeg.
        message: String,
    },
    /// ffmpeg made no progress and was killed.
    #[error(
        "ffmpeg made no progress for {seconds:.0} s while writing {} and was stopped: check the disk, or choose \
         another codec by --codec", .path.display()
    )]
    EncoderStalled {
        /// The output.
        path: PathBuf,
        /// Time without progress, in seconds.
        seconds: f64,
    },
    /// A codec was given for a GIF or a WebP, which have no choice of codecs.
    #[error(
        "{} has no choice of codecs: leave out --codec, or give -o a name that ends in .mp4 or .mkv", .path.display()
    )]
    OwnCodec {
        /// The output.
        path: PathBuf,
    },
    /// A frame rate above the format's maximum.
    #[error("{} shows at most {max} frames a second, not {fps}: give --fps {max} or less", .path.display())]
    FrameRate {
        /// The output.
        path: PathBuf,
        /// The requested rate.
        fps: f64,
        /// The format's maximum.
        max: f64,
    },
    /// The show cannot be prepared.
    #[error(transparent)]
    Show(#[from] ShowError),
    /// A timeline names a scene without a source.
    #[error("the show has no scene {scene}: this is a bug in Mariana; report it")]
    NotInShow {
        /// The scene.
        scene: String,
    },
    /// Standard output is closed or full.
    #[error("the results cannot be printed ({0}): send them to another file or program")]
    Print(std::io::Error),
}

impl From<Unwritable> for ExportError {
    fn from(Unwritable { path, reason, .. }: Unwritable) -> Self {
        Self::Unwritable { path, reason }
    }
}
