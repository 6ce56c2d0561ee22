//! ffmpeg's arguments for codecs, quality and colours, and checks that a file format supports them.

use std::path::Path;

use super::request::VideoRequest;
use super::spherical::is_marked;
use crate::config::Choice;
use crate::export::error::{ExportError, refuse};
use crate::export::output::{Output, is_folder};
use crate::export::still::refuse_alpha;

/// Video codecs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Codec {
    /// H.264, which plays everywhere.
    H264,
    /// H.265, with half the bytes of H.264.
    H265,
    /// VP9, for webm.
    Vp9,
    /// AV1, with the smallest files and the slowest encoding.
    Av1,
}

impl Choice for Codec {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::H264, "h264", "Plays everywhere"),
        (Self::H265, "h265", "Half the bytes of h264"),
        (Self::Vp9, "vp9", "For webm"),
        (Self::Av1, "av1", "The smallest files, and the slowest encoding"),
    ];
}

impl Codec {
    /// ffmpeg's arguments, and the constant rate factor for each [`EncodingQuality`]. Higher factors give fewer bytes.
    /// Factors of the same place give about the same quality.
    fn encoding(self) -> (&'static [&'static str], [&'static str; 4]) {
        match self {
            Self::H264 => (&["-c:v:0", "libx264", "-profile:v:0", "high"], ["28", "23", "18", "12"]),
            Self::H265 => {
                (&["-c:v:0", "libx265", "-x265-params", "log-level=error"], ["31", "26", "21", "15"])
            }
            Self::Vp9 => (&["-c:v:0", "libvpx-vp9", "-b:v:0", "0", "-row-mt", "1"], ["42", "33", "24", "15"]),
            Self::Av1 => (
                &["-c:v:0", "libaom-av1", "-b:v:0", "0", "-row-mt", "1", "-cpu-used", "6"],
                ["45", "35", "25", "15"],
            ),
        }
    }
}

/// Quality of the encoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EncodingQuality {
    /// For previews.
    Low,
    /// Differences are visible on a close look.
    Medium,
    /// Differences are hardly visible.
    #[default]
    High,
    /// For services that encode the video again.
    Best,
}

impl EncodingQuality {
    /// Returns the value for this quality.
    fn of(self, values: [&'static str; 4]) -> &'static str {
        values[self as usize]
    }
}

impl Choice for EncodingQuality {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Low, "low", "A small preview"),
        (Self::Medium, "medium", ""),
        (Self::High, "high", "Differences are hardly visible"),
        (Self::Best, "best", "For services that encode the video again"),
    ];
}

/// Filters: even sides, which most players need for 4:2:0, and conversion to the colours of [`COLORS`].
const TRANSPARENT_PICTURES: &str =
    "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=black@0,scale=out_color_matrix=bt709:out_range=tv";
const PICTURES: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";
/// The colours that the video's header names. Without this entry, players assume BT.709 for large and BT.601 for small
/// videos. ffmpeg converts RGB to BT.601 by default.
const COLORS: [[&str; 2]; 4] = [
    ["-colorspace:v:0", "bt709"],
    ["-color_primaries:v:0", "bt709"],
    ["-color_trc:v:0", "bt709"],
    ["-color_range:v:0", "tv"],
];

pub(super) fn is_mp4(path: &Path) -> bool {
    ends_in(path, &["mp4", "m4v"])
}

/// True for formats of boxes: MP4 and QuickTime.
pub(super) fn is_quicktime(path: &Path) -> bool {
    is_mp4(path) || ends_in(path, &["mov"])
}

/// The codec of a Matroska or WebM file for which none was asked for.
pub(super) fn default_codec(path: &Path) -> Codec {
    if ends_in(path, &["webm"]) { Codec::Vp9 } else { Codec::H264 }
}

/// True for Matroska and WebM.
pub(super) fn is_matroska(path: &Path) -> bool {
    ends_in(path, &["mkv", "webm"])
}

/// True for formats whose videos [`super::join`] can join: they have one set of codec parameters for all frames.
pub(super) fn can_be_joined(path: &Path) -> bool {
    is_quicktime(path) || is_matroska(path)
}

/// Files of sound. ffmpeg would write the song into some of them, with the first frame as its cover.
const SOUND_ENDINGS: &[&str] = &[
    "aac", "aif", "aifc", "aiff", "caf", "flac", "m4a", "m4b", "mka", "mp2", "mp3", "oga", "opus", "wav",
    "wma",
];

fn ends_in(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| endings.contains(&ending.as_str()))
}

/// Frame times of GIFs are multiples of 1/100 s, and browsers show each frame for at least 2/100 s.
const GIF_FPS_MAX: f64 = 50.0;

/// A palette for each frame. For a common palette, ffmpeg would hold all frames in memory.
const GIF_PICTURES: &str =
    "split[all][one];[one]palettegen=stats_mode=single[palette];[all][palette]paletteuse=new=1";

/// True for animations, whose formats have one codec and no sound.
fn is_animation(path: &Path) -> bool {
    ends_in(path, &["gif", "webp"])
}

fn encode_animation(path: &Path, request: &VideoRequest) -> Vec<&'static str> {
    let format = if request.scene.alpha { "yuva420p" } else { "yuv420p" };
    let quality = request.quality.of(WEBP_QUALITIES);
    let codec: &[&str] = if ends_in(path, &["gif"]) {
        &["-c:v:0", "gif", "-filter:v:0", GIF_PICTURES]
    } else {
        &["-c:v:0", "libwebp_anim", "-pix_fmt:v:0", format, "-quality:v:0", quality]
    };
    [codec, &["-loop", "0"]].concat()
}

