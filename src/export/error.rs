//! What can go wrong with an export. Each message says what, where and what to do.

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
    /// The picture cannot be drawn.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene cannot be read or has mistakes.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene cannot be made ready.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Two scenes cannot be blended.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// A moment after the song's end.
    #[error("{name} ends at {end:.2} s: choose a time before that instead of {asked} s")]
    AfterTheEnd {
        /// The song.
        name: String,
        /// The time that was asked for, in seconds.
        asked: f64,
        /// The song's length, in seconds.
        end: f64,
    },
    /// The output cannot be written.
    #[error("{} cannot be written ({reason}): choose another place with -o; nothing there was changed", .path.display())]
    Unwritable {
        /// The output.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// ffmpeg's temporary input, the file of its messages or the frames of a loop's seam cannot be written.
    #[error(
        "temporary files cannot be written in {} ({reason}): set TMPDIR to a folder with enough space",
        .folder.display()
    )]
    Temporary {
        /// The folder for temporary files.
        folder: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The output is the song itself.
    #[error("{} is the song itself: choose another place with -o", .path.display())]
    OverTheSong {
        /// The output.
        path: PathBuf,
    },
    /// A still in a format that is not written.
    #[error(
        "{} cannot be written: stills are PNGs, JPEGs or WebPs, so give -o a name that ends in .png or .jpg or .webp",
        .path.display()
    )]
    StillFormat {
        /// The output.
        path: PathBuf,
    },
    /// An input that no scene has.
    #[error("there is no input '{name}' to --set: choose one of {inputs}")]
    NoInput {
        /// The name that was given.
        name: String,
        /// The names that there are.
        inputs: String,
    },
    /// A value that an input cannot have.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// Nothing was asked to be shown at the start.
    #[error(
        "the first scene begins at {from} s, but the video at {start} s: give that scene an earlier time, or none"
    )]
    NothingAtFirst {
        /// When the first scene begins, in seconds.
        from: f64,
        /// When the video begins, in seconds.
        start: f64,
    },
    /// Too little sound for a loop.
    #[error(
        "a loop of {length} s and its seam take {needed:.2} s of the song, but only {left:.2} s are left: choose an \
         earlier --start or a shorter --duration"
    )]
    LoopTooLong {
        /// How long the loop should be, in seconds.
        length: f64,
        /// How much of the song it takes, in seconds.
        needed: f64,
        /// How much of the song there is from its start, in seconds.
        left: f64,
    },
    /// The system has no thread for the work.
    #[error("no thread can be started ({0}): end other programs")]
    Thread(std::io::Error),
    /// A picture that the encoder refuses.
    #[error("the picture could not be encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// A scene with a sky, which leaves nothing transparent.
    #[error(
        "--alpha leaves out the sky, but the scene {scene} has one of its own: give its `sky` no `color`"
    )]
    OwnSky {
        /// The scene.
        scene: String,
    },
    /// Transparency in a format that has none.
    #[error("{output} cannot hold what --alpha leaves transparent: give -o {instead}")]
    NoAlpha {
        /// The output.
        output: String,
        /// What to give instead.
        instead: &'static str,
    },
    /// A codec that the video's format cannot hold.
    #[error(
        "{} cannot hold {codec}: choose one of {takes} by --codec, or give -o a name that ends in .mp4 or .mkv",
        .path.display()
    )]
    CodecFormat {
        /// The output.
        path: PathBuf,
        /// The codec that was asked for.
        codec: &'static str,
        /// What the format can hold.
        takes: &'static str,
    },
    /// ffmpeg is not installed.
    #[error(
        "a video needs ffmpeg, which was not found ({0}): install it, or give -o a folder that ends in '/' to write stills"
    )]
    NoEncoder(std::io::Error),
    /// ffmpeg gave up.
    #[error(
        "ffmpeg could not write {} ({message}): give -o a place with enough space and a name that ends in .mp4, .mkv \
         or .mov", .path.display()
    )]
    Encoder {
        /// The output.
        path: PathBuf,
        /// Its last words.
        message: String,
    },
    /// ffmpeg made no progress and was ended.
    #[error(
        "ffmpeg did nothing for {seconds:.0} s while it wrote {} and was ended: check the disk, or choose another codec \
         by --codec", .path.display()
    )]
    EncoderStalled {
        /// The output.
        path: PathBuf,
        /// How long it was waited for, in seconds.
        seconds: f64,
    },
    /// A codec for a GIF or a WebP.
    #[error(
        "{} takes no codec: leave out --codec, or give -o a name that ends in .mp4 or .mkv", .path.display()
    )]
    OwnCodec {
        /// The output.
        path: PathBuf,
    },
    /// More pictures a second than the format can show.
    #[error("{} shows at most {max} pictures a second, not {fps}: give --fps {max} or less", .path.display())]
    FrameRate {
        /// The output.
        path: PathBuf,
        /// The rate that was asked for.
        fps: f64,
        /// The format's highest rate.
        max: f64,
    },
    /// A show cannot be made.
    #[error(transparent)]
    Show(#[from] ShowError),
    /// A plan names a scene that nobody gave.
    #[error("the show has no scene {scene}: this is a bug in Mariana; report it")]
    NotInShow {
        /// The scene.
        scene: String,
    },
    /// Standard output is gone or full.
    #[error("the results cannot be printed ({0}): send them somewhere else")]
    Print(std::io::Error),
}

impl From<Unwritable> for ExportError {
    fn from(Unwritable { path, reason }: Unwritable) -> Self {
        Self::Unwritable { path, reason }
    }
}
