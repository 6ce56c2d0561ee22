//! Command lines of ffmpeg and ffprobe. Only this module starts these programs.
//!
//! By default ffmpeg chooses a demuxer by a file's content, and some demuxers (HLS, DASH, concat) open every file and
//! address that their input names. Inputs can be added only by [`CommandLine::input`]. It names the demuxers that may
//! read the input, and the single protocol that reaches the input. These demuxers open only their own input.

pub(crate) mod probe;
pub(crate) mod process;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

use mariana_files::ending::apart_from_terminal;

/// Demuxers for songs: audio, and video with sound. They open only their own input. ffmpeg takes the list in this form.
const SONG_DEMUXERS: &str = "aac,ac3,adx,aiff,amr,ape,asf,au,avi,caf,dsf,dts,dtshd,eac3,flac,flv,gsm,iff,it,libgme,\
    libmodplug,libopenmpt,matroska,mlp,mov,mp3,mpc,mpc8,mpeg,mpegts,mxf,nut,ogg,oma,rm,shn,sox,tak,\
    truehd,tta,voc,w64,wav,webm,wv,xwma";

/// Demuxers for videos without sound, and for pictures that move. They open only their own input.
const VIDEO_DEMUXERS: &str = "apng,asf,avi,flv,gif,ivf,matroska,mov,mpeg,mpegts,ogg,webm";

/// Folders of programs on macOS that are not in the `PATH` of a program that was started from the desktop.
const BEYOND_PATH: [&str; 3] = ["/opt/homebrew/bin", "/usr/local/bin", "/opt/local/bin"];

/// An ffmpeg demuxer that reads only its own input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Demuxer(&'static str);

impl Demuxer {
    /// Uncompressed video frames.
    pub const RAW_VIDEO: Self = Self("rawvideo");
    /// JPEG images.
    pub const JPEG: Self = Self("mjpeg");
    /// PNG images.
    pub const PNG: Self = Self("png_pipe");
    /// ADTS streams of AAC.
    pub const ADTS: Self = Self("aac");
    /// AIFF.
    pub const AIFF: Self = Self("aiff");
    /// Apple's Core Audio Format.
    pub const CAF: Self = Self("caf");
    /// FLAC.
    pub const FLAC: Self = Self("flac");
    /// Matroska and WebM.
    pub const MATROSKA: Self = Self("matroska");
    /// QuickTime and MP4.
    pub const MOV: Self = Self("mov");
    /// MPEG audio, layers 1 to 3.
    pub const MP3: Self = Self("mp3");
    /// Ogg.
    pub const OGG: Self = Self("ogg");
    /// WAVE.
    pub const WAV: Self = Self("wav");
    /// Cameras of Video4Linux.
    pub const V4L2: Self = Self("v4l2");

    /// Returns the demuxer for songs among the comma-separated names from ffprobe; `None` without such a demuxer.
    pub(crate) fn of_song(reported: &str) -> Option<Self> {
        Self::among(SONG_DEMUXERS, reported)
    }

    /// Returns the demuxer for videos among the comma-separated names from ffprobe; `None` without such a demuxer.
    pub(crate) fn of_video(reported: &str) -> Option<Self> {
        Self::among(VIDEO_DEMUXERS, reported)
    }

    /// False for the broadcast formats, in which a seek guesses a place in the file.
    pub(crate) fn has_index(self) -> bool {
        !matches!(self.0, "mpeg" | "mpegts")
    }

    fn among(known: &'static str, reported: &str) -> Option<Self> {
        known.split(',').find(|known| reported.split(',').any(|name| name == *known)).map(Self)
    }
}

/// The demuxers that may read an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadBy {
    /// Only this demuxer.
    Demuxer(Demuxer),
    /// The song demuxer that recognises the content.
    AnySongDemuxer,
    /// The video demuxer that recognises the content.
    AnyVideoDemuxer,
    /// The demuxer of lists of videos. The list must come from this program: it names files to open.
    List,
}