/// The quality of a WebP, from 0 to 100, for each [`EncodingQuality`].
const WEBP_QUALITIES: [&str; 4] = ["40", "65", "85", "95"];

pub(super) fn has_sound(request: &VideoRequest, path: &Path) -> bool {
    request.sound && !is_animation(path)
}

pub(super) fn require_fit(codec: Option<Codec>, fps: f64, path: &Path) -> Result<(), ExportError> {
    let (name, max) = (path.display(), GIF_FPS_MAX);
    if is_animation(path) && codec.is_some() {
        return refuse(format!(
            "{name} has no choice of codecs: leave out --codec, or give -o a name that ends in .mp4 or .mkv"
        ));
    }
    if ends_in(path, &["gif"]) && fps > max {
        return refuse(format!(
            "{name} shows at most {max} frames a second, not {fps}: give --fps {max} or less"
        ));
    }
    if ends_in(path, SOUND_ENDINGS) {
        return refuse(format!(
            "{name} cannot hold a video: give -o a name that ends in .mp4, .mkv, .mov, .webm, .gif or .webp, or a \
             folder that ends in '/'"
        ));
    }
    let refused = |codec: &str, takes: &str| {
        refuse(format!(
            "{name} does not support {codec}: choose {takes} with --codec, or give -o a name that ends in .mp4 or .mkv"
        ))
    };
    match codec {
        Some(Codec::H264) if ends_in(path, &["webm"]) => refused("h264", "vp9 and av1"),
        Some(Codec::H265) if ends_in(path, &["webm"]) => refused("h265", "vp9 and av1"),
        Some(Codec::Vp9) if ends_in(path, &["mov"]) => refused("vp9", "h264 and h265"),
        Some(Codec::Av1) if ends_in(path, &["mov"]) => refused("av1", "h264 and h265"),
        _ => Ok(()),
    }
}

pub(super) fn require_alpha(output: &Output) -> Result<(), ExportError> {
    match output {
        Output::Path(path) if is_folder(path) || ends_in(path, &["webm", "mov", "mkv", "webp"]) => Ok(()),
        output => refuse_alpha(
            output,
            "a name that ends in .webm, .mov, .mkv or .webp, or a folder that ends in '/'",
        ),
    }
}

/// Returns arguments for alpha: VP9 for browsers, ProRes for editing programs, and lossless FFV1 for other formats.
fn encode_alpha(path: &Path, quality: EncodingQuality) -> Vec<&'static str> {
    // The pixels that make the sides even are transparent too.
    let filter = ["-filter:v:0", TRANSPARENT_PICTURES];
    let codec: &[&str] = if ends_in(path, &["webm"]) {
        let (_, factors) = Codec::Vp9.encoding();
        let rate = quality.of(factors);
        // libvpx refuses alpha together with hidden frames (`auto-alt-ref`).
        &["-c:v:0", "libvpx-vp9", "-b:v:0", "0", "-row-mt", "1", "-auto-alt-ref", "0", "-crf:v:0", rate]
    } else if ends_in(path, &["mov"]) {
        &["-c:v:0", "prores_ks", "-profile:v:0", "4444", "-alpha_bits", "16"]
    } else {
        &["-c:v:0", "ffv1", "-level", "3"]
    };
    let format = if ends_in(path, &["webm"]) { "yuva420p" } else { "yuva444p10le" };
    [codec, &filter, &["-pix_fmt:v:0", format]].concat()
}

pub(super) fn arguments_of(request: &VideoRequest, path: &Path) -> Vec<String> {
    let mut arguments: Vec<String> = Vec::new();
    let mut say = |words: &[&str]| arguments.extend(words.iter().map(|word| (*word).to_owned()));
    if is_animation(path) {
        say(&encode_animation(path, request));
        return arguments;
    }
    let codec = request.codec.or(ends_in(path, &["webm"]).then_some(Codec::Vp9));
    if request.scene.alpha {
        say(&encode_alpha(path, request.quality));
    } else {
        let (words, factors) = codec.unwrap_or(Codec::H264).encoding();
        // Otherwise ffmpeg chooses the codec by the file's extension.
        if codec.is_some() {
            say(words);
        }
        // Apple's players require this tag.
        if codec == Some(Codec::H265) && is_quicktime(path) {
            say(&["-tag:v:0", "hvc1"]);
        }
        let rate = request.quality.of(factors);
        say(&["-crf:v:0", rate, "-filter:v:0", PICTURES, "-pix_fmt:v:0", "yuv420p"]);
    }
    say(COLORS.as_flattened());
    arguments.extend(container_arguments(request, path));
    arguments
}

/// Returns the arguments for frames that are encoded already.
pub(super) fn copying_arguments(request: &VideoRequest, path: &Path) -> Vec<String> {
    let copied = ["-c:v:0", "copy"].map(str::to_owned);
    copied.into_iter().chain(container_arguments(request, path)).collect()
}

fn container_arguments(request: &VideoRequest, path: &Path) -> Vec<String> {
    let mut arguments: Vec<String> = Vec::new();
    let mut say = |words: &[&str]| arguments.extend(words.iter().map(|word| (*word).to_owned()));
    if is_quicktime(path) {
        // Players can start before the download ends. The metadata of a projection need the index at the end.
        if !is_marked(&request.scene.projection) {
            say(&["-movflags", "+faststart"]);
        }
        if request.sound {
            say(&["-c:a", "aac", "-b:a", "256k"]);
        }
    }
    if let Some(rate) = request.sound_rate.filter(|_| request.sound) {
        say(&["-ar", &rate.to_string()]);
    }
    arguments
}
