//! Splits ffmpeg's output into frames. Each frame is a PAM image with red, green, blue and alpha.

use super::VideoFrame;
use crate::ffmpeg::CommandLine;
use crate::ffmpeg::process::{Failure, Process};
use crate::limits;

const END: &[u8] = b"ENDHDR\n";
/// Maximum size of a frame's header in bytes. ffmpeg writes about 70.
const HEADER_MAX: usize = 256;

/// The frames that a running ffmpeg writes.
pub(super) struct Frames {
    pub(super) process: Process,
    rest: Vec<u8>,
}

impl Frames {
    /// Starts ffmpeg with the inputs of `line`. `filters` come before the frames are scaled; they may be empty.
    pub(super) fn start(line: CommandLine, filters: &str) -> Result<Self, Failure> {
        let (width, height) = limits::VIDEO_SIZE_MAX;
        // Pixels may not be square.
        let scale = format!("min(1,min({width}/(iw*sar),{height}/ih))");
        let comma = if filters.is_empty() { "" } else { "," };
        let filters =
            format!("{filters}{comma}scale=w='max(1,{scale}*iw*sar)':h='max(1,{scale}*ih)':flags=bilinear");
        let line = line.options(["-map", "0:V:0", "-an", "-sn", "-dn", "-vf", &filters]).options([
            "-pix_fmt",
            "rgba",
            "-c:v",
            "pam",
            "-f",
            "image2pipe",
            "pipe:1",
        ]);
        let patience = std::time::Duration::from_secs_f64(limits::FFMPEG_WAIT_SECONDS);
        Ok(Self { process: Process::start(line, patience)?, rest: Vec::new() })
    }

    /// The next frame; `None` after the last one. A frame that is cut off, or larger than the limit, ends the frames.
    pub(super) fn next(&mut self) -> Result<Option<VideoFrame>, Failure> {
        loop {
            match header(&self.rest) {
                Header::Partial => {}
                Header::Wrong => return Ok(None),
                Header::Whole { size, length } => {
                    let end = length + 4 * size.0 as usize * size.1 as usize;
                    self.rest.reserve(end.saturating_sub(self.rest.len()));
                    if self.rest.len() >= end {
                        let after = self.rest.split_off(end);
                        let mut rgba = std::mem::replace(&mut self.rest, after);
                        rgba.drain(..length);
                        return Ok(Some(VideoFrame { size, rgba }));
                    }
                }
            }
            match self.process.next()? {
                Some(piece) => self.rest.extend(piece),
                None => return Ok(None),
            }
        }
    }
}

#[derive(Debug, PartialEq)]
enum Header {
    Partial,
    Wrong,
    Whole { size: (u32, u32), length: usize },
}

fn header(bytes: &[u8]) -> Header {
    let start = bytes.get(..bytes.len().min(HEADER_MAX)).unwrap_or_default();
    let Some(at) = start.windows(END.len()).position(|window| window == END) else {
        return if bytes.len() < HEADER_MAX { Header::Partial } else { Header::Wrong };
    };
    let text = std::str::from_utf8(start.get(..at).unwrap_or_default()).unwrap_or_default();
    let number = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        line.and_then(|number| number.trim().parse::<u32>().ok())
    };
    let (width, height) = (number("WIDTH").unwrap_or(0), number("HEIGHT").unwrap_or(0));
    let max = limits::VIDEO_SIZE_MAX;
    let fits = (1..=max.0).contains(&width) && (1..=max.1).contains(&height);
    match fits && number("DEPTH") == Some(4) && number("MAXVAL") == Some(255) {
        true => Header::Whole { size: (width, height), length: at + END.len() },
        false => Header::Wrong,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_whole_partial_or_wrong() {
        let text = b"P7\nWIDTH 32\nHEIGHT 18\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\nxxxx";
        assert_eq!(header(text), Header::Whole { size: (32, 18), length: text.len() - 4 });
        for length in 0..text.len() - 4 {
            assert_eq!(header(&text[..length]), Header::Partial, "{length}");
        }
        for (from, to) in [("32", "0"), ("32", "99999"), ("DEPTH 4", "DEPTH 3"), ("WIDTH", "W"), ("32", "-1")]
        {
            let text = String::from_utf8_lossy(text).replace(from, to);
            assert_eq!(header(text.as_bytes()), Header::Wrong, "{text}");
        }
        assert_eq!(header(&[b'x'; HEADER_MAX]), Header::Wrong);
    }
}