/// The origin of an input.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// A file.
    File(&'a Path),
    /// A camera, by the absolute path of its device.
    Camera(&'a Path),
    /// Standard input.
    StandardInput,
}

/// A builder for a command line of ffmpeg or ffprobe.
#[derive(Debug)]
pub struct CommandLine {
    program: PathBuf,
    arguments: Vec<OsString>,
}

impl CommandLine {
    /// Starts a command line of ffmpeg that reports only errors and does not read standard input. ffmpeg is found in
    /// `PATH`. Windows first looks into the folder of this program, and macOS into that folder and into those of Homebrew
    /// and MacPorts.
    pub fn ffmpeg() -> Self {
        Self::of(&found("ffmpeg")).options(["-nostdin"])
    }

    /// Starts a command line of ffprobe, found like ffmpeg, that reports only errors.
    pub fn ffprobe() -> Self {
        Self::of(&found("ffprobe"))
    }

    pub(crate) fn of(program: &Path) -> Self {
        Self { program: program.to_owned(), arguments: Vec::new() }.options(["-v", "error"])
    }

    /// Adds options that are not inputs.
    #[must_use]
    pub fn options<A: Into<OsString>>(mut self, options: impl IntoIterator<Item = A>) -> Self {
        self.arguments.extend(options.into_iter().map(Into::into));
        self
    }

    /// Adds an input with its own options.
    #[must_use]
    pub fn input<A: Into<OsString>>(
        self,
        source: Source<'_>,
        read_by: ReadBy,
        options: impl IntoIterator<Item = A>,
    ) -> Self {
        let (protocol, address) = match source {
            Source::File(path) => ("file", file_address(path)),
            // The demuxer of cameras opens the path itself. An absolute path is neither an option nor an address.
            Source::Camera(path) => ("file", Path::new("/").join(path).into_os_string()),
            Source::StandardInput => ("pipe", "pipe:0".into()),
        };
        let line = self.options(["-protocol_whitelist", protocol]);
        // The whitelist also applies to inputs that a demuxer opens.
        let line = match read_by {
            ReadBy::Demuxer(Demuxer(name)) => line.options(["-format_whitelist", name, "-f", name]),
            ReadBy::AnySongDemuxer => line.options(["-format_whitelist", SONG_DEMUXERS]),
            ReadBy::List => {
                let demuxers = format!("concat,{VIDEO_DEMUXERS}");
                line.options(["-format_whitelist", &demuxers, "-f", "concat"])
            }
            ReadBy::AnyVideoDemuxer => line.options(["-format_whitelist", VIDEO_DEMUXERS]),
        };
        line.options(options).options([OsStr::new("-i"), &address])
    }

    /// Builds the command.
    pub fn command(self) -> Command {
        let mut command = Command::new(self.program);
        apart_from_terminal(command.args(self.arguments));
        command
    }
}

/// The path of a program, or only its name where the system is to look for it.
fn found(name: &str) -> PathBuf {
    if cfg!(not(target_os = "macos")) {
        return name.into();
    }
    let beside = std::env::current_exe().ok().and_then(|program| Some(program.parent()?.to_owned()));
    let folders = beside.into_iter().chain(BEYOND_PATH.map(PathBuf::from));
    folders.map(|folder| folder.join(name)).find(|program| program.is_file()).unwrap_or_else(|| name.into())
}

/// The `file:` address of a path, in which ffmpeg does not interpret colons, hyphens or percent signs.
pub fn file_address(path: &Path) -> OsString {
    let mut address = OsString::from("file:");
    address.push(path);
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: CommandLine) -> String {
        let words: Vec<String> =
            line.command().get_args().map(|word| word.to_string_lossy().into_owned()).collect();
        words.join(" ")
    }

    #[test]
    fn an_input_is_read_by_the_demuxers_and_the_protocol_it_was_given() {
        let line = CommandLine::ffmpeg().input(
            Source::File(Path::new("-a:b.mp3")),
            ReadBy::Demuxer(Demuxer::MP3),
            ["-ss", "2"],
        );
        assert_eq!(
            words(line),
            "-v error -nostdin -protocol_whitelist file -format_whitelist mp3 -f mp3 -ss 2 -i file:-a:b.mp3"
        );
        let line = CommandLine::of("ffprobe".as_ref());
        let line = words(line.input(Source::StandardInput, ReadBy::AnySongDemuxer, [""; 0]));
        assert!(line.starts_with("-v error -protocol_whitelist pipe -format_whitelist aac,ac3,"), "{line}");
        assert!(line.ends_with(",xwma -i pipe:0"), "{line}");
    }

    #[test]
    fn no_playlist_is_a_song() {
        assert_eq!(Demuxer::of_song("mov,mp4,m4a,3gp,3g2,mj2"), Some(Demuxer::MOV));
        assert_eq!(Demuxer::of_song("matroska,webm"), Some(Demuxer::MATROSKA));
        assert_eq!(Demuxer::of_video("matroska,webm"), Some(Demuxer::MATROSKA));
        for list in ["hls", "image2", "concat", "v4l2", "video4linux2,v4l2"] {
            assert_eq!(Demuxer::of_video(list), None, "{list}");
        }
        for list in ["hls", "applehttp", "dash", "concat", "image2", "tty", "", "m"] {
            assert_eq!(Demuxer::of_song(list), None, "{list}");
        }
    }
}
