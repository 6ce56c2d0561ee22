//! Byte sources and their demuxers.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use symphonia::core::common::Limit;
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, FormatReader};
use symphonia::core::io::{MediaSource, MediaSourceStream, ReadOnlySource};
use symphonia::core::meta::MetadataOptions;

use super::error::{DecodeError, Problem};
use super::gapless::{Edits, edits};
use super::mended::Mended;
use super::old_tags::{self, OldTags};
use super::{contained, sniff};

/// Maximum size of the tags with text, in bytes, if no cover is read.
const TEXT_BYTES: usize = 1 << 16;

#[derive(Debug, Clone)]
pub(super) struct MediaInput {
    /// The name for messages: the file name without folders.
    pub(super) name: String,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    /// An open handle, so that the song continues if its file is moved or deleted.
    File(Arc<File>),
    Bytes(&'static [u8]),
}

pub(super) struct Opened {
    pub(super) format: Box<dyn FormatReader>,
    pub(super) edits: Edits,
    pub(super) old_tags: OldTags,
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// True if the disk or the network failed. A demuxer that seeks before the start of a damaged file gets an error too.
pub(super) fn is_disk_error(error: &io::Error) -> bool {
    error.raw_os_error().is_some() && error.kind() != io::ErrorKind::InvalidInput
}

impl MediaInput {
    pub(super) fn file(path: &Path) -> Result<Self, DecodeError> {
        let failed = |problem: Problem| problem.of(&path.display().to_string());
        let metadata = std::fs::metadata(path).map_err(|error| failed(error.into()))?;
        if metadata.is_dir() {
            return Err(failed(Problem::IsFolder));
        }
        if !metadata.is_file() {
            return Err(failed(Problem::NotAFile));
        }
        if metadata.len() == 0 {
            return Err(Problem::Empty.of(&file_name(path)));
        }
        let file = File::open(path).map_err(|error| failed(error.into()))?;
        Ok(Self { name: file_name(path), content: Content::File(Arc::new(file)) })
    }

    pub(super) fn bytes(name: &str, bytes: &'static [u8]) -> Self {
        Self { name: name.to_owned(), content: Content::Bytes(bytes) }
    }

    /// The size in bytes; `None` if the system does not report it.
    pub(super) fn size(&self) -> Option<u64> {
        match &self.content {
            Content::File(file) => file.metadata().ok().map(|about| about.len()),
            Content::Bytes(bytes) => Some(bytes.len() as u64),
        }
    }

    /// Returns the bytes from the first one on. All sources of a file share one position, so earlier sources must no
    /// longer be read.
    fn source(&self) -> io::Result<Box<dyn MediaSource>> {
        Ok(match &self.content {
            Content::File(file) => {
                let mut again = file.try_clone()?;
                again.rewind()?;
                Box::new(again)
            }
            Content::Bytes(bytes) => Box::new(Cursor::new(*bytes)),
        })
    }

    /// Opens the demuxer, which keeps covers of at most `cover_bytes`.
    pub(super) fn open(&self, cover_bytes: usize) -> Result<Opened, Problem> {
        let mut source = self.source()?;
        let mut head = Vec::new();
        source.by_ref().take(sniff::SNIFF_BYTES as u64).read_to_end(&mut head)?;
        if head.is_empty() {
            return Err(Problem::Empty);
        }
        if let Some(problem) = sniff::foreign(&head).or_else(|| sniff::over_limit(&head)) {
            return Err(problem);
        }
        let edits = edits(&head, &mut source);
        let old_tags = old_tags::read(&mut source);
        let source = Mended::new(source)?;

        let mut hint = Hint::new();
        if let Some(extension) = Path::new(&self.name).extension().and_then(|e| e.to_str()) {
            hint.with_extension(extension);
        }
        // Comments hold covers in base64.
        let metadata = MetadataOptions::default()
            .limit_tag_bytes(Limit::Maximum(TEXT_BYTES.max(2 * cover_bytes)))
            .limit_visual_bytes(Limit::Maximum(cover_bytes));
        let stream = MediaSourceStream::new(Box::new(source), Default::default());
        let probe = |stream| {
            contained(|| {
                symphonia::default::get_probe().probe(&hint, stream, FormatOptions::default(), metadata)
            })
        };
        let mut probed = probe(stream)?;
        let recognised = RECOGNISED
            .iter()
            .any(|(offset, mark)| head.get(*offset..).is_some_and(|rest| rest.starts_with(mark)));
        if recognised && probed.is_err() {
            // Many demuxers look for more data at the end, or compare lengths with the file's length, and fail if the
            // file is truncated. They skip these checks if the source cannot seek.
            let source = ReadOnlySource::new(self.source()?);
            let again = probe(MediaSourceStream::new(Box::new(source), Default::default()))?;
            probed = again.or(probed);
        }
        match probed {
            Ok(format) => Ok(Opened { format, edits, old_tags }),
            Err(error) => Err(probe_problem(error, recognised)),
        }
    }
}

fn probe_problem(error: Error, recognised: bool) -> Problem {
    match error {
        Error::IoError(source) if is_disk_error(&source) => source.into(),
        _ if !recognised => Problem::NotAudio("no audio data was found in it".into()),
        Error::Unsupported(what) => {
            Problem::UnsupportedFormat(format!("a variant of a known format ({what})"))
        }
        Error::LimitError(what) => Problem::OverLimit {
            what: format!("an oversized header ({what})"),
            limit: "fixed by the format's reader".into(),
        },
        Error::IoError(_) => Problem::Damaged("it ends within its header".into()),
        Error::DecodeError(what) => Problem::Damaged(format!("its header cannot be read ({what})")),
        other => Problem::Damaged(format!("its header cannot be read ({other})")),
    }
}

const RECOGNISED: &[(usize, &[u8])] = &[
    (0, b"RIFF"),
    (0, b"FORM"),
    (0, b"fLaC"),
    (0, b"OggS"),
    (0, b"caff"),
    (0, b"ID3"),
    (4, b"ftyp"),
    (0, b"\x1A\x45\xDF\xA3"),
    (0, b"\xFF\xFB"),
    (0, b"\xFF\xF1"),
    (0, b"\xFF\xF9"),
];
